#include "host/update/flash_flow.hpp"

#include <algorithm>

namespace enamel::update {
namespace {

using namespace std::chrono_literals;

constexpr int kRetries = 3;
constexpr auto kLookEvery = 100ms;
constexpr auto kSamePort = 10s;  ///< before other ports are searched
constexpr std::uint8_t kConfirmed = 5;
constexpr double kTransferStart = 0.02, kTransferShare = 0.78, kVerifyEnd = 0.90;

class Flow {
 public:
  Flow(UsbBus& bus, Clock& clock, const PortInfo& probe, const FlashRequest& request,
       const std::function<void(const FlashProgress&)>& progress, const std::atomic<bool>& stop)
      : bus_(&bus), clock_(&clock), probe_(probe), request_(&request), progress_(&progress), stop_(&stop) {}

  Updated<FlashResult> run() {
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

 private:
  Updated<FlashResult> preflight() {
    if (probe_.denied) return tl::unexpected(no_permission(probe_.port));
    if (const auto opened = open(); !opened) return tl::unexpected(opened.error());
    DfuClient client(*link_, *clock_);
    const Linked<image::StatusBlock> status = client.read_status_block();
    if (!status) return tl::unexpected(transfer_failed("reading the status", to_text(status.error())));
    FlashResult result{probe_.serial, status->version[status->active], request_->manifest.version, true};
    const image::Manifest& m = request_->manifest;
    if (status->hw_rev < m.hw_rev_min || status->hw_rev > m.hw_rev_max) {
      return tl::unexpected(refused_by_probe(image::Refusal::kHardware));
    }
    const bool older = m.version < result.before && !request_->allow_older;
    if (m.security_counter < status->min_security_counter || older) {
      return tl::unexpected(refused_by_probe(image::Refusal::kRollback));
    }
    if ((m.version == result.before && !request_->allow_same) || request_->dry_run) result.written = false;
    return result;
  }

  Updated<void> open() {
    link_.reset();
    Linked<std::unique_ptr<ProbeLink>> link = bus_->open(probe_.port);
    if (!link && link.error() == LinkFault::kDenied) return tl::unexpected(no_permission(probe_.port));
    if (!link) return tl::unexpected(transfer_failed("opening port " + probe_.port, to_text(link.error())));
    link_ = std::move(*link);
    return {};
  }

  /// Download and manifestation; a broken one is repeated, and the probe skips what it has.
  Updated<void> transfer() {
    for (int attempt = 0;; ++attempt) {
      DfuClient client(*link_, *clock_);
      if (request_->allow_older) static_cast<void>(client.vendor(image::VendorRequest::kAllowOlder));
      started_ = clock_->now();
      const auto sent = client.download(
          request_->image, [this](std::size_t n) { tell_sent(n); }, *stop_);
      if (sent && !*sent) return tl::unexpected(cancelled());
      tl::expected<void, Broken> done;
      if (sent) {
        tell(Step::kVerify, kTransferStart + kTransferShare);
        done = client.manifest();
        if (done) return {};
      }
      const Broken why = sent ? done.error() : sent.error();
      if (why.refusal != 0) return tl::unexpected(refused_by_probe(why.refusal));
      if (attempt == kRetries) return tl::unexpected(transfer_failed("sending the image", to_text(why.fault)));
      // What is neither a stall nor a silence is a connection that broke, whatever the system calls it.
      if (why.fault != LinkFault::kStall && why.fault != LinkFault::kTimeout) {
        if (auto back = wait_return(); !back) return back;
      }
    }
  }

  Updated<void> restart() {
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
      if (*stop_) return tl::unexpected(cancelled());
      if (const std::optional<PortInfo> back = find(clock_->now() - gone > kSamePort)) {
        probe_ = *back;
        if (open()) return {};
      }
      clock_->sleep_for(kLookEvery);
    }
    return tl::unexpected(UpdateError{Exit::kTransfer, "the probe " + probe_.serial + " did not come back",
                                      "unplugged, switched off, or its battery is empty",
                                      "plug it in and run the same command again; the old firmware boots"});
  }

  Updated<void> wait_confirmed(const FlashResult& result) {
    tell(Step::kConfirm, 0.95);
    const HostTime deadline = clock_->now() + request_->confirm_deadline;
    while (clock_->now() < deadline) {
      const Linked<image::StatusBlock> status = DfuClient(*link_, *clock_).read_status_block();
      if (!status) {
        if (auto back = wait_return(); !back) return back;
        continue;
      }
      const std::uint8_t active = status->active;
      if (status->version[active] == result.after && status->slot_state[active] == kConfirmed) return {};
      const bool given_up = std::none_of(status->slot_state.begin(), status->slot_state.end(),
                                         [](std::uint8_t s) { return s == 3 || s == 4; });
      if (given_up) break;
      clock_->sleep_for(kLookEvery);
    }
    UpdateError error = refused_by_probe(image::Refusal::kSelfTest);
    error.what = "the new firmware was not confirmed; the probe runs the old one";
    error.exit = Exit::kNotConfirmed;
    return tl::unexpected(error);
  }

  void tell(Step step, double share, double left = 0) const { (*progress_)({step, share, left}); }

  void tell_sent(std::size_t sent) const {
    const double done = static_cast<double>(sent) / static_cast<double>(request_->image.size());
    const std::chrono::duration<double> passed = clock_->now() - started_;
    tell(Step::kTransfer, kTransferStart + kTransferShare * done, passed.count() * (1 - done) / done);
  }

  UsbBus* bus_;
  Clock* clock_;
  PortInfo probe_;
  const FlashRequest* request_;
  const std::function<void(const FlashProgress&)>* progress_;
  const std::atomic<bool>* stop_;
  std::unique_ptr<ProbeLink> link_;
  HostTime started_{};
};

}  // namespace

Updated<FlashResult> flash(UsbBus& bus, Clock& clock, const PortInfo& probe, const FlashRequest& request,
                           const std::function<void(const FlashProgress&)>& progress, const std::atomic<bool>& stop) {
  return Flow(bus, clock, probe, request, progress, stop).run();
}

}  // namespace enamel::update
