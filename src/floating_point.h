// The floating-point mode of a thread: level 0.
#pragma once
#include <cstdint>

#if defined(__SSE__) || defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace srbf {

/// Sets the floating-point mode of the current thread for its lifetime: round to nearest, no traps, and subnormal
/// floats and doubles (below 2⁻¹²⁶ and 2⁻¹⁰²²) count as 0, as operands and as results. Lobes and their products often
/// underflow, and many processors take a hundred cycles and more for a subnormal. The destructor restores the mode and
/// the exception flags. x86 (SSE's MXCSR) and 64-bit ARM (FPCR, FPSR); no effect elsewhere. No result depends on the
/// flushing, which processors define differently (x86 after rounding, ARM before) and WebAssembly lacks: with
/// SRBF_KEEP_SUBNORMALS defined it is left out, and fits are the same.
class FlushSubnormals {
  public:
    FlushSubnormals() : before_(get()) { set(k_flushing); }
    ~FlushSubnormals() { set(before_); }
    FlushSubnormals(const FlushSubnormals&) = delete;
    FlushSubnormals& operator=(const FlushSubnormals&) = delete;

  private:
#if defined(__SSE__) || defined(_M_X64)
    using Mode = std::uint32_t;
#ifdef SRBF_KEEP_SUBNORMALS
    static constexpr Mode k_flushing = 0x1f80;  // all exceptions masked
#else
    static constexpr Mode k_flushing = 0x9fc0;  // also flush to zero, denormals are zero
#endif
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
