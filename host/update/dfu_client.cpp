#include "host/update/dfu_client.hpp"

#include <algorithm>

namespace enamel::update {
namespace {

using image::DfuRequest;
using image::DfuState;
using namespace image::request_type;
using namespace std::chrono_literals;

constexpr auto kTimeout = 5s;
/// Far more than any flash needs to erase and write 64 KiB, and to read back, hash and write down 16 MiB.
constexpr auto kBlockDeadline = 10s;
constexpr auto kManifestDeadline = 60s;
/// Whatever the probe asks for between two looks.
constexpr std::chrono::milliseconds kShortestPoll = 1ms, kLongestPoll = 2s;

/// Shorter than an image's header, so that the probe cannot judge it yet.
constexpr std::size_t kKnock = 64;
constexpr std::uint16_t kAnswerSize = 6;
constexpr std::size_t kLongestCalibration = 65536;

ControlRequest dfu(std::uint8_t type, DfuRequest request, std::uint16_t value = 0) {
  return {type, static_cast<std::uint8_t>(request), value};
}

Linked<DfuAnswer> parse(const Linked<std::vector<std::byte>>& bytes) {
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->size() != kAnswerSize) return tl::unexpected(LinkFault::kOther);
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>((*bytes)[i]); };
  return DfuAnswer{static_cast<image::DfuStatus>(at(0)), static_cast<DfuState>(at(4)),
                   std::chrono::milliseconds(at(1) | at(2) << 8U | at(3) << 16U)};
}

}  // namespace

Linked<DfuAnswer> DfuClient::get_status() {
  return parse(link_->in(dfu(kClassIn, DfuRequest::kGetStatus), kAnswerSize, kTimeout));
}

Linked<void> DfuClient::settle() {
  Linked<void> done;
  // A state that takes no ABORT answers it with dfuERROR, which CLRSTATUS ends.
  for (int step = 0; step < 2; ++step) {
    const Linked<DfuAnswer> answer = get_status();
    if (!answer) return tl::unexpected(answer.error());
    if (answer->state == DfuState::kIdle) return {};
    const DfuRequest way = answer->state == DfuState::kError ? DfuRequest::kClearStatus : DfuRequest::kAbort;
    done = link_->out(dfu(kClassOut, way), {}, kTimeout);
    if (done || done.error() != LinkFault::kStall) break;
  }
  return done;
}

Linked<image::StatusBlock> DfuClient::read_status_block() {
  const auto bytes =
      link_->in({kVendorIn, static_cast<std::uint8_t>(image::VendorRequest::kStatus), 0}, image::kStatusSize, kTimeout);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::optional<image::StatusBlock> status = image::decode_status(*bytes);
  if (!status) return tl::unexpected(LinkFault::kOther);
  return *status;
}

Linked<void> DfuClient::vendor(image::VendorRequest request, std::uint16_t value, std::span<const std::byte> data) {
  return link_->out({kVendorOut, static_cast<std::uint8_t>(request), value}, data, kTimeout);
}

tl::expected<void, Broken> DfuClient::ask(image::VendorRequest request, std::uint16_t value,
                                          std::span<const std::byte> data) {
  const Linked<void> taken = vendor(request, value, data);
  if (taken && data.empty()) return {};
  if (!taken && taken.error() != LinkFault::kStall) return tl::unexpected(Broken{taken.error()});
  const Linked<image::StatusBlock> status = read_status_block();
  if (!status) return tl::unexpected(Broken{status.error()});
  if (taken && status->last_error == 0) return {};
  return tl::unexpected(Broken{LinkFault::kStall, status->last_error});
}

tl::expected<std::vector<std::byte>, Broken> DfuClient::read_calibration() {
  constexpr auto kRequest = static_cast<std::uint8_t>(image::VendorRequest::kCalibration);
  std::vector<std::byte> all;
  for (std::uint16_t block = 0; all.size() <= kLongestCalibration; ++block) {
    const auto part = link_->in({kVendorIn, kRequest, block}, image::kDfuTransferSize, kTimeout);
    if (!part && part.error() == LinkFault::kStall) {
      const Linked<image::StatusBlock> status = read_status_block();
      return tl::unexpected(Broken{LinkFault::kStall, status ? status->last_error : 0});
    }
    if (!part) return tl::unexpected(Broken{part.error()});
    all.insert(all.end(), part->begin(), part->end());
    if (part->size() < image::kDfuTransferSize) return all;
  }
  return tl::unexpected(Broken{LinkFault::kOther});
}

Broken DfuClient::broken(LinkFault fault) {
  if (fault == LinkFault::kGone) return {fault};
  // A stall alone says nothing; the status tells whether the probe refused, and why.
  const Linked<DfuAnswer> answer = get_status();
  if (!answer) return {answer.error()};
  if (answer->state != DfuState::kError) return {fault};
  const Linked<image::StatusBlock> status = read_status_block();
  const std::uint32_t why = status ? status->last_error : 0;
  static_cast<void>(settle());
  return {fault, why};
}

Linked<DfuAnswer> DfuClient::send_block(std::uint16_t block, std::span<const std::byte> data) {
  Linked<DfuAnswer> answer = parse(link_->out_then_in(dfu(kClassOut, DfuRequest::kDownload, block), data,
                                                      dfu(kClassIn, DfuRequest::kGetStatus), kAnswerSize, kTimeout));
  const HostTime deadline = clock_->now() + kBlockDeadline;
  while (answer && answer->state == DfuState::kDownloadBusy) {
    if (clock_->now() >= deadline) return tl::unexpected(LinkFault::kBusy);
    clock_->sleep_for(std::clamp(answer->poll, kShortestPoll, kLongestPoll));
    answer = get_status();
  }
  if (answer && answer->state != DfuState::kDownloadIdle) return tl::unexpected(LinkFault::kStall);
  return answer;
}

tl::expected<void, Broken> DfuClient::may_begin(std::span<const std::byte> image) {
  if (const Linked<void> idle = settle(); !idle) return tl::unexpected(broken(idle.error()));
  if (const auto taken = send_block(0, image.first(std::min(image.size(), kKnock))); !taken) {
    return tl::unexpected(broken(taken.error()));
  }
  if (const Linked<void> idle = settle(); !idle) return tl::unexpected(broken(idle.error()));
  return {};
}

tl::expected<bool, Broken> DfuClient::download(std::span<const std::byte> image,
                                               const std::function<void(std::size_t)>& sent,
                                               const std::atomic<bool>& stop) {
  if (const Linked<void> idle = settle(); !idle) return tl::unexpected(broken(idle.error()));
  std::uint32_t block = 0;
  for (std::size_t at = 0; at < image.size(); ++block) {
    if (stop) {
      static_cast<void>(settle());
      return false;
    }
    const std::size_t n = std::min<std::size_t>(image::kDfuTransferSize, image.size() - at);
    // Block numbers are 16 bits wide and wrap (DFU 1.1 §6.1.1).
    if (const auto taken = send_block(static_cast<std::uint16_t>(block & 0xFFFFU), image.subspan(at, n)); !taken) {
      Broken why = broken(taken.error());
      why.block = block;
      return tl::unexpected(why);
    }
    at += n;
    sent(at);
  }
  return true;
}

tl::expected<void, Broken> DfuClient::manifest() {
  const Linked<void> said = link_->out(dfu(kClassOut, DfuRequest::kDownload), {}, kTimeout);
  if (!said) return tl::unexpected(broken(said.error()));
  for (const HostTime deadline = clock_->now() + kManifestDeadline; clock_->now() < deadline;) {
    const Linked<DfuAnswer> answer = get_status();
    if (!answer) return tl::unexpected(broken(answer.error()));
    if (answer->state == DfuState::kIdle) return {};
    if (answer->state == DfuState::kError) return tl::unexpected(broken(LinkFault::kStall));
    clock_->sleep_for(std::clamp(answer->poll, kShortestPoll, kLongestPoll));
  }
  return tl::unexpected(Broken{LinkFault::kBusy});
}

}  // namespace enamel::update
