# Highway, compiled from source. SRBF_STUBS are functions that the system lacks.
file(GLOB hwy_source ${SRBF_SOURCES}/highway-*)
string(REGEX MATCH "[0-9.]+$" hwy_VERSION ${hwy_source})
file(GLOB hwy_files ${hwy_source}/hwy/abort.cc ${hwy_source}/hwy/targets.cc ${hwy_source}/hwy/aligned_allocator.cc)
add_library(hwy STATIC ${hwy_files} ${SRBF_STUBS})
target_include_directories(hwy PUBLIC ${hwy_source})  # before another version's
add_library(hwy::hwy ALIAS hwy)
set(hwy_FOUND TRUE)
