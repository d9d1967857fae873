// Several probes at once: one worker a probe, one bus.
#pragma once

#include <functional>
#include <vector>

#include "host/update/flash_flow.hpp"

namespace enamel::update {

struct BatchEntry {
  PortInfo probe;
  Updated<FlashResult> result = tl::unexpected(UpdateError{});
};

/// Called from the workers, one call at a time.
struct BatchObserver {
  std::function<void(const PortInfo&, const FlashProgress&)> progress;
  std::function<void(const PortInfo&, const FlashEvent&)> event;
};

struct BatchRequest {
  FlashRequest each;     ///< of every probe
  std::size_t jobs = 1;  ///< probes at a time, at most
};

/// Flashes every probe. Results in the order of `probes`; one probe's failure is no other's.
[[nodiscard]] std::vector<BatchEntry> flash_all(UsbBus& bus, Clock& clock, const std::vector<PortInfo>& probes,
                                                const BatchRequest& request, const BatchObserver& observer,
                                                const std::atomic<bool>& stop);

}  // namespace enamel::update
