// What keeps scans and updates apart, as the probe's control sees it.
#pragma once

namespace enamel::fw {

/// The update process stands behind it. One thread.
class UpdateGate {
 public:
  virtual ~UpdateGate() = default;
  /// Keeps updates from beginning until end_scan(); true also while it does so already. False: one is under way.
  [[nodiscard]] virtual bool begin_scan() noexcept = 0;
  virtual void end_scan() noexcept = 0;
  [[nodiscard]] virtual bool updating() const noexcept = 0;
};

}  // namespace enamel::fw
