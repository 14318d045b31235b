# What every target of the project shares: the language level, warnings as errors in developer builds, reproducible
# floating point, sanitizers, and the one way to declare a library with its alias.

find_package(Threads REQUIRED)

add_library(tet4d_options INTERFACE)
target_compile_features(tet4d_options INTERFACE cxx_std_20)
# The same bytes on every machine: no fused multiply-add unless the source asks for it.
target_compile_options(tet4d_options INTERFACE -ffp-contract=off)
if(TET4D_SANITIZE)
  target_compile_options(tet4d_options INTERFACE -fsanitize=${TET4D_SANITIZE} -fno-omit-frame-pointer
                                                 -fno-sanitize-recover=all)
  target_link_options(tet4d_options INTERFACE -fsanitize=${TET4D_SANITIZE})
endif()

add_library(tet4d_warnings INTERFACE)
if(PROJECT_IS_TOP_LEVEL)
  target_compile_options(tet4d_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor
                                                  -Woverloaded-virtual -Wcast-align -Wold-style-cast -Werror)
  if(TET4D_UNITY)
    target_compile_options(tet4d_warnings INTERFACE -Wno-shadow)
  endif()
  # The sanitizers' checks hide from g++ what is initialised; the release build keeps this warning.
  if(TET4D_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(tet4d_warnings INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()

# tet4d_add_library(<name> SOURCES <files...> [DEPENDS <targets...>] [PRIVATE_DEPENDS <targets...>])
# A static library tet4d_<name> with the alias tet4d::<name>, headers found from the project's root.
function(tet4d_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(tet4d_${name} STATIC ${ARG_SOURCES})
  add_library(tet4d::${name} ALIAS tet4d_${name})
  set_target_properties(tet4d_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(tet4d_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/tet4d>)
  target_link_libraries(tet4d_${name} PUBLIC tet4d_options ${ARG_DEPENDS}
                                      PRIVATE $<BUILD_INTERFACE:tet4d_warnings> ${ARG_PRIVATE_DEPENDS})
  set_property(GLOBAL APPEND PROPERTY TET4D_LIBRARIES tet4d_${name})
endfunction()

# tet4d_add_program(<name> SOURCES <files...> DEPENDS <targets...>)
# Installed with its man page and its completion of bash, which it prints itself once it is linked.
function(tet4d_add_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE tet4d_options tet4d_warnings ${ARG_DEPENDS})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  set(man ${PROJECT_BINARY_DIR}/share/man/man1)
  set(completions ${PROJECT_BINARY_DIR}/share/bash-completion/completions)
  file(MAKE_DIRECTORY ${man} ${completions})
  add_custom_command(TARGET ${name} POST_BUILD
                     COMMAND ${name} --print-man > ${man}/${name}.1
                     COMMAND ${name} --print-completion > ${completions}/${name} VERBATIM)
  install(FILES ${man}/${name}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${completions}/${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
endfunction()
