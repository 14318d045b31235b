# Plots are a library of their own, for their tests.
add_library(tet4d_plot STATIC report/axis.cpp report/plot.cpp report/plot_png.cpp)
target_include_directories(tet4d_plot PUBLIC ${PROJECT_SOURCE_DIR})
target_link_libraries(tet4d_plot PRIVATE tet4d_options tet4d_warnings tet4d::cli fmt::fmt)
tet4d_add_program(tet4d-report SOURCES tet4d-report.cpp report/ball.cpp report/child.cpp report/compare.cpp report/mc_sweep.cpp
                  report/page.cpp report/peer.cpp report/play_sweep.cpp report/rows.cpp report/slice_errors.cpp
                  report/slim_run.cpp report/slim_sweep.cpp report/stiff_cases.cpp
                  report/stiff_sweep.cpp report/stiff_slim.cpp report/stiff_triangles.cpp report/views.cpp
                  DEPENDS tet4d_plot tet4d::cli tet4d::exchange tet4d::measure nlohmann_json::nlohmann_json fmt::fmt)
if(TET4D_WITH_CAIRO)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(cairo REQUIRED IMPORTED_TARGET GLOBAL cairo)
  target_link_libraries(tet4d_plot PRIVATE PkgConfig::cairo)
  target_compile_definitions(tet4d_plot PRIVATE TET4D_WITH_CAIRO=1)
endif()
# The peer's script stands beside the program in the build as in an installation: ../share/tet4d/peers.
configure_file(${PROJECT_SOURCE_DIR}/scripts/peers/vtk_peer.py ${PROJECT_BINARY_DIR}/share/tet4d/peers/vtk_peer.py COPYONLY)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/scripts/peers/vtk_peer.py DESTINATION ${CMAKE_INSTALL_DATADIR}/tet4d/peers)
