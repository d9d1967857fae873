// A table that is not where it says: found stop by stop while a scan is laid, named, and allowed for in the stops that
// follow, so that one lost step does not cost the scan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/register/stops/slip_search.hpp"
#include "pipeline/register/stops/stop.hpp"

namespace enamel::pipeline {

/// What a stop's patch was found to be off from where the axes put it.
struct Slip {
  enum class Kind : std::uint8_t {
    kRotation,  ///< the turning axis stands further than it says, from here on: a lost step
    kSwing,     ///< the same of the swinging axis
    kModel,     ///< the model moved on the table
    kTable,     ///< table or head moved: bumped
    kOnce,      ///< this stop alone is off
  };
  std::size_t stop = 0;  ///< the first that shows it
  Kind kind = Kind::kModel;
  double rotation_deg = 0, swing_deg = 0;  ///< by which the axes would have to be off
  double rest_mm = 0;                      ///< what no angle explains
  [[nodiscard]] std::string text() const;  ///< one line for people, stops counted from 0
};

enum class Laid : std::uint8_t {
  kLaid,   ///< on one of those before it
  kAlone,  ///< overlaps none of those before it: nothing tells whether it slipped
  kNot,    ///< overlaps others by its angles, and fits none of them anywhere
};

struct FollowedStops {
  std::vector<Pose> T_model_cam;  ///< where each stop begins: by the axes, slips allowed for
  std::vector<AxesOffset> offsets;
  std::vector<Laid> laid;
  std::vector<Slip> slips;
};

/// Lays every stop on those before it as it comes: what a table, or a model on it, did by itself is known at once.
/// Deterministic; one thread. Refers to `rules` and what they refer to.
class StopFollower {
 public:
  StopFollower(const calib::Mount& mount, const LayingRules& rules, const SlipConfig& config)
      : mount_(mount), with_(rules), config_(config) {}

  /// In the order in which they were taken. Returns where it lies.
  const Pose& follow(Stop stop);

  [[nodiscard]] const std::vector<Stop>& stops() const noexcept { return stops_; }
  [[nodiscard]] const FollowedStops& followed() const noexcept { return out_; }

 private:
  /// What a stop says of another: where that lies, and by how much and how many sigmas that is off.
  struct Word {
    Pose T = Pose::Identity();
    double sigmas = 0, shift_mm = 0;
  };
  /// An offset that may explain a slip, and what it would be called.
  struct Guess {
    AxesOffset offset;
    Slip::Kind kind = Slip::Kind::kModel;
  };
  [[nodiscard]] Pose told(std::size_t i, const AxesOffset& by) const;
  [[nodiscard]] std::vector<std::size_t> beside(std::size_t i, const Pose& T) const;
  [[nodiscard]] Matrix6 covariance_of(std::size_t k, const Vec3d& centre) const;
  [[nodiscard]] std::optional<Word> word_of(std::size_t j, std::size_t i, const Pose& T) const;
  [[nodiscard]] std::optional<Word> best_word(const std::vector<std::size_t>& others, std::size_t i,
                                              const Pose& T) const;
  [[nodiscard]] std::optional<Pose> search(std::size_t i, const std::vector<std::size_t>& others, const Pose& T) const;
  [[nodiscard]] StopDeviation turns_to(std::size_t i, const Pose& found) const;
  [[nodiscard]] std::optional<Word> tell_apart(std::size_t i, const std::vector<std::size_t>& others);
  void lay(std::size_t i);
  void settle(const Pose& T, Laid laid);
  void note(std::size_t i, const Pose& as_told, const Pose& found);

  calib::Mount mount_;
  LayingRules with_;
  SlipConfig config_;
  std::vector<Stop> stops_;
  AxesOffset now_;
  std::vector<Guess> guesses_;  ///< of the last slip, until stops have told them apart
  FollowedStops out_;
};

}  // namespace enamel::pipeline
