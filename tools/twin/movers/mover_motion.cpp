#include "tools/twin/movers/mover_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kRampS = 0.6;  // length of the way in, and of that out
constexpr double kAwayMm = 14;  // beyond its own half width: out of the view of 17 mm

double smooth(double u) {
  const double c = std::clamp(u, 0.0, 1.0);
  return c * c * c * (c * (6.0 * c - 15.0) + 10.0);
}

}  // namespace

double MoverMotion::Wave::at(double t_s) const { return amplitude * std::sin(omega * t_s + phase); }

MoverMotion::MoverMotion(const MoverConfig& config, std::uint64_t seed, double scan_s, LookedAt looked_at)
    : config_(config), seed_(seed), looked_at_(std::move(looked_at)) {
  const CounterRandom random(seed_, 0x6D6F7665);
  std::uint64_t counter = 0;
  for (Wave& wave : bend_)
    wave = {1.0, kTurn * random.uniform(counter++, 0.3, 0.8), random.uniform(counter++, 0, kTurn)};
  const double there_s = config.share * scan_s;
  if (there_s <= 0) return;
  const int visits = std::max(1, static_cast<int>(std::lround(there_s / config.visit_s)));
  const double cell_s = scan_s / visits, visit_s = there_s / visits;
  for (int i = 0; i < visits; ++i) {
    // One a cell of the scan's time: never two at once, and the whole lasts what was asked for.
    const double begin = cell_s * i + random.uniform(counter++) * (cell_s - visit_s);
    visits_.push_back(draw_visit(static_cast<std::uint64_t>(i), begin - 0.5 * kRampS, begin + visit_s + 0.5 * kRampS));
  }
}

MoverMotion::Visit MoverMotion::draw_visit(std::uint64_t number, double begin_s, double end_s) const {
  const CounterRandom random(seed_, 0x76697369 + number);
  std::uint64_t c = 0;
  Visit v{begin_s, end_s};
  v.T_model_place = looked_at_.place(0.5 * (begin_s + end_s));
  const bool either = config_.kind == MoverKind::kFinger || config_.kind == MoverKind::kCotton;
  const bool outwards = either ? random.uniform(c++) < 0.5 : config_.kind == MoverKind::kCheek;
  v.side = outwards ? 1 : -1;
  constexpr double kFingerYaw = 0.9, kYaw = 0.25;  // rad: a finger comes in aslant
  const double yaw = config_.kind == MoverKind::kFinger ? kFingerYaw : kYaw;
  v.yaw_rad = random.uniform(c++, -yaw, yaw);
  constexpr double kSpreadMm = 2;
  v.reach_mm = config_.reach_mm + random.uniform(c++, -kSpreadMm, kSpreadMm);
  v.depth_mm = config_.depth_mm + 0.5 * random.uniform(c++, -kSpreadMm, kSpreadMm);
  for (std::size_t axis = 0; axis < v.wobble.size(); ++axis) {
    const bool turns = axis >= 3;
    const double omega = kTurn * random.uniform(c++, 0.4, 1.2);
    // Peak speeds of three axes at once: a square root of three above one axis'.
    const double peak = config_.speed_mm_s / std::numbers::sqrt3 / omega;
    constexpr double kLeverMm = 40;  // turns move its ends about half as fast as the wobble does
    v.wobble[axis] = {turns ? peak / kLeverMm : peak, omega, random.uniform(c++, 0, kTurn)};
  }
  return v;
}

std::optional<Pose> MoverMotion::at(double t_s) const {
  const auto there = [&](const Visit& v) { return t_s > v.begin_s && t_s < v.end_s; };
  const auto v = std::find_if(visits_.begin(), visits_.end(), there);
  if (v == visits_.end()) return std::nullopt;
  const Vec3d half = mover_form(config_.kind).half;
  const double in = smooth((t_s - v->begin_s) / kRampS) * smooth((v->end_s - t_s) / kRampS);
  const double middle = 0.5 * (v->begin_s + v->end_s);
  Pose out = v->T_model_place;
  out.pretranslate(config_.follow * (looked_at_.way(t_s) - looked_at_.way(middle)));
  Vec3d offset(0, v->side * (half.y() - v->reach_mm), v->depth_mm - half.z());
  offset.y() += v->side * (1 - in) * (2 * half.y() + kAwayMm);
  for (int k = 0; k < 3; ++k) offset[k] += v->wobble[static_cast<std::size_t>(k)].at(t_s);
  out.translate(offset);
  out.rotate(Eigen::AngleAxisd(v->yaw_rad + v->wobble[5].at(t_s), Vec3d::UnitZ()));
  out.rotate(Eigen::AngleAxisd(v->wobble[4].at(t_s), Vec3d::UnitY()));
  out.rotate(Eigen::AngleAxisd(v->wobble[3].at(t_s), Vec3d::UnitX()));
  return out;
}

Bend MoverMotion::bend(double t_s) const { return {bend_[0].at(t_s), bend_[1].at(t_s)}; }

}  // namespace enamel::twin
