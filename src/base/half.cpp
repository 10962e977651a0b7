#include "base/half.h"

#include <Eigen/Core>

namespace SRBF_NAMESPACE {

std::uint16_t to_half(float x) { return Eigen::numext::bit_cast<std::uint16_t>(Eigen::half(x)); }

float from_half(std::uint16_t bits) { return float(Eigen::numext::bit_cast<Eigen::half>(bits)); }

}  // namespace
