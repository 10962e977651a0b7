# WebAssembly with vectors of 128 bits by Debian's clang and wasi-libc: fits must be the same there. It has no threads,
# exceptions or folders: `include` has replacements.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_CXX_COMPILER clang++-22)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_AR llvm-ar-22 CACHE FILEPATH "")
set(CMAKE_RANLIB llvm-ranlib-22 CACHE FILEPATH "")
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
get_filename_component(CMAKE_FIND_ROOT_PATH ${CMAKE_CURRENT_LIST_DIR}/../../build/sysroot ABSOLUTE)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR} ${CMAKE_CURRENT_LIST_DIR}/../sources)
set(SRBF_STUBS ${CMAKE_CURRENT_LIST_DIR}/stubs.cpp)  # compiled with Highway, by ../sources/Findhwy.cmake
get_filename_component(SRBF_SOURCES ${CMAKE_CURRENT_LIST_DIR}/../../build/sources ABSOLUTE)
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -I ${CMAKE_CURRENT_LIST_DIR}/include -D_WASI_EMULATED_GETPID")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-lwasi-emulated-getpid -Wl,-z,stack-size=8388608")
