# Install and export: programs in bin/, make rules in share/, and a package: an outside project finds the libraries with
# find_package(tet4d) and links tet4d::formats.
include(CMakePackageConfigHelpers)

# The files and the builders. The command line and the player's rooms serve our programs and are not exported.
get_property(tet4d_libraries GLOBAL PROPERTY TET4D_LIBRARIES)
set(tet4d_exported)
foreach(library formats outofcore exchange topology measure hypermesh prisms dyntri)
  if(tet4d_${library} IN_LIST tet4d_libraries)
    list(APPEND tet4d_exported tet4d_${library})
  endif()
endforeach()

install(TARGETS ${tet4d_exported} tet4d_options EXPORT tet4dTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT tet4dTargets NAMESPACE tet4d:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tet4d)
install(DIRECTORY formats libpreprocess DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tet4d FILES_MATCHING PATTERN "*.h")
install(DIRECTORY scripts/pipelines/ DESTINATION ${CMAKE_INSTALL_DATADIR}/tet4d/pipelines FILES_MATCHING PATTERN "*.mk")
install(FILES LICENSE docs/licences.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
configure_package_config_file(cmake/tet4dConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/tet4dConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tet4d)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/tet4dConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/tet4dConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/tet4dConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tet4d)
