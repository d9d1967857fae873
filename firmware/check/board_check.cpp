#include "firmware/check/board_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <utility>

#include "firmware/acquire/silence_watch.hpp"

namespace enamel::fw {
namespace {

using proto::ReplyStatus;

constexpr ScanTag kSession{SessionId{1}, 1};

/// Which error a fault of the acquisition is, by its class.
ErrorCode code_of(ReplyStatus fault) {
  switch (std::abs(static_cast<int>(fault)) / 100) {
    case 2:
      return fault == ReplyStatus::kTsUnstable ? ErrorCode::kBoardTiming : ErrorCode::kCamera;
    case 3:
      return ErrorCode::kProjector;
    case 5:
      return fault == ReplyStatus::kThermistor ? ErrorCode::kBoardThermal : ErrorCode::kHal;
    default:
      return ErrorCode::kHal;
  }
}

double us(Nanoseconds t) { return 1e-3 * static_cast<double>(t.count()); }

/// What bursts are judged by, without their pixels.
struct Seen {
  std::size_t bursts = 0;
  double mean_dn = 0, saturated = 0, ambient_dn = 0;
  Nanoseconds least_margin = Nanoseconds::max();
  std::optional<CheckPicture> first;
};

class DeviceCheck {
 public:
  DeviceCheck(Device& device, Clock& clock, const CheckConfig& config)
      : device_(device),
        clock_(clock),
        config_(config),
        hw_(device.hardware()),
        light_(hw_.light),
        acquisition_(
            hw_, light_, ledger_, [this](CapturedBurst b) { take(b); },
            AcquisitionConfig{.max_delay_spread = device.max_stamp_spread()}) {}

  CheckReport run() && {
    ledger_.open(kSession);
    static_cast<void>(check_rate() && check_stamps() && check_light() && check_bursts() && check_picture());
    return std::move(report_);
  }

 private:
  bool good(const char* part, std::string found) {
    add({part, std::move(found), std::nullopt});
    return true;
  }
  bool bad(const char* part, ErrorCode code, std::string found) {
    add({part, std::move(found), code});
    return false;
  }
  void add(CheckFinding f) {
    if (config_.found) config_.found(f);
    report_.findings.push_back(std::move(f));
  }

  /// The sensor's own stamps, without light: a driver that ignores the frame duration is seen here.
  bool check_rate() {
    if (auto started = hw_.camera.start(); !started) return bad("frames", started.error().code, started.error().detail);
    std::vector<std::int64_t> distances;
    DeviceTime before{};
    for (std::size_t tries = 0; distances.size() < config_.frames && tries < 3 * config_.frames; ++tries) {
      const auto frame = hw_.camera.next_frame();
      if (!frame) {
        hw_.camera.stop();
        return bad("frames", frame.error().code, frame.error().detail);
      }
      if (frame->status != FrameStatus::kSuccess) continue;
      if (before != DeviceTime{}) distances.push_back((frame->t_sensor - before).count());
      before = frame->t_sensor;
    }
    hw_.camera.stop();
    if (distances.size() < config_.frames) return bad("frames", ErrorCode::kCamera, "most of its frames are damaged");
    return judge_rate(Nanoseconds{median_of(std::move(distances))});
  }
  bool judge_rate(Nanoseconds period) {
    const CameraMode mode = hw_.camera.mode();
    const std::string found =
        fmt::format("{}x{}, {} bit, one every {:.1f} us", mode.width, mode.height, mode.bit_depth, us(period));
    const double off = std::abs(us(period - mode.frame_period)) / us(mode.frame_period);
    if (off <= config_.rate_tolerance) return good("frames", found);
    return bad("frames", ErrorCode::kBoardTiming,
               fmt::format("{}, asked for one every {:.1f} us: the sensor keeps its own rate; write it into "
                           "camera.frame_lines, or take a driver that obeys the frame duration",
                           found, us(mode.frame_period)));
  }

  /// False: it failed, and that has been said.
  bool wait(const char* part) {
    // A source that takes its time for a burst may take it here as well.
    const auto periods = static_cast<std::uint64_t>(2 * device_.max_silence() / hw_.camera.mode().frame_period);
    const std::uint64_t frames = std::max(periods, config_.least_patience);
    AcquisitionReport now = acquisition_.report();
    std::uint64_t begun = 0, most = now.beats + frames;
    SilenceWatch watch;
    const auto give_up = [&](ErrorCode code, std::string why) {
      light_.permit(false);
      acquisition_.abort();
      return bad(part, code, std::move(why));
    };
    for (; now.phase == AcquisitionPhase::kRunning; now = acquisition_.report()) {
      watch.update(now, clock_.now());
      if (watch.silence() > device_.max_silence()) return give_up(ErrorCode::kCamera, "it hangs: no frame comes");
      if (const std::uint64_t n = ledger_.counts().begun; n != begun) {
        begun = n;
        most = now.beats + frames;
      }
      if (now.beats > most) {
        return give_up(ErrorCode::kBoardLine,
                       fmt::format("{} begun, then nothing in {} frames: triggers are missing", begun, frames));
      }
      if (config_.meanwhile && !config_.meanwhile(watch.silence())) return give_up(ErrorCode::kCancelled, "stopped");
    }
    light_.permit(false);
    if (now.phase != AcquisitionPhase::kFailed) return true;
    std::string found = std::string(name_of(now.fault)) + remedy(now.fault);
    if (const auto delay = acquisition_.stamp_delay(); delay && now.fault == ReplyStatus::kTsUnstable) {
      found += "; " + scatter(*delay);
    }
    return bad(part, code_of(now.fault), found);
  }
  static const char* remedy(ReplyStatus fault) {
    switch (fault) {
      case ReplyStatus::kTsUnstable:
        return ": the stamps scatter against the strobe; is lines.strobe the right pin?";
      case ReplyStatus::kLedStuck:
        return ": light where none should be; is the LED's line wired, is the room dark?";
      case ReplyStatus::kProjLedFault:
        return ": no current in the LED; is its line wired, does sensors.led_current name the right file?";
      case ReplyStatus::kThermistor:
        return ": the tip's temperature cannot be read; see sensors.tip";
      case ReplyStatus::kCamTimeout:
        return ": no frame, or no strobe on lines.strobe";
      default:
        return "";
    }
  }

  bool check_stamps() {
    acquisition_.calibrate();
    if (!wait("stamps")) return false;
    const auto delay = acquisition_.stamp_delay();
    if (!delay) return bad("stamps", ErrorCode::kBoardTiming, "no strobe was seen: is lines.strobe the right pin?");
    return good("stamps", scatter(*delay));
  }
  [[nodiscard]] std::string scatter(const StampDelay& delay) const {
    return fmt::format("{:.1f} us behind the end of exposure, scatter {:.1f} us of at most {:.0f}", us(delay.median),
                       us(delay.mad), us(device_.max_stamp_spread()));
  }

  bool check_light() {
    light_.permit(true);
    acquisition_.self_test();
    return wait("light") && good("light", "goes on and off, dark is dark");
  }

  void take(CapturedBurst& b) {
    ledger_.emit(b.session);
    const std::lock_guard lock(mutex_);
    ++seen_.bursts;
    seen_.ambient_dn = std::max(seen_.ambient_dn, b.burst.ambient_dn);
    const double full = std::exp2(hw_.camera.mode().bit_depth) / 256;
    for (const FrameLevels& level : b.pixels.levels) {
      seen_.mean_dn += level.mean_dn / full / 4;
      if (level.count > 0)
        seen_.saturated += static_cast<double>(level.saturated) / static_cast<double>(level.count) / 4;
    }
    for (const LitFrame& f : b.burst.frames) {
      const Nanoseconds exposure{std::int64_t{f.frame.exposure_us} * 1000};
      seen_.least_margin = std::min({seen_.least_margin, f.t_rise - f.t_strobe, f.t_strobe + exposure - f.t_fall});
    }
    if (seen_.first || b.pixels.bytes.empty()) return;
    const CameraMode mode = hw_.camera.mode();
    seen_.first = CheckPicture{mode.width, mode.height, mode.bit_depth, std::move(b.pixels.bytes)};
  }

  bool check_bursts() {
    const auto wanted = static_cast<std::uint64_t>(config_.bursts);
    light_.permit(true);
    acquisition_.scan(kSession, wanted);
    if (!wait("bursts")) return false;
    const BurstCounts counts = ledger_.counts();
    std::string found = fmt::format("{} of {} whole", counts.emitted, wanted);
    for (std::size_t i = 0; i < counts.dropped.size(); ++i) {
      if (counts.dropped[i] == 0) continue;
      found += fmt::format(", {} {}", counts.dropped[i], name_of(static_cast<proto::DropReason>(i)));
    }
    const std::lock_guard lock(mutex_);
    if (seen_.bursts > 0) found += fmt::format(", patterns at least {:.1f} us inside", us(seen_.least_margin));
    report_.picture = std::move(seen_.first);
    if (counts.emitted >= wanted) return good("bursts", found);
    return bad("bursts", ErrorCode::kBoardTiming, found + ": triggers, edges or frames are lost; docs/probe.md");
  }

  bool check_picture() {
    const std::lock_guard lock(mutex_);
    const auto n = static_cast<double>(seen_.bursts);
    const double mean = seen_.mean_dn / n, saturated = seen_.saturated / n;
    const std::string found = fmt::format("mean {:.0f} of 255, {:.1f} % saturated, dark frames up to {:.1f}", mean,
                                          100 * saturated, seen_.ambient_dn);
    if (mean < config_.least_mean_dn) {
      return bad("picture", ErrorCode::kProjector, found + ": too dark; hold something white 10 to 15 mm off the tip");
    }
    if (saturated > config_.most_saturated) {
      return bad("picture", ErrorCode::kProjector, found + ": too bright; lower projector.led_code or camera.gain");
    }
    return good("picture", found);
  }

  Device& device_;
  Clock& clock_;
  const CheckConfig& config_;
  Hardware hw_;
  CheckReport report_;
  std::mutex mutex_;  ///< of seen_
  Seen seen_;
  BurstLedger ledger_;
  LightSwitch light_;
  Acquisition acquisition_;  ///< last: stops before what it feeds
};

}  // namespace

bool CheckReport::good() const noexcept {
  return std::none_of(findings.begin(), findings.end(), [](const CheckFinding& f) { return f.fault.has_value(); });
}

CheckReport check_device(Device& device, Clock& clock, const CheckConfig& config) {
  return DeviceCheck(device, clock, config).run();
}

std::string pgm_of(const CheckPicture& p) {
  const std::size_t pixel = bytes_per_pixel(p.bit_depth), row = static_cast<std::size_t>(p.width) * pixel;
  std::string out = fmt::format("P5\n{} {}\n{}\n", 4 * p.width, p.height, (1 << p.bit_depth) - 1);
  out.reserve(out.size() + p.bytes.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(p.height); ++y) {
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t at = (k * static_cast<std::size_t>(p.height) + y) * row;
      for (std::size_t i = 0; i < row; i += pixel) {
        // PGM is big endian.
        if (pixel == 2) out.push_back(static_cast<char>(p.bytes[at + i + 1]));
        out.push_back(static_cast<char>(p.bytes[at + i]));
      }
    }
  }
  return out;
}

}  // namespace enamel::fw
