// Four lit frames become a burst: by exposure window, never by order of arrival. Pure: no clock, no threads, no
// waiting.
//
// Every frame is tied to the camera strobe that began its exposure, every pattern to the projector edges inside that
// exposure. A burst starts after a dark sentinel frame and must show patterns 0, 1, 2, 3 in four consecutive frames;
// whatever does not fit gives the burst up with one reason. Each opened gate ends in exactly one outcome.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "firmware/acquire/edge_log.hpp"
#include "firmware/hal/camera.hpp"
#include "firmware/hal/edges.hpp"
#include "protocol/types/device.hpp"

namespace enamel::fw {

struct AssemblerConfig {
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  Nanoseconds frame_period{4'004'000};
  Nanoseconds tol_period{100'000};       ///< of the distance of two frames from the period
  Nanoseconds tol_association{800'000};  ///< of a frame's expected strobe from a real one
  Nanoseconds burst_timeout{24'024'000};
  Nanoseconds margin{25'000};       ///< the pattern is lit this much inside the exposure, at both ends
  Nanoseconds stamp_delay{20'000};  ///< sensor stamp minus end of exposure, as calibrated
  double dark_max_dn = 12.0;        ///< mean of a dark frame stays below

  /// Tolerances in the proportions that hold at 249.8 Hz. A device whose stamps may scatter more than kUsualStampSpread
  /// gets a wider tol_period, as far as frames stay apart.
  [[nodiscard]] static AssemblerConfig for_mode(const CameraMode& mode, Nanoseconds stamp_delay,
                                                Nanoseconds max_spread = kUsualStampSpread);
};

struct LitFrame {
  CameraFrame frame;
  DeviceTime t_strobe{};
  DeviceTime t_rise{};
  DeviceTime t_fall{};
};

struct AssembledBurst {
  std::uint64_t burst_index = 0;
  std::array<LitFrame, 4> frames;  ///< in pattern order
  double ambient_dn = 0;           ///< mean of the sentinel
};

struct GivenUpBurst {
  std::uint64_t burst_index = 0;
  proto::DropReason reason = proto::DropReason::kOther;
};

struct BurstInProgress {
  std::uint64_t index = 0;
  DeviceTime t_gate{};
  int next = 0;  ///< pattern expected
  AssembledBurst burst;
};

struct FrameSeen {
  std::uint32_t seq = 0;
  DeviceTime begin{};  ///< of its exposure
};

using BurstOutcome = std::variant<AssembledBurst, GivenUpBurst>;

/// One thread. Gates, edges and frames may be pushed in any order between each other; frames in order of completion.
class BurstAssembler {
 public:
  explicit BurstAssembler(const AssemblerConfig& config);

  void push_edge(const Edge& edge);
  void push_frame(CameraFrame frame) { waiting_.push_back(std::move(frame)); }
  /// All edges up to `t` have been pushed: judges the frames that end before it. At most three frames wait for edges; a
  /// fourth forces the oldest, which then lacks its strobe.
  void edges_known_until(DeviceTime t);
  /// Gives up every burst under way (light switched off by an interlock, camera restarted …).
  void abort(proto::DropReason reason);
  /// The camera was started anew, and its stamps measured: nothing that was seen before is compared with what comes.
  void camera_restarted(Nanoseconds stamp_delay);

  [[nodiscard]] std::vector<BurstOutcome> take_outcomes();
  /// Gates pushed so far.
  [[nodiscard]] std::uint64_t begun() const noexcept { return begun_; }
  /// Of these, those without an outcome yet.
  [[nodiscard]] std::uint64_t under_way() const noexcept { return begun_ - ended_; }
  /// Dark frames in a row, up to now, that were not dark.
  [[nodiscard]] int dark_leaks() const noexcept { return dark_leaks_; }

 private:
  struct Window {
    DeviceTime begin{}, end{};
  };

  void judge(CameraFrame frame);
  void open_gates(DeviceTime until);
  void finish(BurstOutcome outcome);
  void give_up(proto::DropReason reason);
  void fault(proto::DropReason reason);
  void check_sequence(const CameraFrame& frame);
  [[nodiscard]] tl::expected<Window, proto::DropReason> window_of(const CameraFrame& frame);
  void judge_dark(double mean_dn);
  void judge_lit(CameraFrame frame, const Pattern& pattern, const Window& window);

  AssemblerConfig config_;
  EdgeLog log_;
  std::deque<CameraFrame> waiting_;
  std::vector<BurstOutcome> outcomes_;
  std::optional<BurstInProgress> current_;
  bool armed_ = false;  ///< the previous frame was a good dark sentinel
  double ambient_dn_ = 0;
  proto::DropReason not_armed_because_ = proto::DropReason::kOrder;
  std::optional<FrameSeen> previous_;
  std::optional<std::uint64_t> previous_hash_;
  int dark_leaks_ = 0;
  std::uint64_t begun_ = 0;
  std::uint64_t ended_ = 0;
};

}  // namespace enamel::fw
