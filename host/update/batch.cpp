#include "host/update/batch.hpp"

#include <algorithm>
#include <mutex>
#include <thread>

namespace enamel::update {

std::vector<BatchEntry> flash_all(UsbBus& bus, Clock& clock, const std::vector<PortInfo>& probes,
                                  const FlashRequest& request, std::size_t jobs,
                                  const std::function<void(const PortInfo&, const FlashProgress&)>& progress,
                                  const std::atomic<bool>& stop) {
  std::vector<BatchEntry> entries(probes.size());
  std::atomic<std::size_t> next{0};
  std::mutex telling;
  const auto work = [&] {
    for (std::size_t i = next++; i < probes.size(); i = next++) {
      entries[i].probe = probes[i];
      const auto tell = [&](const FlashProgress& p) {
        const std::lock_guard lock(telling);
        progress(probes[i], p);
      };
      entries[i].result = stop ? tl::unexpected(cancelled()) : flash(bus, clock, probes[i], request, tell, stop);
    }
  };
  std::vector<std::jthread> workers;
  for (std::size_t w = 0; w < std::min(std::max<std::size_t>(jobs, 1), probes.size()); ++w) workers.emplace_back(work);
  workers.clear();
  return entries;
}

}  // namespace enamel::update
