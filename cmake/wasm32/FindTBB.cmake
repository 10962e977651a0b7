add_library(TBB::tbb INTERFACE IMPORTED)  # headers alone, of `include`
set(TBB_FOUND TRUE)
