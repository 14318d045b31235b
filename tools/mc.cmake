tet4d_add_program(tet4d-mc SOURCES tet4d-mc.cpp mc/extract_options.cpp mc/extract_volume.cpp mc/mesh_sequence.cpp
                  DEPENDS tet4d::hypermesh tet4d::prisms tet4d::frame_options tet4d::cli)
