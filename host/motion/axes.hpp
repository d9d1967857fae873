// The two axes of the desktop scanner: a table that turns on a cradle that swings. What moves them is behind this.
#pragma once

#include <cstdint>
#include <limits>

#include "protocol/base/result.hpp"
#include "protocol/base/time.hpp"

namespace enamel::motion {

/// Angles of both axes in degrees, counted from the table's zero, not wrapped.
struct AxesAngles {
  double rot_deg = std::numeric_limits<double>::quiet_NaN();
  double swing_deg = std::numeric_limits<double>::quiet_NaN();
};

/// Closed interval of one axis, degrees.
struct AxisLimits {
  double min_deg = 0.0;
  double max_deg = 0.0;
};

struct AxesLimits {
  AxisLimits rot;
  AxisLimits swing;
};

/// Where the table stands. `read` is NaN for an axis whose hardware reports nothing.
struct AxesPosition {
  AxesAngles commanded;
  AxesAngles read;
};

enum class AxesState : std::uint8_t {
  kUnhomed,  ///< position unknown: only home() moves
  kReady,    ///< stands, position known
  kMoving,   ///< within a call
  kLost,     ///< the line to the hardware is gone: open it anew
};

[[nodiscard]] const char* state_name(AxesState state) noexcept;

/// One thread at a time, except request_stop() and state(). No call takes longer than its `within` and kStandTime.
class Axes {
 public:
  /// What is added to a call's time when it failed: to bring the table to a stand.
  static constexpr Nanoseconds kStandTime{5'000'000'000};

  virtual ~Axes() = default;
  /// Targets that move_to takes.
  [[nodiscard]] virtual AxesLimits limits() const = 0;
  [[nodiscard]] virtual AxesState state() const = 0;
  /// Finds the position anew. kAxes, kAxesAlarm; kCancelled. After an error the state is kUnhomed or kLost.
  [[nodiscard]] virtual Result<void> home(Nanoseconds within) = 0;
  /// Returns when both axes stand at `target` and have settled, each having come from below, so that backlash is always
  /// on one side. Nothing is sent for a target that is not finite or outside limits() (kAxesRange), nor in a state
  /// other than kReady (kAxes). After a fault kAxes, kAxesAlarm (alarm, door, restart of the controller) or kAxesStep
  /// (stands elsewhere than told), kCancelled after request_stop(): the table stands then.
  [[nodiscard]] virtual Result<AxesPosition> move_to(const AxesAngles& target, Nanoseconds within) = 0;
  /// kAxes when the position is unknown; the faults of move_to.
  [[nodiscard]] virtual Result<AxesPosition> position() = 0;
  /// Brings the table to a stand, whatever it does, and keeps the position where the hardware does. Idempotent.
  [[nodiscard]] virtual Result<void> stop() = 0;
  /// Makes the home() or move_to() that is running, or the next one, stop the table and return kCancelled. From any
  /// thread or signal handler.
  virtual void request_stop() noexcept = 0;
};

}  // namespace enamel::motion
