#include "host/update/batch.hpp"

#include <algorithm>
#include <mutex>
#include <thread>

namespace enamel::update {

std::vector<BatchEntry> flash_all(UsbBus& bus, Clock& clock, const std::vector<PortInfo>& probes,
                                  const BatchRequest& request, const BatchObserver& observer,
                                  const std::atomic<bool>& stop) {
  std::vector<BatchEntry> entries(probes.size());
  std::atomic<std::size_t> next{0};
  std::mutex telling;
  const auto work = [&] {
    for (std::size_t i = next++; i < probes.size(); i = next++) {
      entries[i].probe = probes[i];
      const FlashObserver one{.progress =
                                  [&, i](const FlashProgress& p) {
                                    const std::lock_guard lock(telling);
                                    observer.progress(probes[i], p);
                                  },
                              .event =
                                  [&, i](const FlashEvent& e) {
                                    const std::lock_guard lock(telling);
                                    observer.event(probes[i], e);
                                  }};
      entries[i].result = stop ? fail(HostError::kCancelled) : flash(bus, clock, probes[i], request.each, one, stop);
    }
  };
  std::vector<std::jthread> workers;
  for (std::size_t w = 0; w < std::min(std::max<std::size_t>(request.jobs, 1), probes.size()); ++w)
    workers.emplace_back(work);
  workers.clear();
  return entries;
}

}  // namespace enamel::update
