# Headers that CMake writes into ${PROJECT_BINARY_DIR}/generated.

# embed_texts(HEADER FILE..): writes a header with the text of each file as a string k_NOUN_text, with its includes
# of srbf/ expanded.
function(embed_texts header)
  set(texts "// Made by CMake from ${ARGN}.\n#pragma once\nnamespace SRBF_NAMESPACE {\n")
  foreach(file ${ARGN})
    get_filename_component(noun ${file} NAME_WE)
    get_property(nouns GLOBAL PROPERTY embedded_nouns)
    if(noun IN_LIST nouns)  # the names would clash
      message(FATAL_ERROR "${file}: a text named ${noun} is embedded already")
    endif()
    set_property(GLOBAL APPEND PROPERTY embedded_nouns ${noun})
    file(READ ${file} content)
    string(REGEX MATCHALL "#include \"srbf/[^\"]+\"" include_lines "${content}")
    foreach(line IN LISTS include_lines)
      string(REGEX REPLACE ".*\"(.*)\"" "${PROJECT_SOURCE_DIR}/include/\\1" included_file ${line})
      file(READ ${included_file} included_content)
      string(REPLACE "${line}" "${included_content}" content "${content}")
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${included_file})
    endforeach()
    # Changes of a text reach the header because they configure the build again.
    string(APPEND texts "inline constexpr char k_${noun}_text[] = R\"text(${content})text\";\n")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${header} CONTENT "${texts}}  // namespace srbf\n" @ONLY)
endfunction()

# write_extras_table(HEADER FILE NOUN TYPE INCLUDE): writes a header with the array k_extra_NOUN of all k_NAME_NOUN in
# the FILEs of extras. INCLUDE has TYPE.
function(write_extras_table header file noun type include)
  set(includes "#include \"${include}\"\n")
  set(names "")
  set(count 0)
  foreach(extra IN LISTS format_extras)
    if(EXISTS ${PROJECT_SOURCE_DIR}/extras/${extra}/${file})
      string(APPEND includes "#include \"extras/${extra}/${file}\"\n")
      string(APPEND names "k_${extra}_${noun}, ")
      math(EXPR count "${count} + 1")
    endif()
  endforeach()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${header} @ONLY CONTENT "// Made by CMake: ${noun} of extras.
#pragma once
#include <array>
#include <span>

@includes@
namespace SRBF_NAMESPACE {
inline constexpr std::array<std::span<const @type@>, @count@> k_extra_@noun@{@names@};
}  // namespace srbf
")
endfunction()

# write_function_table(HEADER TYPE NAME INCLUDE FUNCTION..): writes a header with the array NAME of these functions.
# TYPE has %s for its name.
function(write_function_table header type name include)
  set(declarations "")
  set(names "")
  list(LENGTH ARGN count)
  foreach(function IN LISTS ARGN)
    string(REPLACE "%s" ${function} declaration "${type}")
    string(APPEND declarations "${declaration};\n")
    string(APPEND names "${function}, ")
  endforeach()
  string(REPLACE "%s" "(*)" pointer "${type}")
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${header} @ONLY CONTENT "// Made by CMake: functions of extras.
#pragma once
#include <array>

#include \"@include@\"

namespace SRBF_NAMESPACE {
@declarations@inline constexpr std::array<@pointer@, @count@> @name@{@names@};
}  // namespace srbf
")
endfunction()
