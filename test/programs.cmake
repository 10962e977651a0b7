# Functions for lists of tests, and libraries that test programs share.

# Test programs contain several files each, because most of the compile time goes into headers and their templates.
# ctest lists and runs the tests file by file.
function(test_options target level)
  get_property(libraries GLOBAL PROPERTY SRBF_LIBRARIES)  # of extras
  target_link_libraries(${target} PRIVATE srbf::srbf srbf_session ${libraries} srbf_build GTest::gtest Eigen3::Eigen TBB::tbb
                        hwy::hwy nlohmann_json::nlohmann_json fmt::fmt)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/test
                             ${PROJECT_SOURCE_DIR}/test/support)
  if(SRBF_SANITIZE)
    set(sanitized 1)
  else()
    set(sanitized 0)
  endif()
  target_compile_definitions(${target} PRIVATE SRBF_IS_SANITIZED=${sanitized})
  target_compile_options(${target} PRIVATE ${level})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)  # as in main.cpp: both share precompiled headers
  use_precompiled_headers(${target} tests_main${level} <algorithm> <cmath> <filesystem> <fstream> <functional> <map> <random> <string>
              <vector> <fmt/format.h> <gtest/gtest.h> <nlohmann/json.hpp>)
  use_unity_build(${target})
endfunction()
foreach(level -O0 -O1)
  add_library(tests_main${level} OBJECT main.cpp)
  test_options(tests_main${level} ${level})
endforeach()

# Readers of files are compiled with sanitizers in every build whose compiler has them. A program that links these objects
# uses the rest of the library as it is.
include(CheckCXXSourceCompiles)
set(CMAKE_REQUIRED_FLAGS -fsanitize=address,undefined)
check_cxx_source_compiles("int main() {}" SRBF_HAS_SANITIZERS)
unset(CMAKE_REQUIRED_FLAGS)
set(reads_sanitized OFF)
if(SRBF_HAS_SANITIZERS AND NOT SRBF_SANITIZE AND NOT BUILD_SHARED_LIBS)
  set(reads_sanitized ON)
  list(TRANSFORM SRBF_READER_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/)
  add_library(reading_sanitized OBJECT ${SRBF_READER_SOURCES})
  target_include_directories(reading_sanitized PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(reading_sanitized PRIVATE srbf_extras srbf_build srbf_sanitized srbf::srbf Eigen3::Eigen nlohmann_json::nlohmann_json
                        nanoflann::nanoflann TBB::tbb hwy::hwy fmt::fmt pugixml::pugixml)
  target_compile_options(reading_sanitized PRIVATE -O1 -g1 -w)
  set_target_properties(reading_sanitized PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  use_unity_build(reading_sanitized)
endif()

# test_program(NOUN LEVEL [SANITIZED]): the program NOUN_tests, unless it is there already. SANITIZED: its readers run
# under sanitizers.
function(test_program noun level)
  set(program ${noun}_tests)
  if(TARGET ${program})
    return()
  endif()
  add_executable(${program} $<TARGET_OBJECTS:tests_main${level}>)
  target_compile_definitions(${program} PRIVATE SRBF_SOURCE_DIR="${PROJECT_SOURCE_DIR}" SRBF_PROGRAM="$<TARGET_FILE:srbf_app>")
  test_options(${program} ${level})
  target_link_libraries(${program} PRIVATE srbf_extras)
  if("SANITIZED" IN_LIST ARGN AND reads_sanitized)
    target_link_libraries(${program} PRIVATE reading_sanitized)
    target_link_options(${program} PRIVATE $<TARGET_PROPERTY:srbf_sanitized,INTERFACE_LINK_OPTIONS>)
  endif()
endfunction()

# tests(PROGRAM LABELS NOUN..): adds NOUN_test.cpp of this folder, each as the test NOUN. LABELS is a list (CMakeLists.txt).
function(tests noun labels)
  set(program ${noun}_tests)
  foreach(test IN LISTS ARGN)
    target_sources(${program} PRIVATE ${CMAKE_CURRENT_LIST_DIR}/${test}_test.cpp)
    add_test(NAME ${test} COMMAND ${program} --of=${test})
    test_labels(${test} ${labels})
  endforeach()
  if("program" IN_LIST labels)  # the tests run the program, but are compiled before it is linked
    set_property(TARGET ${program} PROPERTY LINK_DEPENDS $<TARGET_FILE:srbf_app>)
  endif()
  if("input" IN_LIST labels)
    add_dependencies(input_tests ${program})
  endif()
  if(("unit" IN_LIST labels OR "input" IN_LIST labels) AND NOT "fit" IN_LIST labels)
    add_dependencies(quick_tests ${program})
  endif()
endfunction()

# browser_test(NAME PROGRAM TEST FILTER): runs FILTER of TEST, which needs a browser, as the test NAME.
function(browser_test name program test filter)
  add_test(NAME ${name} COMMAND ${program}_tests --gtest_filter=${filter})
  test_labels(${name} host)
  set_property(TEST ${test} APPEND PROPERTY ENVIRONMENT GTEST_FILTER=-${filter})
endfunction()

