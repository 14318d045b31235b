tet4d_add_program(tet4d-info SOURCES tet4d-info.cpp info/describe.cpp
                  DEPENDS tet4d::cli tet4d::formats tet4d::topology nlohmann_json::nlohmann_json fmt::fmt)
