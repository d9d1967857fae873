#include "firmware/device/linux/board/line_projector.hpp"

#include "protocol/base/log.hpp"

namespace enamel::fw {

Result<void> LineProjector::set_up() {
  const std::lock_guard lock(mutex_);
  return show();
}

Result<void> LineProjector::show() {
  ENAMEL_TRY(controller_->arm(timing_));
  ENAMEL_TRY(controller_->set_led(led_code_));
  return controller_->start();
}

Result<void> LineProjector::restart() {
  edges_.close_gate();
  const std::lock_guard lock(mutex_);
  const auto again = run_again();
  if (again) return {};
  log::warn("projector", "set up anew: {}", again.error().detail);
  ENAMEL_TRY(controller_->prepare());
  return show();
}

Result<void> LineProjector::run_again() {
  ENAMEL_TRY(controller_->stop());
  ENAMEL_TRY(controller_->start());
  ENAMEL_TRY_ASSIGN(const PatternStatus now, controller_->pattern_status());
  if (now.ready) return {};
  return fail(ErrorCode::kProjector, "not ready for a trigger, as after a restart of its own");
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
