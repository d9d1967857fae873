#include "host/session/disk_guard.hpp"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <limits>
#include <mutex>
#include <utility>

#include "protocol/base/log.hpp"

namespace enamel::host {
namespace {

std::uint64_t free_bytes_at(const std::string& path) {
  struct statvfs info {};
  if (::statvfs(path.c_str(), &info) != 0) return std::numeric_limits<std::uint64_t>::max();  // not known: not judged
  return std::uint64_t{info.f_bavail} * info.f_frsize;
}

/// Never more than a quarter of what is there: a small disk is for the recording.
std::uint64_t reserve_size(std::uint64_t wanted, std::uint64_t free) { return std::min(wanted, free / 4); }

}  // namespace

DiskGuard::DiskGuard(const std::string& path, const DiskLimits& limits, std::function<void()> on_full,
                     FreeBytes free_bytes)
    : limits_(limits), on_full_(std::move(on_full)), free_bytes_(std::move(free_bytes)) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  if (!free_bytes_) free_bytes_ = [where = folder.string()] { return free_bytes_at(where); };
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  reserve_path_ = (folder / ".reserve").string();
  const int reserve = ::open(reserve_path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (reserve >= 0) {
    // A file system that cannot hold space back has none held back; the limits still hold.
    const auto size = static_cast<off_t>(reserve_size(limits_.reserve_bytes, free_bytes_()));
    if (::fallocate(reserve, 0, 0, size) != 0) log::debug("disk", "no space can be held back at {}", reserve_path_);
    ::close(reserve);
  }
  look();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

DiskGuard::~DiskGuard() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  release_reserve();
  if (fd_ >= 0) ::close(fd_);
}

void DiskGuard::release_reserve() { ::unlink(reserve_path_.c_str()); }

std::string DiskGuard::warning() const {
  if (state() == DiskState::kAmple) return {};
  return "DISK NEARLY FULL: " + std::to_string(free_bytes() >> 20U) + " MB left";
}

std::optional<Error> DiskGuard::full(const std::string& path) const {
  if (state() != DiskState::kFull) return std::nullopt;
  return Error{ErrorCode::kFileWrite, path + ": the disk is nearly full: the scan was ended with what there is"};
}

void DiskGuard::run(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any tick;
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    tick.wait_for(lock, stop, limits_.period, [] { return false; });
    // What another descriptor wrote is the file's all the same.
    if (fd_ >= 0) ::fdatasync(fd_);
    look();
  }
}

void DiskGuard::look() {
  const std::uint64_t free = free_bytes_();
  free_.store(free, std::memory_order_release);
  const DiskState now = free < limits_.stop_bytes   ? DiskState::kFull
                        : free < limits_.warn_bytes ? DiskState::kLow
                                                    : DiskState::kAmple;
  const DiskState before = state_.load(std::memory_order_acquire);
  if (before == DiskState::kFull) return;  // the scan is over
  state_.store(now, std::memory_order_release);
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20U;
  if (now == DiskState::kLow && before == DiskState::kAmple)
    log::warn("disk", "{} MB left for the recording", free / kMiB);
  if (now != DiskState::kFull) return;
  log::error("disk", "{} MB left: the scan ends with what there is", free / kMiB);
  on_full_();
}

}  // namespace enamel::host
