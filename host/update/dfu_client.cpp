#include "host/update/dfu_client.hpp"

#include <algorithm>

namespace enamel::update {
namespace {

using image::DfuRequest;
using image::DfuState;
using namespace image::request_type;
using namespace std::chrono_literals;

constexpr auto kTimeout = 5s;
/// 16 MiB read back, hashed and written down: far more than any probe needs.
constexpr int kManifestPolls = 60;

std::uint8_t number(DfuRequest request) { return static_cast<std::uint8_t>(request); }

}  // namespace

Linked<DfuAnswer> DfuClient::get_status() {
  const auto bytes = link_->in(kClassIn, number(DfuRequest::kGetStatus), 0, 6, kTimeout);
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->size() != 6) return tl::unexpected(LinkFault::kOther);
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>((*bytes)[i]); };
  return DfuAnswer{static_cast<image::DfuStatus>(at(0)), static_cast<DfuState>(at(4)),
                   std::chrono::milliseconds(at(1) | at(2) << 8U | at(3) << 16U)};
}

Linked<void> DfuClient::settle() {
  const Linked<DfuAnswer> answer = get_status();
  if (!answer) return tl::unexpected(answer.error());
  if (answer->state == DfuState::kIdle) return {};
  const DfuRequest way = answer->state == DfuState::kError ? DfuRequest::kClearStatus : DfuRequest::kAbort;
  return link_->out(kClassOut, number(way), 0, {}, kTimeout);
}

Linked<image::StatusBlock> DfuClient::read_status_block() {
  const auto bytes =
      link_->in(kVendorIn, static_cast<std::uint8_t>(image::VendorRequest::kStatus), 0, image::kStatusSize, kTimeout);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::optional<image::StatusBlock> status = image::decode_status(*bytes);
  if (!status) return tl::unexpected(LinkFault::kOther);
  return *status;
}

Linked<void> DfuClient::vendor(image::VendorRequest request, std::uint16_t value, std::span<const std::byte> data) {
  return link_->out(kVendorOut, static_cast<std::uint8_t>(request), value, data, kTimeout);
}

Broken DfuClient::broken(LinkFault fault) {
  if (fault == LinkFault::kGone) return {fault, 0};
  // A stall alone says nothing; the status tells whether the probe refused, and why.
  const Linked<DfuAnswer> answer = get_status();
  if (!answer) return {answer.error(), 0};
  if (answer->state != DfuState::kError) return {fault, 0};
  const Linked<image::StatusBlock> status = read_status_block();
  const std::uint32_t why = status ? status->last_error : 0;
  static_cast<void>(settle());
  return {fault, why};
}

tl::expected<bool, Broken> DfuClient::download(std::span<const std::byte> image,
                                               const std::function<void(std::size_t)>& sent,
                                               const std::atomic<bool>& stop) {
  if (const Linked<void> idle = settle(); !idle) return tl::unexpected(broken(idle.error()));
  std::uint16_t block = 0;
  for (std::size_t at = 0; at < image.size();) {
    if (stop) {
      static_cast<void>(settle());
      return false;
    }
    const std::size_t n = std::min<std::size_t>(image::kDfuTransferSize, image.size() - at);
    const Linked<void> taken =
        link_->out(kClassOut, number(DfuRequest::kDownload), block, image.subspan(at, n), kTimeout);
    if (!taken) return tl::unexpected(broken(taken.error()));
    Linked<DfuAnswer> answer = get_status();
    while (answer && answer->state == DfuState::kDownloadBusy) {
      clock_->sleep_for(answer->poll);
      answer = get_status();
    }
    if (!answer) return tl::unexpected(broken(answer.error()));
    if (answer->state != DfuState::kDownloadIdle) return tl::unexpected(broken(LinkFault::kStall));
    ++block;
    at += n;
    sent(at);
  }
  return true;
}

tl::expected<void, Broken> DfuClient::manifest() {
  const Linked<void> said = link_->out(kClassOut, number(DfuRequest::kDownload), 0, {}, kTimeout);
  if (!said) return tl::unexpected(broken(said.error()));
  for (int poll = 0; poll < kManifestPolls; ++poll) {
    const Linked<DfuAnswer> answer = get_status();
    if (!answer) return tl::unexpected(broken(answer.error()));
    if (answer->state == DfuState::kIdle) return {};
    if (answer->state == DfuState::kError) return tl::unexpected(broken(LinkFault::kStall));
    clock_->sleep_for(std::clamp<std::chrono::milliseconds>(answer->poll, 10ms, 2000ms));
  }
  return tl::unexpected(Broken{LinkFault::kTimeout, 0});
}

}  // namespace enamel::update
