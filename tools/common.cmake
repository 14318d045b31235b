# The command line all programs share. Not installed: it serves the programs only.
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)

add_library(tet4d_cli STATIC
  common/bindings.cpp common/command.cpp common/completion.cpp common/console_progress.cpp common/files.cpp common/man_page.cpp
  common/memory_sampler.cpp common/nearest.cpp common/parse.cpp common/run.cpp common/session.cpp)
add_library(tet4d::cli ALIAS tet4d_cli)
target_include_directories(tet4d_cli PUBLIC ${PROJECT_SOURCE_DIR})
target_compile_definitions(tet4d_cli PRIVATE TET4D_VERSION="${PROJECT_VERSION}")
target_link_libraries(tet4d_cli PUBLIC tet4d_options tet4d::outofcore tet4d::formats
                                PRIVATE tet4d_warnings CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json)
