#include "tests/usb/probe_model.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "firmware/boot/policy.hpp"
#include "firmware/boot/transitions.hpp"
#include "protocol/image/dfu_suffix.hpp"

namespace enamel::test {
namespace {

using namespace fw;

class Judge final : public SlotJudge {
 public:
  Judge(FlashModel& flash, const image::Hardware& hardware, const image::Trust& trust)
      : flash_(&flash), hardware_(hardware), trust_(trust) {}
  bool verifies(std::size_t slot) noexcept override {
    return check_slot(boot_regions(*flash_).slot[slot], hardware_, trust_, *workspace_).has_value();
  }

 private:
  FlashModel* flash_;
  image::Hardware hardware_;
  image::Trust trust_;
  std::unique_ptr<SlotWorkspace> workspace_ = std::make_unique<SlotWorkspace>();
};

image::Hardware hardware_of(const ProbeOptions& options) {
  image::Hardware hardware = test_hardware();
  hardware.hw_rev = options.hw_rev;
  return hardware;
}

image::Serial serial_of(const ProbeOptions& options) {
  image::Serial serial{};
  std::copy_n(options.serial.begin(), std::min(options.serial.size(), serial.size()), serial.begin());
  return serial;
}

}  // namespace

ProbeModel::ProbeModel(const ProbeOptions& options) : options_(options), flash_(flash_map::kSize) {
  install_factory();
  boot();
}

void ProbeModel::install_factory() {
  image::ImageDescription d = plain_description();
  d.version = {1, 0, 0, 0};
  d.security_counter = 1;
  const std::vector<std::byte> file = build(d, random_payload(100'000, 1), {&keys_.signer(0), 1});
  const auto receiver = std::make_unique<ImageReceiver>(
      boot_regions(flash_), UpdateIdentity{test_hardware(), keys_.trust(), 1, std::nullopt});
  receiver->restart(false);
  const auto content = std::span(file).first(file.size() - image::kSuffixSize);
  ControlStore store(boot_regions(flash_).control);
  const bool installed =
      receiver->take(content).has_value() && receiver->finish().has_value() && store.store(confirm(*store.load(), 0)) &&
      flash_.program(flash_map::kCalibration, random_payload(2 * kEraseBlock, 9)) == FlashStatus::kOk;
  if (!installed) throw std::runtime_error("the factory's firmware was not accepted");
}

std::optional<std::size_t> ProbeModel::choose() {
  ControlStore store(boot_regions(flash_).control);
  Judge judge(flash_, hardware_of(options_), keys_.trust());
  return choose_slot(store, judge);
}

void ProbeModel::boot() {
  running_ = choose();
  while (running_ && !self_test()) running_ = choose();
  if (!running_) throw std::runtime_error("nothing boots");
  start(*running_);
  ControlStore store(boot_regions(flash_).control);
  if (store.load()->slot[*running_].state == SlotState::kTrial && !device_->confirm_running(false)) {
    throw std::runtime_error("the new firmware cannot confirm itself");
  }
}

void ProbeModel::start(std::size_t slot) {
  const image::ImageVersion version = ControlStore(boot_regions(flash_).control).load()->slot[slot].version;
  device_ = std::make_unique<UpdateDevice>(boot_regions(flash_),
                                           UpdateIdentity{hardware_of(options_), keys_.trust(), slot, version},
                                           serial_of(options_), static_cast<UpdateServices&>(*this));
}

std::optional<std::size_t> ProbeModel::read_calibration(std::size_t offset, std::span<std::byte> out) noexcept {
  if (options_.rig_bytes == 0) return std::nullopt;
  const std::vector<std::byte> rig = random_payload(options_.rig_bytes, 31);
  const std::size_t from = std::min(offset, rig.size()), n = std::min(out.size(), rig.size() - from);
  std::copy_n(rig.begin() + static_cast<std::ptrdiff_t>(from), n, out.begin());
  return n;
}

std::string ProbeModel::calibration_sha() const {
  std::vector<std::byte> bytes(2 * kEraseBlock);
  static_cast<void>(flash_.read(flash_map::kCalibration, bytes));
  return sha256_hex(bytes);
}

}  // namespace enamel::test
