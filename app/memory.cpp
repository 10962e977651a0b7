#include "app/memory.h"

#include "base/system_files.h"

#ifndef _WIN32
#include <sys/resource.h>
#endif

namespace srbf {
namespace {

bool is_limited = false;

}  // namespace

#ifdef _WIN32
void limit_memory(int megabytes) {
    // A process that is in a job already gets one within it.
    const HANDLE job = ::CreateJobObjectW(nullptr, nullptr);
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION limit{};
    limit.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_PROCESS_MEMORY;
    limit.ProcessMemoryLimit = std::size_t(megabytes) << 20;
    ::SetInformationJobObject(job, JobObjectExtendedLimitInformation, &limit, sizeof limit);
    ::AssignProcessToJobObject(job, ::GetCurrentProcess());
    is_limited = true;
}

std::uint64_t free_memory() {
    MEMORYSTATUSEX status{};
    status.dwLength = sizeof status;
    return ::GlobalMemoryStatusEx(&status) ? status.ullAvailPhys : 0;
}
#else
void limit_memory(int megabytes) {
    rlimit limit{};
    ::getrlimit(RLIMIT_DATA, &limit);
    limit.rlim_max = std::min(limit.rlim_max, rlim_t(megabytes) << 20);
    limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
    ::setrlimit(RLIMIT_DATA, &limit);  // lowering the limit is always permitted
    is_limited = true;
}

std::uint64_t free_memory() {
    const long pages = ::sysconf(_SC_AVPHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? std::uint64_t(pages) * std::uint64_t(page) : 0;
}
#endif

Result<Done> check_drawing() {
    if (is_limited)
        return Error{"OpenGL", {}, "memory", "no --max-memory, since OpenGL's drivers crash under a limit", "a limit"};
    return Done{};
}

}  // namespace srbf
