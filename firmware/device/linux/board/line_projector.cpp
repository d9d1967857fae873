#include "firmware/device/linux/board/line_projector.hpp"

#include "protocol/base/log.hpp"

namespace enamel::fw {

Result<void> LineProjector::restart() {
  edges_.close_gate();
  const std::lock_guard lock(mutex_);
  ENAMEL_TRY(controller_->stop());
  return controller_->start();
}

void LineProjector::blank() noexcept {
  const std::lock_guard lock(mutex_);
  controller_->blank();
}

ProjectorStatus LineProjector::status() const {
  const std::lock_guard lock(mutex_);
  const auto now = controller_->status();
  const auto patterns = controller_->pattern_status();
  if (!now || !patterns) {
    log::warn("projector", "{}", (now ? patterns.error() : now.error()).message());
    return {.ready = false, .sequence_abort = false, .watchdog = false};
  }
  const bool sound = now->initialised && !now->system_error && !now->sequence_error && now->led_errors == 0;
  return {.ready = patterns->ready && sound, .sequence_abort = now->sequence_abort, .watchdog = now->watchdog};
}

}  // namespace enamel::fw
