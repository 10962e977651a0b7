// The namespace of the library.
#pragma once

#if __cplusplus <= 201703L && !defined _MSC_VER
#error srbf needs C++20: compile with -std=c++20
#include "C++20"  // there is no such file: compilers end here, without errors in what follows
#endif

// Names belong to an inline namespace with the version, as srbf::v0_1::fit. Programs write srbf::fit, and a linker
// keeps two versions in one process apart.
#define SRBF_NAMESPACE srbf::inline v0_1
// Around declarations of public headers. Only the shared library, for which CMake defines srbf_EXPORTS, makes them
// visible: a plugin that links the static one exports none of them.
#ifdef srbf_EXPORTS
#define SRBF_VISIBLE [[gnu::visibility("default")]]
#else
#define SRBF_VISIBLE
#endif
// clang-format off
#define SRBF_BEGIN namespace SRBF_VISIBLE srbf { inline namespace v0_1 {
#define SRBF_END }}
