# TBB, compiled from source.
file(GLOB tbb_source ${SRBF_SOURCES}/oneTBB-* ${SRBF_SOURCES}/onetbb-*)
file(GLOB tbb_files ${tbb_source}/src/tbb/*.cpp)
add_library(tbb STATIC ${tbb_files})
target_include_directories(tbb SYSTEM PUBLIC ${tbb_source}/include)
target_compile_definitions(tbb PRIVATE __TBB_BUILD __TBB_DYNAMIC_LOAD_ENABLED=0 PUBLIC __TBB_NO_IMPLICIT_LINKAGE)
target_compile_options(tbb PRIVATE -w -mrtm -mwaitpkg)
add_library(TBB::tbb ALIAS tbb)
set(TBB_FOUND TRUE)
