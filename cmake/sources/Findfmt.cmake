# fmt, header-only.
find_path(FMT_INCLUDE_DIR fmt/format.h PATHS /usr/include)
add_library(fmt::fmt INTERFACE IMPORTED)
target_include_directories(fmt::fmt INTERFACE ${FMT_INCLUDE_DIR})
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY "FMT_STATIC_THOUSANDS_SEPARATOR=','") # without std::locale, which is large
set(fmt_FOUND TRUE)
