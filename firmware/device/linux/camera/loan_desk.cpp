#include "firmware/device/linux/camera/loan_desk.hpp"

#include <algorithm>

#include "protocol/base/log.hpp"

namespace enamel::fw {

LoanDesk::LoanDesk(std::shared_ptr<RequestSource> source)
    : source_(std::move(source)),
      where_(static_cast<std::size_t>(source_->slots()), Where::kIdle),
      carries_change_(where_.size(), false) {}

Result<void> LoanDesk::open(const CameraControls& controls, CompletionSink& sink) {
  const std::lock_guard lock(mutex_);
  change_.reset();
  hold(false);
  ENAMEL_TRY(source_->start(controls, sink));
  open_ = true;
  for (std::size_t i = 0; i < where_.size(); ++i) {
    carries_change_[i] = false;
    if (where_[i] == Where::kLent) continue;
    ENAMEL_TRY(queue(static_cast<int>(i)));
  }
  return {};
}

void LoanDesk::close() noexcept {
  const std::lock_guard lock(mutex_);
  if (!open_) return;
  open_ = false;
  source_->stop();
  std::replace(where_.begin(), where_.end(), Where::kQueued, Where::kIdle);
}

std::optional<PixelLoan> LoanDesk::lend(int slot) {
  {
    const std::lock_guard lock(mutex_);
    Where& where = where_[static_cast<std::size_t>(slot)];
    if (where != Where::kQueued) return std::nullopt;
    where = Where::kLent;
    if (!held_.load(std::memory_order_acquire)) queue_kept();
  }
  std::shared_ptr<const void> owner(nullptr, [desk = shared_from_this(), slot](const void*) { desk->give_back(slot); });
  return PixelLoan(source_->memory(slot), source_->format().stride, std::move(owner));
}

void LoanDesk::give_back(int slot) noexcept {
  const std::lock_guard lock(mutex_);
  where_[static_cast<std::size_t>(slot)] = Where::kIdle;
  if (!open_ || held_.load(std::memory_order_acquire)) return;
  if (auto queued = queue(slot); !queued) log::warn("camera", "{}", queued.error().message());
}

/// Needs the lock. What is refused is kept for the next time.
void LoanDesk::queue_kept() noexcept {
  if (!open_) return;
  for (std::size_t i = 0; i < where_.size(); ++i) {
    if (where_[i] == Where::kIdle && !queue(static_cast<int>(i))) return;
  }
}

/// Needs the lock.
Result<void> LoanDesk::queue(int slot) {
  const auto i = static_cast<std::size_t>(slot);
  ENAMEL_TRY(source_->queue(slot, change_));
  carries_change_[i] = change_.has_value();
  change_.reset();
  where_[i] = Where::kQueued;
  return {};
}

void LoanDesk::change(const CameraControls& controls) {
  const std::lock_guard lock(mutex_);
  change_ = controls;
}

bool LoanDesk::changed_by(int slot) {
  const std::lock_guard lock(mutex_);
  const bool changed = carries_change_[static_cast<std::size_t>(slot)];
  carries_change_[static_cast<std::size_t>(slot)] = false;
  return changed;
}

int LoanDesk::lent() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(std::count(where_.begin(), where_.end(), Where::kLent));
}

}  // namespace enamel::fw
