// Elementary functions that return the same bits on every processor and with every compiler.
#pragma once
#include "srbf/version.h"

SRBF_BEGIN

/// The functions of <cmath> that IEEE 754 does not define to the last bit, as one text of additions, multiplications,
/// divisions and square roots, which it does define: series for reduced arguments. No fit and no report depends on a
/// C library, whose versions differ in last bits, and by the processor. Relative errors are in units of the last place
/// of a double, 2⁻⁵², measured against `long double` functions on a million arguments. A NaN returns a NaN.
/// Functions of float are rounded from double.
namespace elementary {

/// e^x: 1 ulp. 0 below −708, where results would be subnormal; ∞ above 709.78.
double exp(double x);
/// 2^x = e^(x ln 2), within 1 + |x| ulp.
double exp2(double x);
/// ln x: 2 ulp. −∞ at 0, NaN below.
double log(double x);
/// ln x / ln 2 and ln x / ln 10: 3 ulp.
double log2(double x);
double log10(double x);
/// ln(1 + x): 3 ulp; NaN below −1.
double log1p(double x);
constexpr double square(double x) { return x * x; }
/// x^y = e^(y ln x), within 2 + 2 |y ln x| ulp; for x < 0 it is ±(−x)^y if y is whole, otherwise NaN.
double pow(double x, double y);
/// ∛x: 1 ulp, of either sign.
double cbrt(double x);
/// x in radians: 3 ulp for |x| ≤ 10⁵; beyond, the sine or cosine of the remainder of x by the double 2π. NaN for ∞.
double sin(double x);
double cos(double x);
/// The angle of the point (x, y) in [−π, π]: 4 ulp. Signs and zeros as in <cmath>.
double atan2(double y, double x);
/// atan2(x, √(1 − x²)) and atan2(√(1 − x²), x): 6 ulp; NaN beyond −1 and 1.
double asin(double x);
double acos(double x);
/// √(x² + y²) and √(x² + y² + z²): 2 ulp where no square overflows or underflows.
double hypot(double x, double y);
double hypot(double x, double y, double z);

/// Functions of floats, by shorter series in double: within 0.51 ulp of float.
float exp(float x);
float log(float x);
inline float exp2(float x) { return float(exp2(double(x))); }
inline float log1p(float x) { return float(log1p(double(x))); }
inline float pow(float x, float y) { return float(pow(double(x), double(y))); }
inline float sin(float x) { return float(sin(double(x))); }
inline float cos(float x) { return float(cos(double(x))); }
inline float atan2(float y, float x) { return float(atan2(double(y), double(x))); }
inline float acos(float x) { return float(acos(double(x))); }
inline float hypot(float x, float y) { return float(hypot(double(x), double(y))); }
inline float hypot(float x, float y, float z) { return float(hypot(double(x), double(y), double(z))); }

}  // namespace elementary
SRBF_END
