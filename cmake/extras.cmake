# Functions for the CMakeLists.txt of extras.
# srbf_needs(NAME..): leaves the extra out unless these other extras are built.
macro(srbf_needs)
  foreach(needed ${ARGN})
    if(NOT ${PROJECT_SOURCE_DIR}/extras/${needed} IN_LIST SRBF_EXTRAS)
      get_filename_component(name ${CMAKE_CURRENT_SOURCE_DIR} NAME)
      message(STATUS "Without extras/${needed}: built without extras/${name}")
      set(SRBF_IS_LEFT_OUT ON PARENT_SCOPE)
      return()
    endif()
  endforeach()
endmacro()
# srbf_adds(SUBCOMMANDS NAME.. EXPORTS NAME.. LIBRARIES TARGET..): adds subcommands by void add_NAME(CommandLine&,
# int& status), kinds of `srbf export` by add_NAME_exports, and libraries for tests to link.
function(srbf_adds)
  cmake_parse_arguments(PARSE_ARGV 0 added "" "" "SUBCOMMANDS;EXPORTS;LIBRARIES")
  list(TRANSFORM added_SUBCOMMANDS PREPEND add_)
  list(TRANSFORM added_EXPORTS REPLACE "(.+)" "add_\\1_exports")
  foreach(kind SUBCOMMANDS EXPORTS LIBRARIES)
    set_property(GLOBAL APPEND PROPERTY SRBF_${kind} ${added_${kind}})
  endforeach()
  target_link_libraries(srbf_commands PRIVATE ${added_LIBRARIES})
endfunction()
