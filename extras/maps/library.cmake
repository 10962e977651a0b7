list(APPEND SRBF_READER_SOURCES extras/maps/npy.cpp)
list(APPEND SRBF_SIMD_SOURCES extras/maps/texel_sums.cpp)
