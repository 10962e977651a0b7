// Functions that compilers call for exceptions, which the library does not throw, and at the end of a thread. There is
// one thread.
#include <cstddef>
#include <cstdlib>

extern "C" {
void* __cxa_allocate_exception(std::size_t) { std::abort(); }
void __cxa_throw(void*, void*, void (*)(void*)) { std::abort(); }
int __cxa_thread_atexit(void (*)(void*), void*, void*) { return 0; }
}
