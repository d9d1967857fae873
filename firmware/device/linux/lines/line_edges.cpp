#include "firmware/device/linux/lines/line_edges.hpp"

#include <linux/gpio.h>
#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "firmware/hal/hardware.hpp"
#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

constexpr std::size_t kAtOnce = 64, kUnread = 4096;
constexpr int kPollMs = 20, kBurst = 4;
// An edge is stamped and queued in one interrupt: what happened this long ago has been queued.
constexpr Nanoseconds kInterrupt{200'000};

}  // namespace

LineEdges::LineEdges(LineHandle events, const EdgeLines& lines, GateDriver gate, Clock& clock)
    : events_(std::move(events)), lines_(lines), gate_(std::move(gate)), clock_(clock) {}

LineEdges::~LineEdges() {
  thread_ = {};
  close_gate();
}

void LineEdges::follow() {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd wait{events_.fd(), POLLIN, 0};
      if (::poll(&wait, 1, kPollMs) > 0) take_events();
    }
  });
  (void)pthread_setname_np(thread_.native_handle(), "fw-edges");
}

DeviceTime LineEdges::read(std::vector<Edge>& edges) {
  take_events();
  const std::lock_guard lock(mutex_);
  edges.insert(edges.end(), edges_.begin(), edges_.end());
  edges_.clear();
  return known_until_;
}

void LineEdges::take_events() {
  const std::lock_guard lock(mutex_);
  known_until_ = device_now(clock_) - kInterrupt;
  std::array<gpio_v2_line_event, kAtOnce> events{};
  for (;;) {
    const ssize_t got = ::read(events_.fd(), events.data(), sizeof events);
    if (got < static_cast<ssize_t>(sizeof(gpio_v2_line_event))) return;
    for (const auto& e : std::span(events).first(static_cast<std::size_t>(got) / sizeof(gpio_v2_line_event))) {
      if (last_seqno_) lost_ += std::uint32_t{e.seqno - *last_seqno_ - 1};
      last_seqno_ = e.seqno;
      take(static_cast<std::int64_t>(e.timestamp_ns), e.offset, e.id == GPIO_V2_LINE_EVENT_RISING_EDGE);
    }
  }
}

/// Needs the lock, as what follows.
void LineEdges::take(std::int64_t t_ns, std::uint32_t line, bool rising) {
  const DeviceTime t = device_time(t_ns);
  // Nobody scans, yet a line is never quiet: what is old is of no use to the next scan.
  if (edges_.size() >= kUnread) edges_.erase(edges_.begin(), edges_.begin() + kUnread / 2);
  if (line == lines_.strobe && rising) {
    edges_.push_back({EdgeKind::kStrobe, t, strobes_++});
    on_strobe();
  } else if (line == lines_.t1 && rising) {
    edges_.push_back({EdgeKind::kT1, t, 0});
  } else if (line == lines_.t2) {
    edges_.push_back({rising ? EdgeKind::kT2Rise : EdgeKind::kT2Fall, t, 0});
  }
}

void LineEdges::on_strobe() {
  if (to_go_ > 0) {
    if (--to_go_ == 0) drive(false);
    return;
  }
  ++dark_;
  if (!armed_ || dark_ < std::max(1, lines_.dark_frames)) return;
  armed_ = false;
  drive(true);
  to_go_ = kBurst;
  edges_.push_back({EdgeKind::kGate, device_now(clock_), bursts_++});
}

void LineEdges::drive(bool open) noexcept {
  dark_ = 0;
  if (!gate_(open)) log::error("lines", "the burst gate cannot be {}", open ? "opened" : "closed");
}

void LineEdges::arm() {
  const std::lock_guard lock(mutex_);
  armed_ = true;
}

void LineEdges::disarm() noexcept {
  const std::lock_guard lock(mutex_);
  armed_ = false;
}

void LineEdges::close_gate() noexcept {
  const std::lock_guard lock(mutex_);
  to_go_ = 0;
  drive(false);
}

std::uint64_t LineEdges::lost() const {
  const std::lock_guard lock(mutex_);
  return lost_;
}

}  // namespace enamel::fw
