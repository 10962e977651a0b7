// The system's calls for files, which file.cpp makes: those of POSIX, and of Windows under the same names. Paths are
// UTF-8.
#pragma once
#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <mutex>

#include "base/paths.h"

#ifdef _WIN32
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <io.h>
#include <process.h>
#include <windows.h>
#else
#include <sys/file.h>
#include <unistd.h>
#endif

namespace SRBF_NAMESPACE::system_files {

#ifdef _WIN32
using Status = struct ::_stat64;

/// Folders cannot be opened; EACCES says so, as for a folder that is not readable.
inline int open(const std::string& path, int flags, int mode) {
    return ::_wopen(path_of(path).c_str(), flags | _O_BINARY | _O_NOINHERIT, mode ? _S_IREAD | _S_IWRITE : 0);
}
inline int open_folder(const std::string&) { return errno = EACCES, -1; }
inline int close(int file) { return ::_close(file); }
inline long long read(int file, void* bytes, std::size_t size) {
    return ::_read(file, bytes, unsigned(std::min<std::size_t>(size, 1u << 30)));
}
inline long long write(int file, const void* bytes, std::size_t size) {
    return ::_write(file, bytes, unsigned(std::min<std::size_t>(size, 1u << 30)));
}
/// Does not move the position of `read`. If two threads call it, one waits for the other.
inline long long read_at(int file, void* bytes, std::size_t size, std::uint64_t offset) {
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    const auto before = ::_telli64(file);
    if (::_lseeki64(file, (long long)offset, SEEK_SET) < 0) return -1;
    const long long count = read(file, bytes, size);
    ::_lseeki64(file, before, SEEK_SET);
    return count;
}
inline int synchronise(int file) { return ::_commit(file); }
inline int lock(int) { return 0; }
inline int status(const std::string& path, Status& result) { return ::_wstat64(path_of(path).c_str(), &result); }
inline int status(int file, Status& result) { return ::_fstat64(file, &result); }
inline int process() { return ::_getpid(); }
inline bool is_writable(const std::string& path) { return ::_waccess(path_of(path).c_str(), 2) == 0; }
inline bool is_terminal(int file) { return ::_isatty(file) != 0; }
inline void remove(const std::string& path) { ::_wunlink(path_of(path).c_str()); }
/// Replaces a file that has the new name.
inline int rename(const std::string& from, const std::string& to) {
    if (::MoveFileExW(path_of(from).c_str(), path_of(to).c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
        return 0;
    return errno =
               ::GetLastError() == ERROR_FILE_NOT_FOUND || ::GetLastError() == ERROR_PATH_NOT_FOUND ? ENOENT : EACCES,
           -1;
}
#else
using Status = struct ::stat;

inline int open(const std::string& path, int flags, mode_t mode) {
    return ::open(path.c_str(), flags | O_CLOEXEC, mode);
}
inline int open_folder(const std::string& path) { return open(path, O_RDONLY | O_DIRECTORY, 0); }
inline int close(int file) { return ::close(file); }
inline ssize_t read(int file, void* bytes, std::size_t size) { return ::read(file, bytes, size); }
inline ssize_t write(int file, const void* bytes, std::size_t size) { return ::write(file, bytes, size); }
inline ssize_t read_at(int file, void* bytes, std::size_t size, std::uint64_t offset) {
    return ::pread(file, bytes, size, off_t(offset));
}
inline int synchronise(int file) { return ::fsync(file); }
inline int lock(int file) { return ::flock(file, LOCK_EX); }
inline int status(const std::string& path, Status& result) { return ::stat(path.c_str(), &result); }
inline int status(int file, Status& result) { return ::fstat(file, &result); }
inline int process() { return ::getpid(); }
inline bool is_writable(const std::string& path) { return ::access(path.c_str(), W_OK) == 0; }
inline bool is_terminal(int file) { return ::isatty(file) != 0; }
inline void remove(const std::string& path) { ::unlink(path.c_str()); }
inline int rename(const std::string& from, const std::string& to) { return std::rename(from.c_str(), to.c_str()); }
#endif

}  // namespace srbf::system_files
