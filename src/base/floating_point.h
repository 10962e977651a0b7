// The floating-point mode of a thread.
#pragma once
#include <cstdint>

#if defined(__SSE__) || defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace srbf {

/// Sets the floating-point mode of the current thread for its lifetime to what IEEE 754 has by default: round to nearest, no
/// traps, and subnormal numbers kept. A caller may have set another. The destructor restores the mode and the exception
/// flags. x86 (SSE's MXCSR) and 64-bit ARM (FPCR, FPSR); no effect elsewhere.
///
/// A mode that takes subnormal floats, below 2⁻¹²⁶, for 0 would be faster, but processors have different ones (x86 after
/// rounding, ARM before, WebAssembly none), and a fit depends on the difference: far from its peak a lobe is as small, and steps are
/// scaled by what there is. columns.cpp keeps them out of the sums instead. Exponentials may not be cut off earlier: a lobe on
/// its way may have its peak where nothing is seen.
class StandardArithmetic {
  public:
    StandardArithmetic() : before_(get()) { set(k_standard); }
    ~StandardArithmetic() { set(before_); }
    StandardArithmetic(const StandardArithmetic&) = delete;
    StandardArithmetic& operator=(const StandardArithmetic&) = delete;

  private:
#if defined(__SSE__) || defined(_M_X64)
    using Mode = std::uint32_t;
    static constexpr Mode k_standard = 0x1f80;  // all exceptions masked
    static Mode get() { return _mm_getcsr(); }
    static void set(Mode mode) { _mm_setcsr(mode); }
#elif defined(__aarch64__)
    struct Mode {
        std::uint64_t control, status;
    };
    static constexpr Mode k_standard{0, 0};
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
    static constexpr Mode k_standard{};
    static Mode get() { return {}; }
    static void set(Mode) {}
#endif
    Mode before_;
};

}  // namespace srbf
