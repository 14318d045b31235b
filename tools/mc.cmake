tet4d_add_program(tet4d-mc SOURCES tet4d-mc.cpp DEPENDS tet4d::hypermesh tet4d::exchange tet4d::cli)
