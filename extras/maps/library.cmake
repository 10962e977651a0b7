list(APPEND reading extras/maps/npy.cpp)
list(APPEND dispatched extras/maps/texel_sums.cpp)
