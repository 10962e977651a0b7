// The floating-point mode of a thread.
#pragma once
#include <cstdint>

#if defined(__SSE__) || defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace SRBF_NAMESPACE {

/// Sets the default floating-point mode of IEEE 754 for the current thread: round to nearest, no traps, and subnormal
/// numbers kept. The destructor restores the caller's mode and exception flags. Implemented for x86 (SSE's MXCSR) and
/// 64-bit ARM (FPCR, FPSR); has no effect elsewhere.
///
/// A mode that flushes subnormal floats (below 2⁻¹²⁶) to 0 would be faster. But x86 detects them after rounding, ARM
/// before, and WebAssembly has no such mode. Fits would depend on the processor, since lobes are as small far from
/// their peaks, and steps are scaled by derivatives there. simd_columns.cpp keeps subnormal numbers out of its sums
/// instead.
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

}  // namespace
