#include "firmware/updater/updater.hpp"

#include <memory>

#include "firmware/boot/slot_image.hpp"
#include "firmware/gadget/control_loop.hpp"
#include "firmware/gadget/functionfs.hpp"
#include "firmware/gadget/usb_gadget.hpp"
#include "firmware/keys/trusted_keys.hpp"
#include "firmware/storage/file_flash.hpp"
#include "firmware/updater/probe_services.hpp"
#include "firmware/updater/start.hpp"
#include "protocol/base/log.hpp"
#include "protocol/image/version_text.hpp"

namespace enamel::fw {
namespace {

constexpr const char* kModule = "updated";
constexpr image::ImageVersion kBootloader = {1, 0, 0, 0};
constexpr std::uint16_t kProtocol = 1;
constexpr std::chrono::milliseconds kTick{500};
constexpr std::chrono::milliseconds kSelfTestLimit{60'000};

class Updater {
 public:
  Updater(const UpdaterOptions& options, Flash& flash, ScanLock* lock, const image::Trust& trust)
      : options_(&options),
        regions_(boot_regions(flash)),
        hardware_{image::kProductId, options.hw_rev, kBootloader, kProtocol},
        running_(find_running(regions_, hardware_, trust, {options.slot, options.recovery})),
        identity_{hardware_, trust, running_.slot, running_.version},
        services_(options, slot_name(), lock, clock_),
        device_(regions_, identity_, serial_bytes(options.serial), services_) {}

  Result<int> run(const std::atomic<bool>& stop) {
    if (running_.version) {
      log::info(kModule, "slot {} runs, version {}{}", slot_name(), image::to_text(*running_.version),
                running_.on_trial ? ", on trial" : "");
    } else {
      log::warn(kModule, "nothing boots or recovery was asked for: waiting for an image");
    }
    if (running_.on_trial && !confirm_itself()) return updater_exit::kTrialFailed;
    return serve(stop);
  }

 private:
  [[nodiscard]] const char* slot_name() const noexcept {
    if (!running_.version) return "recovery";
    return running_.slot == 0 ? "A" : "B";
  }

  bool confirm_itself() {
    const bool passed = services_.self_test(kSelfTestLimit);
    if (!passed) log::error(kModule, "the self-test failed; the bootloader decides what runs next");
    if (passed && device_.confirm_running(false)) return true;
    if (passed) log::error(kModule, "the confirmation cannot be stored");
    return false;
  }

  Result<int> serve(const std::atomic<bool>& stop) {
    ENAMEL_TRY_ASSIGN(const std::unique_ptr<FunctionFs> port, FunctionFs::open(options_->functionfs, clock_));
    log::info(kModule, "{} DFU functional descriptor",
              port->functional_descriptor() ? "with" : "this kernel refuses the descriptor: without");
    if (!options_->gadget.empty()) {
      ENAMEL_TRY(connect_gadget(options_->gadget, usb_identity(identity_), options_->serial));
    }
    ControlLoop loop(*port, device_);
    const HostTime started = clock_.now();
    bool counted = false;
    Result<void> served;
    while (served && !stop && !services_.restart()) {
      served = loop.step(kTick);
      if (!counted && running_.version && clock_.now() - started > std::chrono::seconds(options_->counter_after_s)) {
        counted = device_.raise_counter_now();
      }
    }
    const PortCounts& n = loop.counts();
    log::info(kModule, "{} transfers, {} stalled, {} given up by the host, {} resets", n.transfers, n.stalled,
              n.given_up, n.resets);
    if (!options_->gadget.empty()) disconnect_gadget(options_->gadget);
    ENAMEL_TRY(served);
    if (!services_.restart()) return updater_exit::kStopped;
    return *services_.restart() == Restart::kRecovery ? updater_exit::kRestartRecovery : updater_exit::kRestart;
  }

  const UpdaterOptions* options_;
  SteadyClock clock_;
  BootRegions regions_;
  image::Hardware hardware_;
  Running running_;
  UpdateIdentity identity_;
  ProbeServices services_;
  UpdateDevice device_;
};

}  // namespace

Result<int> run_updater(const UpdaterOptions& options, const std::atomic<bool>& stop) {
  ENAMEL_TRY_ASSIGN(const std::unique_ptr<FileFlash> flash, FileFlash::open(options.flash, flash_map::kSize));
  const image::Trust trust{trusted_keys(), 0, options.development, &image::sodium_ed25519(), options.in_factory};
  std::unique_ptr<ScanLock> lock;
  if (!options.scan_lock.empty()) {
    ENAMEL_TRY_ASSIGN(lock, ScanLock::open(options.scan_lock));
  }
  return std::make_unique<Updater>(options, *flash, lock.get(), trust)->run(stop);
}

}  // namespace enamel::fw
