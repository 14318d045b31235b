tet4d_add_program(vpartition SOURCES vpartition.cpp DEPENDS tet4d::vpartition tet4d::cli)
