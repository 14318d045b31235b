tet4d_add_program(tet4d-convert
                  SOURCES tet4d-convert.cpp convert/frames.cpp convert/scalar_as_time.cpp convert/slices.cpp convert/surfaces.cpp
                  DEPENDS tet4d::exchange tet4d::hypermesh tet4d::frame_options tet4d::cli)
