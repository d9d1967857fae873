// Host side of DFU 1.1 with our vendor requests, one open probe.
#pragma once

#include <atomic>
#include <functional>

#include "host/update/probe_link.hpp"
#include "host/update/update_error.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/image/dfu.hpp"
#include "protocol/image/status_block.hpp"

namespace enamel::update {

struct DfuAnswer {
  image::DfuStatus status = image::DfuStatus::kOk;
  image::DfuState state = image::DfuState::kIdle;
  std::chrono::milliseconds poll{0};
};

/// Why a request failed, and of a download where it broke off; a retry is worth it unless the probe refused.
struct Broken {
  LinkFault fault = LinkFault::kOther;
  std::uint32_t refusal = 0;
  std::uint32_t block = 0;  ///< of the download, from 0
};

class DfuClient {
 public:
  /// Both must outlive it.
  DfuClient(ProbeLink& link, Clock& clock) : link_(&link), clock_(&clock) {}

  [[nodiscard]] Linked<DfuAnswer> get_status();
  /// Out of any state into dfuIDLE: CLRSTATUS or ABORT as the state asks.
  [[nodiscard]] Linked<void> settle();
  [[nodiscard]] Linked<image::StatusBlock> read_status_block();
  [[nodiscard]] Linked<void> vendor(image::VendorRequest request, std::uint16_t value = 0,
                                    std::span<const std::byte> data = {});
  /// vendor(), and the probe's word that it did it: what carries data is acknowledged before it is judged.
  [[nodiscard]] tl::expected<void, Broken> ask(image::VendorRequest request, std::uint16_t value = 0,
                                               std::span<const std::byte> data = {});

  /// A copy of the probe's calibration (rig.json), at most 64 KiB; kOther when it is longer.
  [[nodiscard]] tl::expected<std::vector<std::byte>, Broken> read_calibration();

  /// Would the probe take a download now (it is not scanning, its power suffices)? Asked with a block that is too short
  /// to be looked into and taken back at once: nothing on the probe changes.
  [[nodiscard]] tl::expected<void, Broken> may_begin(std::span<const std::byte> image);
  /// Sends an image (without suffix) from block 0. `sent` is told the bytes sent so far. Stops with ABORT when `stop`
  /// becomes true, then gives false.
  [[nodiscard]] tl::expected<bool, Broken> download(std::span<const std::byte> image,
                                                    const std::function<void(std::size_t)>& sent,
                                                    const std::atomic<bool>& stop);
  /// Says that the image is complete and waits until the probe has verified it, at most a minute (kBusy).
  [[nodiscard]] tl::expected<void, Broken> manifest();

 private:
  /// One block of a download and its answer, when the probe has taken it. kBusy: it did not within 10 s.
  [[nodiscard]] Linked<DfuAnswer> send_block(std::uint16_t block, std::span<const std::byte> data);
  [[nodiscard]] Broken broken(LinkFault fault);

  ProbeLink* link_;
  Clock* clock_;
};

}  // namespace enamel::update
