#include "pipeline/register/stops/slip.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/register/stops/slip_search.hpp"
#include "pipeline/register/stops/stop_pairs.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kAlike = 2.5;  // chosen: of sigmas that guesses differ by; a lost step and a turned model never do

}  // namespace

Pose StopFollower::told(std::size_t i, const AxesOffset& by) const {
  return pose_by_axes(mount_, stops_[i].angles, by);
}

/// Stops before i that see much of what i should see, most first.
std::vector<std::size_t> StopFollower::beside(std::size_t i, const Pose& T) const {
  std::vector<std::pair<double, std::size_t>> found;
  for (std::size_t j = 0; j < i; ++j) {
    if (out_.laid[j] == Laid::kNot) continue;
    const double share = overlap_of(stops_[i].node, stops_[j].node, ViewCamera(with_.lens),
                                    out_.T_model_cam[j].inverse() * T, config_.gate_mm);
    if (share >= config_.min_overlap) found.emplace_back(-share, j);
  }
  std::ranges::sort(found);
  std::vector<std::size_t> out;
  for (const auto& [share, j] : found) {
    if (out.size() < config_.tried_on) out.push_back(j);
  }
  return out;
}

Matrix6 StopFollower::covariance_of(std::size_t k, const Vec3d& centre) const {
  const AxesOffset& by = k < out_.offsets.size() ? out_.offsets[k] : now_;
  const AxisMotions motions = axis_motions(mount_, stops_[k].angles, by, centre, with_.icp.rho_mm);
  return pose_covariance(motions, config_.stop, with_.icp.rho_mm);
}

std::optional<StopFollower::Word> StopFollower::word_of(std::size_t j, std::size_t i, const Pose& T) const {
  const Pose start = out_.T_model_cam[j].inverse() * T;
  const auto edge = measure_edge(stops_[i].node, stops_[j].node, with_.lens, start, with_.icp, with_.edge);
  if (!edge) return std::nullopt;
  Word word{out_.T_model_cam[j] * edge->T_j_i};
  const Vec3d centre = out_.T_model_cam[j] * edge->centre;
  const Vector6 x = motion_between(T, word.T, centre, with_.icp.rho_mm);
  Matrix6 C = covariance_of(i, centre) + covariance_of(j, centre);
  C.diagonal().array() += config_.edge_sigma_mm * config_.edge_sigma_mm;
  word.sigmas = std::sqrt(x.dot(C.ldlt().solve(x)));
  word.shift_mm = x.tail<3>().norm();
  return word;
}

/// The nearest of what those stops say; none where none of them can be laid from there.
std::optional<StopFollower::Word> StopFollower::best_word(const std::vector<std::size_t>& others, std::size_t i,
                                                          const Pose& T) const {
  std::optional<Word> best;
  for (const std::size_t j : others) {
    const auto word = word_of(j, i, T);
    if (word && (!best || word->sigmas < best->sigmas)) best = word;
  }
  return best;
}

/// Several guesses may pass the gate where the axes turned little since the slip: they are compared with each other,
/// and the likeliest of those that fit about equally well is kept on with. That none fits says nothing of them.
std::optional<StopFollower::Word> StopFollower::tell_apart(std::size_t i, const std::vector<std::size_t>& others) {
  std::vector<std::optional<Word>> words;
  double least = config_.sigmas;
  for (const Guess& guess : guesses_) {
    words.push_back(best_word(others, i, told(i, guess.offset)));
    if (words.back()) least = std::min(least, words.back()->sigmas);
  }
  std::vector<Guess> left;
  std::optional<Word> of_first;
  for (std::size_t n = 0; n < guesses_.size(); ++n) {
    if (!words[n] || words[n]->sigmas > std::min(least + kAlike, config_.sigmas)) continue;
    if (left.empty()) of_first = words[n];
    left.push_back(guesses_[n]);
  }
  if (left.empty()) return words.front();
  now_ = left.front().offset;
  out_.slips.back().kind = left.front().kind;
  guesses_ = left.size() > 1 ? std::move(left) : std::vector<Guess>();
  return of_first;
}

const Pose& StopFollower::follow(Stop stop) {
  stops_.push_back(std::move(stop));
  lay(stops_.size() - 1);
  return out_.T_model_cam.back();
}

void StopFollower::lay(std::size_t i) {
  const Pose as_told = told(i, now_);
  const auto others = beside(i, as_told);
  if (others.empty()) return settle(as_told, Laid::kAlone);
  const auto word = guesses_.empty() ? best_word(others, i, as_told) : tell_apart(i, others);
  if (word && word->sigmas <= config_.sigmas) return settle(told(i, now_), Laid::kLaid);
  const auto found = word ? std::optional<Pose>(word->T) : search(i, others, as_told);
  if (!found) return settle(as_told, Laid::kNot);
  note(i, as_told, *found);
  settle(*found, Laid::kLaid);
}

void StopFollower::settle(const Pose& T, Laid laid) {
  out_.T_model_cam.push_back(T);
  out_.offsets.push_back(now_);
  out_.laid.push_back(laid);
}

/// From afar; two stops have to tell the same where there are two.
std::optional<Pose> StopFollower::search(std::size_t i, const std::vector<std::size_t>& others, const Pose& T) const {
  const Vec3d centre = T * stops_[i].centre;
  const AxisMotions motions = axis_motions(mount_, stops_[i].angles, now_, centre, with_.icp.rho_mm);
  const auto starts = starts_about(T, centre, motions, with_.icp.rho_mm, config_);
  for (const std::size_t j : others) {
    const auto found = lay_from_afar(stops_[i], stops_[j], out_.T_model_cam[j], starts, with_, config_);
    if (!found) continue;
    const auto agrees = [&](std::size_t k) {
      const auto word = word_of(k, i, *found);
      return word && word->shift_mm < config_.agree_mm;
    };
    const bool is_alone = others.size() == 1;
    if (is_alone || std::ranges::any_of(others, [&](std::size_t k) { return k != j && agrees(k); })) return found;
  }
  return std::nullopt;
}

/// By rounds: of a step of some degrees, arc and chord differ by more than what no angle explains may be.
StopDeviation StopFollower::turns_to(std::size_t i, const Pose& found) const {
  constexpr int kTurnRounds = 4;
  AxesOffset by = now_;
  StopDeviation out;
  for (int round = 0; round < kTurnRounds; ++round) {
    const Pose at = told(i, by);
    const Vec3d centre = at * stops_[i].centre;
    const AxisMotions motions = axis_motions(mount_, stops_[i].angles, by, centre, with_.icp.rho_mm);
    const StopDeviation more = take_apart(motion_between(at, found, centre, with_.icp.rho_mm), motions);
    by.rotation_rad += more.rotation_rad;
    by.swing_rad += more.swing_rad;
    out = {by.rotation_rad - now_.rotation_rad, by.swing_rad - now_.swing_rad, more.rest_mm};
  }
  return out;
}

/// What may be behind a slip is told apart by the stops that follow; until then by what it looks like.
void StopFollower::note(std::size_t i, const Pose& as_told, const Pose& found) {
  const StopDeviation off = turns_to(i, found);
  Slip slip{i, Slip::Kind::kModel, off.rotation_rad * calib::kDegreesPerRad, off.swing_rad * calib::kDegreesPerRad,
            off.rest_mm};
  guesses_.clear();
  if (off.rest_mm < config_.agree_mm) {
    const bool by_rotation = std::abs(off.rotation_rad) >= std::abs(off.swing_rad);
    slip.kind = by_rotation ? Slip::Kind::kRotation : Slip::Kind::kSwing;
    AxesOffset turned_on = now_;
    turned_on.rotation_rad += off.rotation_rad;
    turned_on.swing_rad += off.swing_rad;
    guesses_.push_back({turned_on, slip.kind});
  }
  AxesOffset slid = now_, bumped = now_;
  slid.on_table = found * as_told.inverse() * now_.on_table;
  bumped.before_camera = now_.before_camera * as_told.inverse() * found;
  guesses_.push_back({slid, Slip::Kind::kModel});
  guesses_.push_back({bumped, Slip::Kind::kTable});
  guesses_.push_back({now_, Slip::Kind::kOnce});
  out_.slips.push_back(slip);
  now_ = guesses_.front().offset;  // until the next stop decides
}

std::string Slip::text() const {
  const auto by = fmt::format("{:+.3f} deg of rotation, {:+.3f} deg of swing, rest {:.0f} um", rotation_deg, swing_deg,
                              1e3 * rest_mm);
  switch (kind) {
    case Kind::kRotation:
      return fmt::format("from stop {} on the rotation is off: a lost step ({})", stop, by);
    case Kind::kSwing:
      return fmt::format("from stop {} on the swing is off: a lost step ({})", stop, by);
    case Kind::kModel:
      return fmt::format("at stop {} the model has slipped on the table ({})", stop, by);
    case Kind::kTable:
      return fmt::format("at stop {} table or head was bumped ({})", stop, by);
    case Kind::kOnce:
      return fmt::format("stop {} alone is off: bumped while it was taken ({})", stop, by);
  }
  return {};
}

}  // namespace enamel::pipeline
