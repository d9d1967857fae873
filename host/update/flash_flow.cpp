#include "host/update/flash_flow.hpp"

#include <algorithm>
#include <utility>

#include "protocol/image/version_text.hpp"

namespace enamel::update {
namespace {

using namespace std::chrono_literals;

constexpr int kRetries = 3;
constexpr auto kLookEvery = 100ms;
constexpr int kHighSpeedMbit = 480;
constexpr std::uint8_t kPending = 3, kTrial = 4, kConfirmed = 5;  ///< slot states, docs/firmware-image.md §4
constexpr double kTransferStart = 0.02, kTransferShare = 0.78, kVerifyEnd = 0.90;

class Flow {
 public:
  Flow(UsbBus& bus, Clock& clock, const PortInfo& probe, const FlashRequest& request, const FlashObserver& observer,
       const std::atomic<bool>& stop)
      : bus_(&bus), clock_(&clock), probe_(probe), request_(&request), observer_(&observer), stop_(&stop) {}

  Updated<FlashResult> run() {
    Updated<FlashResult> result = update();
    if (!result) {
      log("failed", result.error().what);
    } else {
      log(result->written ? "confirmed" : "not written", image::to_text(result->after));
    }
    return result;
  }

 private:
  Updated<FlashResult> update() {
    tell(Step::kPreflight, 0);
    Updated<FlashResult> result = preflight();
    if (!result || !result->written) return result;
    if (const auto sent = transfer(); !sent) return tl::unexpected(sent.error());
    tell(Step::kRestart, kVerifyEnd);
    if (const auto asked = restart(); !asked) return tl::unexpected(asked.error());
    if (const auto confirmed = wait_confirmed(*result); !confirmed) return tl::unexpected(confirmed.error());
    tell(Step::kDone, 1);
    return result;
  }

  Updated<FlashResult> preflight() {
    if (probe_.denied) return fail(HostError::kNoPermission, "port " + probe_.port);
    if (const auto opened = open(); !opened) return tl::unexpected(opened.error());
    if (probe_.speed_mbit > 0 && probe_.speed_mbit < kHighSpeedMbit) {
      log(kSlowPort, std::to_string(probe_.speed_mbit) + " Mbit/s");
    }
    DfuClient client(*link_, *clock_);
    const Linked<image::StatusBlock> status = client.read_status_block();
    if (!status) return fail(HostError::kBrokenTransfer, "reading the status, " + to_text(status.error()));
    FlashResult result{probe_.serial, status->version[status->active], request_->manifest.version, true};
    log("begin", image::to_text(result.before) + " -> " + image::to_text(result.after));
    const image::Manifest& m = request_->manifest;
    if (status->hw_rev < m.hw_rev_min || status->hw_rev > m.hw_rev_max) {
      return tl::unexpected(refused_by_probe(image::Refusal::kHardware));
    }
    const bool older = m.version < result.before && !request_->allow_older;
    if (m.security_counter < status->min_security_counter || older) {
      return tl::unexpected(refused_by_probe(image::Refusal::kRollback));
    }
    if (m.version == result.before && !request_->allow_same) {
      result.written = false;
      return result;
    }
    // Battery and open session are the probe's to judge. A broken connection shows itself again in the transfer.
    if (const auto ready = client.may_begin(request_->image); !ready && ready.error().refusal != 0) {
      return tl::unexpected(refused_by_probe(ready.error().refusal));
    }
    if (request_->dry_run) result.written = false;
    return result;
  }

  Updated<void> open() {
    link_.reset();
    Linked<std::unique_ptr<ProbeLink>> link = bus_->open(probe_.port);
    if (!link && link.error() == LinkFault::kDenied) return fail(HostError::kNoPermission, "port " + probe_.port);
    if (!link) return fail(HostError::kBrokenTransfer, "opening port " + probe_.port + ", " + to_text(link.error()));
    link_ = std::move(*link);
    return {};
  }

  /// Download and manifestation; a broken one is repeated, and the probe skips what it has.
  Updated<void> transfer() {
    for (int attempt = 0;; ++attempt) {
      DfuClient client(*link_, *clock_);
      if (request_->allow_older) static_cast<void>(client.vendor(image::VendorRequest::kAllowOlder));
      started_ = clock_->now();
      log("sending", "attempt " + std::to_string(attempt + 1));
      const auto sent = client.download(
          request_->image, [this](std::size_t n) { tell_sent(n); }, *stop_);
      if (sent && !*sent) return fail(HostError::kCancelled);
      tl::expected<void, Broken> done;
      if (sent) {
        tell(Step::kVerify, kTransferStart + kTransferShare);
        log("verifying");
        done = client.manifest();
        if (done) return {};
      }
      const Broken why = sent ? done.error() : sent.error();
      if (why.refusal != 0) return tl::unexpected(refused_by_probe(why.refusal));
      log("broken", to_text(why.fault), why.block);
      if (attempt == kRetries) return gave_up(why, sent.has_value());
      if (broke_off(why.fault)) {
        tell(Step::kGone, share_);
        if (auto back = wait_return(); !back) return back;
      }
    }
  }

  /// What is neither a stall nor a silence is a connection that broke, whatever the system calls it.
  static bool broke_off(LinkFault fault) {
    return fault != LinkFault::kStall && fault != LinkFault::kTimeout && fault != LinkFault::kBusy;
  }

  static Updated<void> gave_up(const Broken& why, bool verifying) {
    if (why.fault == LinkFault::kBusy) {
      return fail(HostError::kStaysBusy, verifying ? "verifying" : "block " + std::to_string(why.block));
    }
    return fail(HostError::kBrokenTransfer, "sending the image, " + to_text(why.fault));
  }

  Updated<void> restart() {
    log("restarting");
    // The probe may be gone before it has answered.
    static_cast<void>(DfuClient(*link_, *clock_).vendor(image::VendorRequest::kReboot));
    link_.reset();
    const HostTime deadline = clock_->now() + request_->return_deadline;
    while (clock_->now() < deadline && bus_->probe_at(probe_.port)) clock_->sleep_for(kLookEvery);
    return wait_return();
  }

  /// At its port, where it nearly always is; after a while wherever its serial is seen.
  [[nodiscard]] std::optional<PortInfo> find(bool everywhere) const {
    std::optional<PortInfo> here = bus_->probe_at(probe_.port);
    if (here && (here->serial.empty() || here->serial == probe_.serial)) return here;
    if (!everywhere || probe_.serial.empty()) return std::nullopt;
    for (const PortInfo& p : bus_->probes()) {
      if (p.serial == probe_.serial) return p;
    }
    return std::nullopt;
  }

  Updated<void> wait_return() {
    link_.reset();
    const HostTime gone = clock_->now();
    while (clock_->now() - gone < request_->return_deadline) {
      if (*stop_) return fail(HostError::kCancelled);
      if (const std::optional<PortInfo> back = find(clock_->now() - gone > request_->return_deadline / 3)) {
        probe_ = *back;
        if (open()) {
          log("back", "port " + probe_.port);
          return {};
        }
      }
      clock_->sleep_for(kLookEvery);
    }
    return fail(HostError::kNotBack, probe_.serial.empty() ? "port " + probe_.port : probe_.serial);
  }

  Updated<void> wait_confirmed(const FlashResult& result) {
    tell(Step::kConfirm, 0.95);
    const HostTime deadline = clock_->now() + request_->confirm_deadline;
    while (clock_->now() < deadline) {
      if (*stop_) return fail(HostError::kCancelled, "the new firmware is there and confirms itself");
      const Linked<image::StatusBlock> status = DfuClient(*link_, *clock_).read_status_block();
      if (!status) {
        if (auto back = wait_return(); !back) return back;
        continue;
      }
      const std::uint8_t active = status->active;
      if (status->version[active] == result.after && status->slot_state[active] == kConfirmed) return {};
      const bool given_up = std::none_of(status->slot_state.begin(), status->slot_state.end(),
                                         [](std::uint8_t s) { return s == kPending || s == kTrial; });
      if (given_up) return fail(HostError::kRolledBack, image::to_text(status->version[active]));
      clock_->sleep_for(kLookEvery);
    }
    return fail(HostError::kStillOnTrial);
  }

  void log(std::string_view event, std::string status = {}, std::uint32_t block = 0) const {
    observer_->event({event, block, std::move(status)});
  }

  void tell(Step step, double share, double left = 0) {
    share_ = share;
    observer_->progress({step, share, left});
  }

  void tell_sent(std::size_t sent) {
    const double done = static_cast<double>(sent) / static_cast<double>(request_->image.size());
    const std::chrono::duration<double> passed = clock_->now() - started_;
    tell(Step::kTransfer, kTransferStart + kTransferShare * done, passed.count() * (1 - done) / done);
  }

  UsbBus* bus_;
  Clock* clock_;
  PortInfo probe_;
  const FlashRequest* request_;
  const FlashObserver* observer_;
  const std::atomic<bool>* stop_;
  std::unique_ptr<ProbeLink> link_;
  HostTime started_{};
  double share_ = 0;  ///< of everything, as told last
};

}  // namespace

Updated<FlashResult> flash(UsbBus& bus, Clock& clock, const PortInfo& probe, const FlashRequest& request,
                           const FlashObserver& observer, const std::atomic<bool>& stop) {
  return Flow(bus, clock, probe, request, observer, stop).run();
}

}  // namespace enamel::update
