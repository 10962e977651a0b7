// The floating-point mode of a thread: level 0.
#pragma once
#include <cstdint>

#if defined(__SSE__) || defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace srbf {

/// While it lives, the thread that made it computes in one known mode: it rounds to nearest, traps nothing, and takes subnormal floats and
/// doubles (below 2⁻¹²⁶ and 2⁻¹⁰²²) for 0, as operands and as results. Lobes underflow into them and products of lobes all the more, and
/// many processors take a hundred cycles and more for each. Afterwards the thread's mode and exception flags are what they were.
/// x86 (SSE's MXCSR) and 64-bit ARM (FPCR, FPSR); elsewhere it changes nothing.
class FlushSubnormals {
  public:
    FlushSubnormals() : before_(get()) { set(k_flushing); }
    ~FlushSubnormals() { set(before_); }
    FlushSubnormals(const FlushSubnormals&) = delete;
    FlushSubnormals& operator=(const FlushSubnormals&) = delete;

  private:
#if defined(__SSE__) || defined(_M_X64)
    using Mode = std::uint32_t;
    static constexpr Mode k_flushing = 0x9fc0;  // flush to zero, all exceptions masked, denormals are zero
    static Mode get() { return _mm_getcsr(); }
    static void set(Mode mode) { _mm_setcsr(mode); }
#elif defined(__aarch64__)
    struct Mode {
        std::uint64_t control, status;
    };
    static constexpr Mode k_flushing{std::uint64_t(1) << 24, 0};  // FZ
    static Mode get() {
        Mode mode;
        asm volatile("mrs %0, fpcr\n\tmrs %1, fpsr" : "=r"(mode.control), "=r"(mode.status));
        return mode;
    }
    static void set(Mode mode) {
        asm volatile("msr fpcr, %0\n\tmsr fpsr, %1" : : "r"(mode.control), "r"(mode.status) : "memory");
    }
#else
    struct Mode {};
    static constexpr Mode k_flushing{};
    static Mode get() { return {}; }
    static void set(Mode) {}
#endif
    Mode before_;
};

}  // namespace srbf
