# Several sources of a target are compiled as one file (TET4D_UNITY), for builds that are made from nothing: most of the
# time of a source goes into the headers and templates that it has in common with its neighbours. A missing include goes
# unseen, and so does a local name that hides another's: the release build does without.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

# The targets of a directory and of all below it.
function(tet4d_targets_below directory result)
  get_property(targets DIRECTORY ${directory} PROPERTY BUILDSYSTEM_TARGETS)
  get_property(children DIRECTORY ${directory} PROPERTY SUBDIRECTORIES)
  foreach(child ${children})
    tet4d_targets_below(${child} below)
    list(APPEND targets ${below})
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()

tet4d_targets_below(${PROJECT_SOURCE_DIR} targets)
set(lines "")
foreach(target ${targets})
  get_target_property(type ${target} TYPE)
  if(NOT type MATCHES "^(STATIC_LIBRARY|EXECUTABLE)$")
    continue()
  endif()
  get_target_property(sources ${target} SOURCES)
  get_target_property(folder ${target} SOURCE_DIR)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  set(line ${target})
  foreach(source ${sources})
    get_filename_component(source ${source} ABSOLUTE BASE_DIR ${folder})
    string(APPEND line ";${source}")
    # Names are looked for again when they may have changed.
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
  endforeach()
  string(APPEND lines "${line}\n")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # A source that is included is no header: what it keeps in a namespace without a name is still its own.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/unity.txt "${lines}")
execute_process(COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/unity_groups.py
                INPUT_FILE ${PROJECT_BINARY_DIR}/unity.txt OUTPUT_FILE ${PROJECT_BINARY_DIR}/unity.cmake COMMAND_ERROR_IS_FATAL ANY)
include(${PROJECT_BINARY_DIR}/unity.cmake)
