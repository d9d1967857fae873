// Where every burst went: begun = emitted + dropped by reason + under way, for one session, at every instant.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>

#include "protocol/base/ids.hpp"
#include "protocol/types/device.hpp"

namespace enamel::fw {

/// Which scan a burst belongs to. Two hosts may choose the same session number: the epoch tells them apart.
struct ScanTag {
  SessionId id{};
  std::uint32_t epoch = 0;  ///< counts sessions since the probe started
  friend bool operator==(const ScanTag&, const ScanTag&) = default;
};

struct BurstCounts {
  ScanTag session;
  std::uint64_t begun = 0;
  std::uint64_t emitted = 0;
  std::array<std::uint64_t, proto::kDropReasons> dropped{};

  [[nodiscard]] std::uint64_t dropped_total() const noexcept {
    std::uint64_t n = 0;
    for (const std::uint64_t d : dropped) n += d;
    return n;
  }
  [[nodiscard]] std::uint64_t under_way() const noexcept { return begun - emitted - dropped_total(); }
};

/// Thread-safe. What belongs to an earlier session is no longer counted once a new one has begun.
class BurstLedger {
 public:
  /// A new session starts at zero; the same session goes on.
  void open(ScanTag session) {
    const std::lock_guard lock(mutex_);
    if (counts_.session == session) return;
    counts_ = BurstCounts{};
    counts_.session = session;
  }
  void begin(ScanTag session, std::uint64_t n) {
    const std::lock_guard lock(mutex_);
    if (counts_.session == session) counts_.begun += n;
  }
  void emit(ScanTag session) {
    const std::lock_guard lock(mutex_);
    if (counts_.session == session) ++counts_.emitted;
  }
  void drop(ScanTag session, proto::DropReason reason) {
    const std::lock_guard lock(mutex_);
    if (counts_.session == session) ++counts_.dropped[static_cast<std::size_t>(reason)];
  }
  [[nodiscard]] BurstCounts counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  mutable std::mutex mutex_;
  BurstCounts counts_;
};

}  // namespace enamel::fw
