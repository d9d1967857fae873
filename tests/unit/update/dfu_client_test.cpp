// The host's half against the device half in one process, on a virtual clock: probes that stay busy, answers that come
// before the judgement.
#include "host/update/dfu_client.hpp"

#include "host/update/flash_flow.hpp"
#include "protocol/base/clock.hpp"
#include "tests/unit/update/update_probe.hpp"

namespace enamel::fw {
namespace {

using namespace std::chrono_literals;
using update::ControlRequest;
using update::Linked;
using update::LinkFault;

/// Jumps to where someone wants to sleep. One thread.
class JumpingClock final : public Clock {
 public:
  [[nodiscard]] HostTime now() const override { return now_; }
  void sleep_until(HostTime t) override { now_ = std::max(now_, t); }

 private:
  HostTime now_ = host_time(1'000'000'000);
};

/// What is wrong with the probe at the other end.
struct Manners {
  HostTime busy_until{};            ///< tells dfuDNBUSY after a block until then
  HostTime verifies_until{};        ///< tells dfuMANIFEST until then
  bool acknowledges_first = false;  ///< data is acknowledged before it is judged, as FunctionFS does
};

class DeviceLink final : public update::ProbeLink {
 public:
  DeviceLink(UpdateDevice& device, Clock& clock, const Manners& manners)
      : device_(&device), clock_(&clock), manners_(&manners) {}

  Linked<void> out(const ControlRequest& r, std::span<const std::byte> data, std::chrono::milliseconds) override {
    const auto length = static_cast<std::uint16_t>(data.size());
    const bool stalled = device_->control({r.type, r.request, r.value, 0, length}, data).stall;
    if (stalled && (data.empty() || !manners_->acknowledges_first)) return tl::unexpected(LinkFault::kStall);
    return {};
  }
  Linked<std::vector<std::byte>> in(const ControlRequest& r, std::uint16_t length, std::chrono::milliseconds) override {
    const DfuState before = device_->position().state;
    const bool status = r.type == image::request_type::kClassIn && r.request == 3;
    if (status && clock_->now() < manners_->busy_until && before == DfuState::kDownloadSync) return busy(before);
    if (status && clock_->now() < manners_->verifies_until && before == DfuState::kManifest) return busy(before);
    const ControlReply reply = device_->control({r.type, r.request, r.value, 0, length}, {});
    if (reply.stall) return tl::unexpected(LinkFault::kStall);
    std::vector<std::byte> bytes(reply.data.begin(), reply.data.end());
    while (clock_->now() >= manners_->verifies_until && device_->work_pending()) device_->work();
    return bytes;
  }
  Linked<std::vector<std::byte>> out_then_in(const ControlRequest& first, std::span<const std::byte> data,
                                             const ControlRequest& second, std::uint16_t length,
                                             std::chrono::milliseconds timeout) override {
    if (const auto sent = out(first, data, timeout); !sent) return tl::unexpected(sent.error());
    return in(second, length, timeout);
  }

 private:
  static std::vector<std::byte> busy(DfuState state) {
    const DfuState told = state == DfuState::kDownloadSync ? DfuState::kDownloadBusy : state;
    return {std::byte{0}, std::byte{100}, std::byte{0}, std::byte{0}, static_cast<std::byte>(told), std::byte{0}};
  }

  UpdateDevice* device_;
  Clock* clock_;
  const Manners* manners_;
};

class OnePort final : public update::UsbBus {
 public:
  OnePort(UpdateDevice& device, Clock& clock, const Manners& manners)
      : device_(&device), clock_(&clock), manners_(&manners) {}
  std::vector<update::PortInfo> probes() override { return {info()}; }
  std::optional<update::PortInfo> probe_at(const std::string&) override { return info(); }
  Linked<std::unique_ptr<update::ProbeLink>> open(const std::string&) override {
    return std::make_unique<DeviceLink>(*device_, *clock_, *manners_);
  }
  static update::PortInfo info() { return {"1-1", "EN2-007", image::kUsbProduct, 0x0100, 480, false, "model"}; }

 private:
  UpdateDevice* device_;
  Clock* clock_;
  const Manners* manners_;
};

class DfuHost : public Update {
 protected:
  [[nodiscard]] update::Updated<update::FlashResult> flash() {
    OnePort bus(*device_, clock_, manners_);
    const auto manifest = image::parse_manifest(image_);
    EXPECT_TRUE(manifest.has_value());
    update::FlashRequest request{.image = image_, .manifest = *manifest};
    const update::FlashObserver observer{.progress = [](const auto&) {}, .event = [](const auto&) {}};
    return update::flash(bus, clock_, OnePort::info(), request, observer, stop_);
  }
  [[nodiscard]] tl::expected<bool, update::Broken> send() {
    DeviceLink link(*device_, clock_, manners_);
    update::DfuClient client(link, clock_);
    return client.download(
        image_, [](std::size_t) {}, stop_);
  }
  /// Of the virtual clock.
  [[nodiscard]] std::chrono::duration<double> passed() const { return clock_.now() - start_; }

  JumpingClock clock_;
  HostTime start_ = clock_.now();
  Manners manners_;
  std::vector<std::byte> image_ = make({2, 0, 0, 0}, 2);
  std::atomic<bool> stop_{false};
};

TEST_F(DfuHost, a_block_that_stays_busy_ends_at_a_deadline) {
  manners_.busy_until = HostTime::max();
  const auto sent = send();
  ASSERT_FALSE(sent.has_value());
  EXPECT_EQ(sent.error().fault, LinkFault::kBusy);
  EXPECT_EQ(sent.error().block, 0U);
  EXPECT_GE(passed(), 10s);
  EXPECT_LE(passed(), 12s);
}

TEST_F(DfuHost, a_block_that_is_busy_for_a_while_is_waited_for) {
  manners_.busy_until = clock_.now() + 9s;
  const auto sent = send();
  ASSERT_TRUE(sent.has_value()) << update::to_text(sent.error().fault);
  EXPECT_TRUE(*sent);
  EXPECT_GE(passed(), 9s);
}

TEST_F(DfuHost, a_verification_that_never_ends_ends_at_a_deadline) {
  ASSERT_TRUE(send().has_value());
  manners_.verifies_until = HostTime::max();
  DeviceLink link(*device_, clock_, manners_);
  const auto done = update::DfuClient(link, clock_).manifest();
  ASSERT_FALSE(done.has_value());
  EXPECT_EQ(done.error().fault, LinkFault::kBusy);
  EXPECT_LE(passed(), 63s);
}

TEST_F(DfuHost, a_verification_that_takes_long_is_waited_for) {
  ASSERT_TRUE(send().has_value());
  manners_.verifies_until = clock_.now() + 50s;
  DeviceLink link(*device_, clock_, manners_);
  EXPECT_TRUE(update::DfuClient(link, clock_).manifest().has_value());
  EXPECT_EQ(control().slot[1].state, SlotState::kPending);
}

TEST_F(DfuHost, the_tool_gives_up_on_a_busy_probe_with_cause_and_remedy) {
  manners_.busy_until = HostTime::max();
  const auto result = flash();
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().exit, update::Exit::kTransfer);
  EXPECT_NE(result.error().what.find("does not finish"), std::string::npos) << result.error().what;
  EXPECT_NE(result.error().cause.find("flash"), std::string::npos);
  EXPECT_FALSE(result.error().remedy.empty());
  EXPECT_LE(passed(), 120s) << "three retries, each with its deadline";
  EXPECT_EQ(control().slot[0].state, SlotState::kConfirmed);
}

TEST_F(DfuHost, a_refusal_after_the_acknowledgement_is_not_taken_for_success) {
  image::Serial other = kSerial;
  other[0] = 'X';
  for (const bool first : {false, true}) {
    manners_.acknowledges_first = first;
    DeviceLink link(*device_, clock_, manners_);
    update::DfuClient client(link, clock_);
    const auto refused = client.ask(VendorRequest::kFactoryReset, 0, std::as_bytes(std::span(other)));
    ASSERT_FALSE(refused.has_value()) << first;
    EXPECT_EQ(refused.error().refusal, number(Refusal::kSerial));
    EXPECT_TRUE(client.ask(VendorRequest::kFactoryReset, 0, std::as_bytes(std::span(kSerial))).has_value());
  }
}

}  // namespace
}  // namespace enamel::fw
