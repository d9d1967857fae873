// The update process behind the controller's gate: the lock that both processes know.
#pragma once

#include <memory>
#include <utility>

#include "firmware/control/update_gate.hpp"
#include "firmware/storage/scan_lock.hpp"

namespace enamel::fw {

class LockGate final : public UpdateGate {
 public:
  explicit LockGate(std::unique_ptr<ScanLock> lock) noexcept : lock_(std::move(lock)) {}
  [[nodiscard]] bool begin_scan() noexcept override { return lock_->take(); }
  void end_scan() noexcept override { lock_->release(); }
  [[nodiscard]] bool updating() const noexcept override { return lock_->held_elsewhere(); }

 private:
  std::unique_ptr<ScanLock> lock_;
};

}  // namespace enamel::fw
