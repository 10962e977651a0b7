add_library(TBB::tbb INTERFACE IMPORTED)  # our own headers in `include`, which use one thread
set(TBB_FOUND TRUE)
