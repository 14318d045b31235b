tet4d_add_program(dyntri-build SOURCES dyntri-build.cpp DEPENDS tet4d::dyntri tet4d::cli)
