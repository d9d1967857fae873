// The pattern projector together with the gate that lets camera strobes trigger it. Free of any controller's words.
#pragma once

#include "protocol/base/result.hpp"

namespace enamel::fw {

struct ProjectorStatus {
  bool ready = false;           ///< accepts a trigger
  bool sequence_abort = false;  ///< stopped inside a pattern set
  bool watchdog = false;        ///< its controller restarted by itself
};

/// arm(), disarm() and restart() from the acquisition thread, status() from any.
class Projector {
 public:
  virtual ~Projector() = default;
  /// Opens the gate for one burst of four frames at the next opportunity; the edge stream tells when (EdgeKind::kGate).
  /// At most one burst is armed at a time. Errors: kProjector; kCancelled when a finite source has no further burst.
  [[nodiscard]] virtual Result<void> arm() = 0;
  /// Takes an armed burst back if its gate has not opened yet.
  virtual void disarm() noexcept = 0;
  /// Closes the gate at once, should it be open, and takes the sequence back to its start: the next burst begins with
  /// pattern 0. Errors: kProjector.
  [[nodiscard]] virtual Result<void> restart() = 0;
  [[nodiscard]] virtual ProjectorStatus status() const = 0;
  /// Index of the pattern set shown, in the rig's list.
  [[nodiscard]] virtual int pattern_set() const = 0;
};

}  // namespace enamel::fw
