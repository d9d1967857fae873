#include "tools/twin/jaw/dentition.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/twin/degrees.hpp"
#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

struct Size {
  double mesiodistal, buccolingual, height;
};
constexpr std::array<Size, 7> kLower{{{5.3, 6.0, 8.8},
                                      {5.8, 6.4, 9.0},
                                      {6.9, 7.6, 10.2},
                                      {7.0, 7.7, 8.2},
                                      {7.2, 8.2, 7.6},
                                      {11.2, 10.5, 6.9},
                                      {10.6, 10.2, 6.6}}};
constexpr std::array<Size, 7> kUpper{{{8.6, 7.0, 10.2},
                                      {6.7, 6.2, 9.0},
                                      {7.6, 8.0, 9.8},
                                      {7.1, 9.2, 8.2},
                                      {6.9, 9.2, 7.8},
                                      {10.3, 11.2, 7.0},
                                      {9.6, 11.0, 6.7}}};

void front_profiles(ToothForm& f) {
  const bool canine = f.kind == ToothKind::kCanine;
  f.rounding = 0.45;
  f.width = canine ? Profile{0.74, 0.88, 0.98, 0.98, 0.80} : Profile{0.66, 0.78, 0.91, 1.0, 0.99};
  f.thickness = canine ? Profile{0.95, 0.97, 0.76, 0.50, 0.30} : Profile{0.94, 0.90, 0.60, 0.37, 0.21};
  f.lean = canine ? Profile{0.0, 0.04, 0.10, 0.12, 0.10} : Profile{0.0, 0.06, 0.18, 0.22, 0.22};
}

void back_profiles(ToothForm& f, JawSide side) {
  const bool molar = f.kind == ToothKind::kMolar;
  f.square = molar;
  f.rounding = molar ? 1.0 : 0.9;
  f.width = molar ? Profile{0.83, 0.92, 0.99, 0.99, 0.90} : Profile{0.76, 0.88, 0.98, 0.98, 0.84};
  f.thickness = molar ? Profile{0.91, 1.0, 0.97, 0.88, 0.74} : Profile{0.90, 1.0, 0.97, 0.86, 0.70};
  // Lower crowns lean to the tongue, upper ones hardly.
  const double lean = side == JawSide::kLower ? -0.14 : -0.03;
  f.lean = {0.03, 0.02, 0.3 * lean, 0.7 * lean, lean};
}

void premolar_cusps(ToothForm& f, int number, JawSide side) {
  const double w = f.mesiodistal, b = f.buccolingual, h = f.height;
  const double low = side == JawSide::kUpper ? 0.7 : (number == 4 ? 1.9 : 1.0);
  f.cusps = {{-0.02 * w, 0.24 * b, h, 0.72}, {-0.04 * w, -0.30 * b, h - low, 0.62}};
  if (side == JawSide::kLower && number == 5) {  // three-cusp type
    f.cusps[1] = {-0.16 * w, -0.28 * b, h - low, 0.66};
    f.cusps.push_back({0.20 * w, -0.27 * b, h - low - 0.35, 0.66});
    f.side_grooves = {{0.04 * w, -1, 0.22}};
  }
}

void molar_cusps(ToothForm& f, int number, JawSide side) {
  const double w = f.mesiodistal, b = f.buccolingual, h = f.height;
  if (side == JawSide::kLower && number == 6) {  // five cusps
    f.cusps = {{-0.28 * w, 0.25 * b, h - 0.15, 0.66},
               {0.06 * w, 0.26 * b, h - 0.25, 0.66},
               {0.33 * w, 0.13 * b, h - 0.7, 0.66},
               {-0.24 * w, -0.30 * b, h, 0.66},
               {0.20 * w, -0.30 * b, h - 0.1, 0.66}};
    f.side_grooves = {{-0.11 * w, 1, 0.38}, {0.22 * w, 1, 0.25}, {-0.02 * w, -1, 0.32}};
  } else if (side == JawSide::kLower) {
    f.cusps = {{-0.24 * w, 0.25 * b, h - 0.1, 0.64},
               {0.24 * w, 0.24 * b, h - 0.3, 0.64},
               {-0.24 * w, -0.29 * b, h, 0.64},
               {0.23 * w, -0.29 * b, h - 0.15, 0.64}};
    f.side_grooves = {{0, 1, 0.35}, {0, -1, 0.3}};
  } else {  // upper: mesio-palatal cusp largest, oblique ridge towards the disto-buccal one
    const double small = number == 6 ? 0.0 : 0.6;
    f.cusps = {{-0.24 * w, 0.29 * b, h, 0.66},
               {0.22 * w, 0.27 * b, h - 0.25, 0.62},
               {-0.16 * w, -0.24 * b, h - 0.05, 0.52},
               {0.30 * w, -0.30 * b, h - 0.9 - small, 0.66}};
    f.side_grooves = {{-0.01 * w, 1, 0.35}, {0.14 * w, -1, 0.32}};
  }
}

/// Draws in a fixed order; one generator a tooth, so that a change of one leaves the others.
class Variation {
 public:
  Variation(std::uint64_t seed, std::uint64_t stream) : random_(seed, stream) {}
  double scale(double spread) { return 1.0 + spread * signed_unit(); }
  double offset(double spread) { return spread * signed_unit(); }
  /// [-1, 1], denser in the middle.
  double signed_unit() {
    const double a = random_.uniform(counter_++), b = random_.uniform(counter_++);
    return a + b - 1.0;
  }

 private:
  CounterRandom random_;
  std::uint64_t counter_ = 0;
};

void vary(ToothForm& f, Variation& v, double common) {
  f.mesiodistal *= common * v.scale(0.05);
  f.buccolingual *= common * v.scale(0.06);
  f.height *= v.scale(0.07);
  for (auto& c : f.cusps) {
    c.x += v.offset(0.45);
    c.y += v.offset(0.3);
    c.z += v.offset(0.35);
    c.slope *= v.scale(0.14);
  }
  for (auto& g : f.side_grooves) g.depth *= v.scale(0.4);
}

PlacedTooth place(ToothForm form, double s, const Arch& arch, Variation& v) {
  PlacedTooth t;
  const bool front = form.kind == ToothKind::kIncisor || form.kind == ToothKind::kCanine;
  const Eigen::Vector2d tangent = arch.tangent(s), out = arch.buccal(s), at = arch.point(s);
  Eigen::Matrix3d frame = Eigen::Matrix3d::Zero();
  // x points distally on both sides: the left quadrant is the mirror image of the right one.
  const double distal = s < 0 ? -1.0 : 1.0;
  frame.col(0) = distal * Eigen::Vector3d(tangent.x(), tangent.y(), 0);
  frame.col(1) = Eigen::Vector3d(out.x(), out.y(), 0);
  frame.col(2) = Eigen::Vector3d::UnitZ();
  const double rotate = v.offset(front ? 11.0 : 6.0), tip = v.offset(4.0), torque = v.offset(4.0);
  t.R = frame * Eigen::AngleAxisd(rotate * kRadPerDeg, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
        Eigen::AngleAxisd(tip * kRadPerDeg, Eigen::Vector3d::UnitY()).toRotationMatrix() *
        Eigen::AngleAxisd(torque * kRadPerDeg, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const double spee = -0.9 * std::sin(std::min(1.0, std::abs(s) / 55.0) * std::numbers::pi);
  const double stagger = v.offset(front ? 0.55 : 0.3);
  t.origin = Eigen::Vector3d(at.x() + stagger * out.x(), at.y() + stagger * out.y(), spee + v.offset(0.3));
  t.form = std::move(form);
  t.s = s;
  return t;
}

}  // namespace

ToothForm nominal_form(JawSide side, int number) {
  const Size& size = (side == JawSide::kLower ? kLower : kUpper)[static_cast<std::size_t>(number - 1)];
  ToothForm f;
  f.mesiodistal = size.mesiodistal;
  f.buccolingual = size.buccolingual;
  f.height = size.height;
  f.kind = number <= 2   ? ToothKind::kIncisor
           : number == 3 ? ToothKind::kCanine
           : number <= 5 ? ToothKind::kPremolar
                         : ToothKind::kMolar;
  if (number <= 3) {
    front_profiles(f);
  } else {
    back_profiles(f, side);
    if (number <= 5) {
      premolar_cusps(f, number, side);
    } else {
      molar_cusps(f, number, side);
    }
  }
  return f;
}

Dentition make_dentition(JawSide side, int last, bool both_sides, std::uint64_t seed, OpenGap open) {
  Dentition out;
  Variation whole(seed, 1000);
  const double common = whole.scale(0.04);
  const double upper = side == JawSide::kUpper ? 1.0 : 0.0;
  out.shape.half_width_mm = (25.5 + 2.0 * upper) * common * whole.scale(0.06);
  out.shape.depth_mm = (38.5 + 2.5 * upper) * common * whole.scale(0.06);
  out.shape.exponent = 2.35 + whole.offset(0.3);
  const Arch arch(out.shape);
  for (const double hand : {-1.0, 1.0}) {
    if (hand < 0 && !both_sides) continue;
    double edge = 0.06;
    for (int number = 1; number <= last; ++number) {
      Variation v(seed, static_cast<std::uint64_t>(number + (hand < 0 ? 100 : 0)));
      ToothForm form = nominal_form(side, number);
      vary(form, v, common);
      const double gap = 0.06 + 0.1 * std::abs(v.signed_unit());
      const double s = edge + 0.5 * form.mesiodistal;
      edge = s + 0.5 * form.mesiodistal + gap + (hand > 0 && number == open.behind ? open.mm : 0.0);
      out.teeth.push_back(place(std::move(form), hand * s, arch, v));
    }
  }
  std::sort(out.teeth.begin(), out.teeth.end(), [](const auto& a, const auto& b) { return a.s < b.s; });
  return out;
}

}  // namespace enamel::twin
