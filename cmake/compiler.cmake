# This file sets how sources are compiled: together or one by one, for speed or quickly, their warnings, sanitizers.
find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # By default the compiler spends a tenth of its time on garbage collection, which is unnecessary below 2 GB.
  add_compile_options(--param=ggc-min-expand=1000 --param=ggc-min-heapsize=2000000)
endif()
# Half of the compile time goes into headers and template instantiation. ccache caches each file. Without ccache,
# precompiled headers and unity builds make a full build faster.
set(SRBF_COMPILED_ONCE ON)
if(CCACHE AND NOT DEFINED ENV{CCACHE_DISABLE})
  set(SRBF_COMPILED_ONCE OFF)
endif()
# use_unity_build(TARGET..): compiles several sources as one, so that shared headers are read and instantiated only a
# few times. Names in unnamed namespaces must be distinct within a target.
function(use_unity_build)
  if(SRBF_COMPILED_ONCE)
    set_target_properties(${ARGN} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 24)
  endif()
endfunction()
# use_precompiled_headers(TARGET AS HEADER..): uses precompiled headers, which are compiled once for the target AS.
function(use_precompiled_headers target as)
  if(NOT SRBF_COMPILED_ONCE OR NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    return()
  elseif(target STREQUAL as)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  else()
    target_precompile_headers(${target} REUSE_FROM ${as})
  endif()
  set_target_properties(${target} PROPERTIES PCH_WARN_INVALID OFF)  # other options: read as text
endfunction()
# Code that reads arguments or writes text, and tests, compile at -O1: -O3 takes half as long again and makes them no
# faster. Code with sanitizers takes twice as long to compile with optimisation, so only inner loops are optimised.
set(SRBF_QUICKLY_COMPILED $<$<CONFIG:Release>:-O1>)
set(SRBF_COMPILED_FOR_SPEED)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "wasm32")
  set(SRBF_QUICKLY_COMPILED -Oz)  # a page has to be small; `wasm_fast_sources` of CMakeLists.txt are the exception
endif()
if(SRBF_SANITIZE)
  set(SRBF_QUICKLY_COMPILED -O0)
  set(SRBF_COMPILED_FOR_SPEED -O1)
endif()

# Options of code that runs under sanitizers.
add_library(srbf_sanitized INTERFACE)
set(sanitizers address,undefined)
if(SRBF_SANITIZE)
  set(sanitizers ${SRBF_SANITIZE})
endif()
target_compile_options(srbf_sanitized INTERFACE -fsanitize=${sanitizers} -fno-sanitize-recover=all
                       -fno-omit-frame-pointer)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Checks of each access through a pointer take a third of the compile time. AddressSanitizer detects null pointers
  # and small objects anyway, there are hardly any virtual functions, and the fuzzers, which clang compiles, check
  # alignment.
  target_compile_options(srbf_sanitized INTERFACE -fno-sanitize=null,object-size,vptr,alignment)
endif()
target_link_options(srbf_sanitized INTERFACE -fsanitize=${sanitizers})

# Options of all our targets, which do not apply to a user's targets.
add_library(srbf_build INTERFACE)
target_compile_options(srbf_build INTERFACE -ffp-contract=off)
# Without vectors, Eigen sums in the order of its source. Under its own name, our Eigen cannot clash with a user's.
target_compile_definitions(srbf_build INTERFACE EIGEN_DONT_VECTORIZE EIGEN_DONT_PARALLELIZE Eigen=EigenOfSrbf)
# The namespace is that of srbf/version.h, which compilers compare with this.
target_compile_definitions(srbf_build INTERFACE "SRBF_NAMESPACE=srbf::inline v${PROJECT_VERSION_MAJOR}_${PROJECT_VERSION_MINOR}")
if(SRBF_SANITIZE)
  target_compile_options(srbf_build INTERFACE -w)  # other builds warn
else()
  target_compile_options(srbf_build INTERFACE -Wall -Wextra -Wconversion -Wshadow $<$<BOOL:${SRBF_STRICT}>:-Werror>)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Warnings of the optimizer depend on inlining, and even on the length of a path in a macro. In GCC 12 the first two
  # are false positives for std::string. The others are shown but are not errors.
  target_compile_options(srbf_build INTERFACE -Wno-restrict -Wno-stringop-overflow -Wno-error=stringop-overread
                         -Wno-error=array-bounds -Wno-error=maybe-uninitialized -Wno-error=free-nonheap-object)
endif()
if(SRBF_SANITIZE)
  # A single instruction set whose vectors need only the alignment of the stack: the sanitizer's stack may not
  # provide more.
  target_compile_definitions(srbf_build INTERFACE HWY_COMPILE_ONLY_STATIC)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_options(srbf_build INTERFACE -mssse3)  # the lowest instruction set for which Highway has vectors
  endif()
  target_link_libraries(srbf_build INTERFACE srbf_sanitized)
endif()

# Instruction sets that are no faster than the next lower one are left out, because each takes as long to compile.
if(NOT SRBF_SANITIZE)
  set(disabled_targets HWY_SSSE3|HWY_AVX3_DL)
  if(hwy_VERSION VERSION_GREATER_EQUAL 1.1)
    string(APPEND disabled_targets |HWY_AVX3_ZEN4|HWY_AVX3_SPR)
  endif()
  # Vectors of unknown size cannot be class members, as they are in our code.
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64|ARM64")
    set(disabled_targets HWY_SVE|HWY_SVE2)
    if(hwy_VERSION VERSION_GREATER_EQUAL 1.0)
      string(APPEND disabled_targets |HWY_SVE_256|HWY_SVE2_128)
    endif()
    if(hwy_VERSION VERSION_GREATER_EQUAL 1.2)
      string(APPEND disabled_targets |HWY_NEON|HWY_NEON_BF16)  # no faster than HWY_NEON_WITHOUT_AES
    endif()
  endif()
  target_compile_definitions(srbf_build INTERFACE "HWY_DISABLED_TARGETS=(${disabled_targets})")
endif()
