// Fault injection: makes one system call or allocation of a program fail. LD_PRELOAD loads this library before the C
// library. From main() on, call number SRBF_FAIL_AT (from 0) of the kind SRBF_FAIL_CALL fails with the number
// SRBF_FAIL_ERROR, kills the program if that is 0, or stops it before the call if that is -1. At the end the number of
// calls of the kind is written to SRBF_FAIL_COUNT.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> calls = 0;
bool is_active = false;
const char* kind = "";
long fails_at = -1;
int error = 0;

/// Returns true if this call has to fail, and sets errno then.
bool must_fail(const char* call) {
    if (!is_active || std::strcmp(call, kind) != 0 || calls++ != fails_at) return false;
    if (error == 0) ::kill(::getpid(), SIGKILL);
    if (error < 0) return ::kill(::getpid(), SIGSTOP), false;
    errno = error;
    return true;
}

template <typename Function> Function* original(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

using Main = int(int, char**, char**);
Main* real_main = nullptr;

int main_with_failure(int argc, char** argv, char** environment) {
    kind = std::getenv("SRBF_FAIL_CALL");
    fails_at = std::atol(std::getenv("SRBF_FAIL_AT"));
    error = std::atoi(std::getenv("SRBF_FAIL_ERROR"));
    is_active = true;
    const int status = real_main(argc, argv, environment);
    is_active = false;
    if (std::FILE* out = std::fopen(std::getenv("SRBF_FAIL_COUNT"), "w")) {
        std::fprintf(out, "%ld", calls.load());
        std::fclose(out);
    }
    return status;
}

}  // namespace

extern "C" {

int __libc_start_main(Main* main, int argc, char** argv, void (*init)(), void (*fini)(), void (*loader_fini)(),
                      void* stack_end) {
    real_main = main;
    using Start = int(Main*, int, char**, void (*)(), void (*)(), void (*)(), void*);
    return original<Start>("__libc_start_main")(main_with_failure, argc, argv, init, fini, loader_fini, stack_end);
}

// Calls for memory use glibc's internal names, because looking up a name allocates.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void* malloc(std::size_t size) { return must_fail("malloc") ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) { return must_fail("malloc") ? nullptr : __libc_calloc(count, size); }
void* realloc(void* at, std::size_t size) { return must_fail("malloc") ? nullptr : __libc_realloc(at, size); }
void* aligned_alloc(std::size_t to, std::size_t size) {
    return must_fail("malloc") ? nullptr : __libc_memalign(to, size);
}
int posix_memalign(void** at, std::size_t to, std::size_t size) {
    if (must_fail("malloc")) return ENOMEM;
    *at = __libc_memalign(to, size);
    return *at == nullptr ? ENOMEM : 0;
}

int open(const char* path, int flags, ...) {
    va_list rest;
    va_start(rest, flags);
    const auto mode = static_cast<mode_t>(va_arg(rest, int));
    va_end(rest);
    return must_fail("open") ? -1 : ::openat(AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) __attribute__((alias("open")));
ssize_t read(int file, void* to, std::size_t size) {
    static auto* const call = original<ssize_t(int, void*, std::size_t)>("read");
    return must_fail("read") ? -1 : call(file, to, size);
}
ssize_t pread(int file, void* to, std::size_t size, off_t at) {
    static auto* const call = original<ssize_t(int, void*, std::size_t, off_t)>("pread");
    return must_fail("read") ? -1 : call(file, to, size, at);
}
ssize_t pread64(int file, void* to, std::size_t size, off64_t at) {
    static auto* const call = original<ssize_t(int, void*, std::size_t, off64_t)>("pread64");
    return must_fail("read") ? -1 : call(file, to, size, at);
}
ssize_t write(int file, const void* from, std::size_t size) {
    static auto* const call = original<ssize_t(int, const void*, std::size_t)>("write");
    return must_fail("write") ? -1 : call(file, from, size);
}
int fsync(int file) {
    static auto* const call = original<int(int)>("fsync");
    return must_fail("fsync") ? -1 : call(file);
}
int rename(const char* from, const char* to) {
    static auto* const call = original<int(const char*, const char*)>("rename");
    return must_fail("rename") ? -1 : call(from, to);
}
int close(int file) {
    static auto* const call = original<int(int)>("close");
    const int status = call(file);
    return must_fail("close") ? -1 : status;
}
void* mmap(void* at, std::size_t size, int protection, int flags, int file, off_t offset) {
    static auto* const call = original<void*(void*, std::size_t, int, int, int, off_t)>("mmap");
    return must_fail("mmap") ? MAP_FAILED : call(at, size, protection, flags, file, offset);
}

}  // extern "C"
