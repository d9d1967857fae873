// Which stops a desktop scan takes, in which order: a plan that stands before the first one, or the planner, which
// chooses each by what the model still lacks. Degrees, rotations unwrapped. One thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/desktop/desktop_model.hpp"
#include "host/motion/axes.hpp"
#include "pipeline/register/stops/next_stop.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

using StopPlan = std::vector<motion::AxesAngles>;

/// Names of named_plan(), comma-separated, for messages and help.
inline constexpr std::string_view kPlanNames = "full, quick, arch";

/// The table turns one way, swing after swing is taken up and down by turns. Error: kStopPlan with the names there are.
[[nodiscard]] Result<StopPlan> named_plan(std::string_view name);

/// A table `rot_deg,swing_deg`, in the order of its rows; one that a spreadsheet saved will do
/// (protocol/base/plain_text.hpp). Errors with file, line and what is wrong: kStopPlan for another header, another
/// number of fields, no number, no stop; kAxesRange for a stop outside `limits`.
[[nodiscard]] Result<StopPlan> parse_plan(std::string_view text, const std::string& path,
                                          const motion::AxesLimits& limits);
/// The file's; kFileNotFound, kFileRead besides.
[[nodiscard]] Result<StopPlan> read_plan(const std::string& path, const motion::AxesLimits& limits);

/// kStopPlan for an empty plan, kAxesRange that names the first stop outside.
[[nodiscard]] Result<void> check_plan(const StopPlan& plan, const motion::AxesLimits& limits);

/// What the planner may use of `limits`: its own limits where they are narrower.
[[nodiscard]] pipeline::PlannerConfig within(pipeline::PlannerConfig config, const motion::AxesLimits& limits);

/// Why there were no more stops, for the report.
struct PlanOutcome {
  bool is_automatic = false;
  std::string ended = "stopped";                    ///< by who scans; else planned, complete, max_stops, nothing_seen
  bool is_complete = false;                         ///< every stop of the plan, or all that any stop would show
  std::optional<double> share_seen = std::nullopt;  ///< the planner's belief
};

class StopChooser {
 public:
  StopChooser() = default;
  StopChooser(const StopChooser&) = delete;
  StopChooser& operator=(const StopChooser&) = delete;
  virtual ~StopChooser() = default;

  /// nullopt: no more. `so_far` holds every stop that was asked for and taken, in order.
  [[nodiscard]] virtual std::optional<motion::AxesAngles> next(const DesktopModel& so_far) = 0;
  [[nodiscard]] virtual std::size_t planned() const = 0;  ///< 0: not known before
  [[nodiscard]] virtual PlanOutcome outcome() const = 0;
};

class FixedPlan final : public StopChooser {
 public:
  explicit FixedPlan(StopPlan plan) : plan_(std::move(plan)) {}
  [[nodiscard]] std::optional<motion::AxesAngles> next(const DesktopModel& so_far) override;
  [[nodiscard]] std::size_t planned() const override { return plan_.size(); }
  [[nodiscard]] PlanOutcome outcome() const override;

 private:
  StopPlan plan_;
  std::size_t given_ = 0;
  bool has_ended_ = false;
};

class PlannedStops final : public StopChooser {
 public:
  explicit PlannedStops(const pipeline::StopPlanner& planner) : planner_(planner) {}
  /// Tells the planner of the stops that came since, then asks it. A stop that could not be taken must be added to the
  /// model without bursts, or it is asked for again.
  [[nodiscard]] std::optional<motion::AxesAngles> next(const DesktopModel& so_far) override;
  [[nodiscard]] std::size_t planned() const override { return 0; }
  [[nodiscard]] PlanOutcome outcome() const override;

 private:
  pipeline::StopPlanner planner_;
  std::size_t told_ = 0;
};

}  // namespace enamel::host
