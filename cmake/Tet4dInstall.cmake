# Install and export: an outside project finds the libraries with find_package(tet4d) and links tet4d::formats.
include(CMakePackageConfigHelpers)

get_property(tet4d_libraries GLOBAL PROPERTY TET4D_LIBRARIES)
install(TARGETS ${tet4d_libraries} tet4d_options EXPORT tet4dTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT tet4dTargets NAMESPACE tet4d:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tet4d)
install(DIRECTORY formats libpreprocess player DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tet4d FILES_MATCHING PATTERN "*.h")
configure_package_config_file(cmake/tet4dConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/tet4dConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tet4d)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/tet4dConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/tet4dConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/tet4dConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tet4d)
