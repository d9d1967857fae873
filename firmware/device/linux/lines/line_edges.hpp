// Trigger edges from a GPIO chip's queue of events, and the burst gate, which follows them.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "firmware/device/linux/lines/gpio_chip.hpp"
#include "firmware/hal/edges.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::fw {

struct EdgeLines {
  std::uint32_t strobe = 0;  ///< camera: high while it exposes
  std::uint32_t t1 = 0;      ///< projector: a pattern set begins
  std::uint32_t t2 = 0;      ///< projector: high while a pattern is lit
  int dark_frames = 4;       ///< between two bursts at least: sentinel, and rest for the LED
};

/// Drives the line that lets strobes through to the projector. False: it could not be driven.
using GateDriver = std::function<bool(bool open)>;

/// The gate opens behind a strobe and closes behind the fourth from then: a frame time is left for either. Thread-safe.
class LineEdges final : public EdgeStream {
 public:
  /// `events`: of the three lines; anything that delivers gpio_v2_line_event.
  LineEdges(LineHandle events, const EdgeLines& lines, GateDriver gate, Clock& clock);
  ~LineEdges() override;
  LineEdges(const LineEdges&) = delete;
  LineEdges& operator=(const LineEdges&) = delete;

  /// A thread of its own takes events as they come; without it, read() does.
  void follow();
  [[nodiscard]] DeviceTime read(std::vector<Edge>& edges) override;

  /// One burst at the next opportunity.
  void arm();
  /// Unless its gate has opened.
  void disarm() noexcept;
  /// At once; what is armed stays so.
  void close_gate() noexcept;

  /// Events that the kernel had no room for: a burst that misses an edge is given up by the assembler.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  void take_events();
  void take(std::int64_t t_ns, std::uint32_t line, bool rising);
  void on_strobe();
  void drive(bool open) noexcept;

  LineHandle events_;
  const EdgeLines lines_;
  GateDriver gate_;
  Clock& clock_;

  mutable std::mutex mutex_;  ///< below
  DeviceTime known_until_{};
  std::vector<Edge> edges_;
  std::optional<std::uint32_t> last_seqno_;
  std::uint64_t lost_ = 0, strobes_ = 0, bursts_ = 0;
  bool armed_ = false;
  int to_go_ = 0;  ///< strobes until the gate closes; 0: it is closed
  int dark_ = 0;   ///< strobes since
  std::jthread thread_;
};

}  // namespace enamel::fw
