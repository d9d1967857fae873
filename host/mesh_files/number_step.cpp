#include "host/mesh_files/number_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace enamel::host {
namespace {

/// Of a step: a number printed with fewer digits than it has is still one of a float.
constexpr double kOfAStep = 1e-3;
/// 1 m to 1 um, the decimals that could matter.
constexpr std::array<double, 7> kDecimalStepsMm{1e3, 1e2, 1e1, 1.0, 1e-1, 1e-2, 1e-3};

double float_step(double value) {
  const auto f = static_cast<float>(std::fabs(value));
  return static_cast<double>(std::nextafter(f, std::numeric_limits<float>::infinity()) - f);
}

bool is_float(double value) {
  return std::fabs(value - static_cast<double>(static_cast<float>(value))) <= kOfAStep * float_step(value);
}

bool is_multiple(double value, double step) {
  const double steps = value / step;
  return std::fabs(steps - std::round(steps)) <= kOfAStep;
}

double axis_step(const std::vector<Vec3d>& positions, int axis, bool floats) {
  double low = positions[0][axis], high = low;
  for (const Vec3d& p : positions) {
    low = std::min(low, p[axis]);
    high = std::max(high, p[axis]);
  }
  const double step = float_step(std::max(std::fabs(low), std::fabs(high)));
  if (floats) {
    return step;
  }
  if (low == high) {  // a plane along the axis: nothing that a step could have taken
    return 0;
  }
  const auto all = [&](auto holds) {
    return std::all_of(positions.begin(), positions.end(), [&](const Vec3d& p) { return holds(p[axis]); });
  };
  for (const double decimal : kDecimalStepsMm) {
    if (all([&](double value) { return is_multiple(value, decimal); })) {
      return std::max(decimal, all(is_float) ? step : 0.0);
    }
  }
  return all(is_float) ? step : 0.0;
}

}  // namespace

double number_step(const std::vector<Vec3d>& positions, const Vec3d& origin_mm, bool floats) {
  double step = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (origin_mm[axis] != 0.0) {
      step = std::max(step, axis_step(positions, axis, floats));
    }
  }
  return step;
}

}  // namespace enamel::host
