#include "firmware/device/linux/dlpc350/dlpc350.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "firmware/device/linux/projector/waiting.hpp"
#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

using namespace dlpc350;
using Bytes = std::vector<std::uint8_t>;

constexpr Nanoseconds kBoot{3'000'000'000}, kModeChange{1'000'000'000}, kValidation{1'000'000'000};
constexpr Nanoseconds kImageLoads{2'000'000'000};          // two images out of flash, up to 200 ms each
constexpr std::uint32_t kLeastIllum = 8333, kBlack = 230;  // us
constexpr double kTick = 0.1072;                           // us, of the trigger input's delay
constexpr std::int64_t kMostTicks = 0x7FFFF;
constexpr std::uint8_t kPatterns = 4, kImageCount = 2;

/// An entry of the pattern table. Byte 0: trigger, pattern number; byte 1: bits, LEDs; byte 2: black behind it, and
/// whether another image begins.
constexpr std::uint8_t kRisingEdge = 1, kEightBits = 8, kBlackBehind = 2, kSwap = 4;
constexpr std::array<std::uint8_t, kPatterns> kChannel{0, 1, 2, 0};  // green, red, blue of one image, green of the next

void put(Bytes& to, std::uint32_t v) {
  for (unsigned i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>((v >> (8 * i)) & 0xFFU));
}

std::int64_t ticks(std::uint32_t us) { return std::lround(us / kTick); }

/// By bit of the validation's answer.
constexpr std::array<const char*, 7> kInvalid{
    "exposure or period that it cannot show",
    "pattern numbers that it does not know",
    "TRIG_OUT_1 without an end, or black that overlaps",
    "no black before a triggered pattern",
    "less than 230 us between exposure and period",
    "bit 5, which is not documented",
    "bit 6, which is not documented",
};
constexpr unsigned kInvalidTiming = (1U << 0U) | (1U << 4U);

}  // namespace

std::vector<std::string> dlpc350_timing_faults(const PatternTiming& t) {
  std::vector<std::string> faults;
  if (t.bits != kEightBits) faults.push_back(fmt::format("patterns of {} bits, but its table is for 8", t.bits));
  if (t.illum_us < kLeastIllum) {
    faults.push_back(fmt::format("8 bits take {} us, but a pattern is lit {} us", kLeastIllum, t.illum_us));
  }
  if (t.post_us < kBlack) {
    faults.push_back(fmt::format("black behind a pattern takes {} us, but post_us is {}", kBlack, t.post_us));
  }
  if (ticks(t.pre_us) > kMostTicks) {
    faults.push_back(fmt::format("a trigger is delayed by {:.0f} us at most, but pre_us is {}",
                                 static_cast<double>(kMostTicks) * kTick, t.pre_us));
  }
  return faults;
}

Result<std::uint8_t> Dlpc350::byte(const Command& command) {
  ENAMEL_TRY_ASSIGN(const Bytes answer, channel_.read(command, 1));
  return answer[0];
}

Result<Dlpc350> Dlpc350::open(HidPort& port, Clock& clock, const ProjectorLimits& limits, std::uint8_t image) {
  if (limits.max_led_code > kDlpc350MostLedCode) {
    return fail(ErrorCode::kConfigValue, fmt::format("ceiling {} of the LED current, a DLPC350 has {}",
                                                     limits.max_led_code, kDlpc350MostLedCode));
  }
  Dlpc350 projector(port, clock, limits, image);
  ENAMEL_TRY(projector.prepare());
  return projector;
}

/// It comes up with its LEDs under the table's control, perhaps with a sequence of its own: off before anything else.
Result<void> Dlpc350::go_dark() {
  is_valid_ = false;
  ENAMEL_TRY(channel_.write(kLedEnable, Bytes{0}));
  ENAMEL_TRY(channel_.write(kSequence, Bytes{kStop}));
  ENAMEL_TRY(wait_until(*clock_, kBoot, "not initialised", [&]() -> Result<bool> {
    ENAMEL_TRY_ASSIGN(const std::uint8_t hardware, byte(kHardwareStatus));
    return (hardware & kInitialised) != 0;
  }));
  ENAMEL_TRY(channel_.write(kLedPolarity, Bytes{0}));
  ENAMEL_TRY_ASSIGN(const std::uint8_t polarity, byte(kLedPolarity));
  if (polarity != 0)
    return projector_refused("its LED polarity stays inverted: a current's code would mean its opposite");
  return write_currents(0);
}

/// The only place that writes a current.
Result<void> Dlpc350::write_currents(std::uint16_t code) {
  if (code > limits_.max_led_code) {
    return fail(ErrorCode::kConfigValue, fmt::format("LED current {}, at most {}", code, limits_.max_led_code));
  }
  Bytes currents;
  for (const std::uint8_t led : {kRedLed, kGreenLed, kBlueLed}) {
    currents.push_back(static_cast<std::uint8_t>(kDlpc350MostLedCode - ((limits_.leds & led) != 0 ? code : 0U)));
  }
  ENAMEL_TRY(channel_.write(kLedCurrent, currents));
  ENAMEL_TRY_ASSIGN(Bytes kept, channel_.read(kLedCurrent, currents.size()));
  kept.resize(currents.size());
  if (kept != currents) return projector_refused("it does not keep the LED current: the light stays off");
  return {};
}

Result<void> Dlpc350::write_mailbox(std::uint8_t mailbox, std::span<const std::uint8_t> data) {
  ENAMEL_TRY(channel_.write(kMailbox, Bytes{mailbox}));
  ENAMEL_TRY(channel_.write(kMailboxAddress, Bytes{0}));
  ENAMEL_TRY(channel_.write(kMailboxData, data));
  return channel_.write(kMailbox, Bytes{kCloseMailbox});
}

/// TRIG_OUT_1 is high while a pattern is lit, TRIG_OUT_2 says that a set begins: the other way round than a DLPC347x.
Result<void> Dlpc350::write_triggers(const PatternTiming& timing) {
  ENAMEL_TRY(channel_.write(kTriggerMode, Bytes{1}));
  ENAMEL_TRY(channel_.write(kTriggerOut1, Bytes{0, kUndelayed, kUndelayed}));
  ENAMEL_TRY(channel_.write(kTriggerOut2, Bytes{0, kUndelayed}));
  Bytes delay;
  put(delay, static_cast<std::uint32_t>(ticks(timing.pre_us)));
  return channel_.write(kTriggerInDelay, delay);
}

Result<void> Dlpc350::write_table(const PatternTiming& timing) {
  const std::uint8_t repeat = 1;
  ENAMEL_TRY(channel_.write(kTableConfig, Bytes{kPatterns - 1, repeat, kPatterns - 1, kImageCount - 1}));
  Bytes times;
  put(times, timing.illum_us);
  put(times, timing.illum_us + timing.post_us);
  ENAMEL_TRY(channel_.write(kExposure, times));
  Bytes table;
  for (std::size_t k = 0; k < kPatterns; ++k) {
    const bool begins_image = k == 0 || kChannel[k] <= kChannel[k - 1];
    table.push_back(static_cast<std::uint8_t>(kRisingEdge | (kChannel[k] << 2U)));
    table.push_back(static_cast<std::uint8_t>(kEightBits | (limits_.leds << 4U)));
    table.push_back(begins_image ? kBlackBehind | kSwap : kBlackBehind);
  }
  ENAMEL_TRY(write_mailbox(kTable, table));
  // Two images stay in its two buffers, and their indices are written in reverse: so does TI's own program.
  return write_mailbox(kImages, Bytes{static_cast<std::uint8_t>(image_ + 1), image_});
}

Result<void> Dlpc350::validate() {
  ENAMEL_TRY(channel_.write(kValidate, Bytes{0}));
  unsigned said = 0;
  ENAMEL_TRY(wait_until(*clock_, kValidation, "sequence still being validated", [&]() -> Result<bool> {
    ENAMEL_TRY_ASSIGN(said, byte(kValidate));
    return (said & kValidating) == 0;
  }));
  if (said == 0) return {};
  std::vector<std::string> faults;
  for (std::size_t bit = 0; bit < kInvalid.size(); ++bit) {
    if (((said >> bit) & 1U) != 0) faults.emplace_back(kInvalid[bit]);
  }
  return fail((said & kInvalidTiming) != 0 ? ErrorCode::kBoardTiming : ErrorCode::kProjector,
              fmt::format("projector: it finds its sequence invalid: {}", fmt::join(faults, "; ")));
}

Result<void> Dlpc350::set_up(const PatternTiming& timing) {
  is_valid_ = false;
  if (const auto faults = dlpc350_timing_faults(timing); !faults.empty()) {
    return fail(ErrorCode::kBoardTiming, fmt::format("projector: {}", fmt::join(faults, "; ")));
  }
  ENAMEL_TRY(channel_.write(kSequence, Bytes{kStop}));
  ENAMEL_TRY(channel_.write(kDisplayMode, Bytes{1}));
  ENAMEL_TRY(wait_until(*clock_, kModeChange, "not in its pattern mode", [&]() -> Result<bool> {
    ENAMEL_TRY_ASSIGN(const std::uint8_t mode, byte(kDisplayMode));
    return mode == 1;
  }));
  const std::uint8_t flash = 3;
  ENAMEL_TRY(channel_.write(kPatternSource, Bytes{flash}));
  ENAMEL_TRY(write_triggers(timing));
  ENAMEL_TRY(write_table(timing));
  ENAMEL_TRY(validate());
  is_valid_ = true;
  return {};
}

Result<void> Dlpc350::run() {
  if (!is_valid_) return projector_refused("its sequence is not validated: arm it first");
  ENAMEL_TRY(channel_.write(kSequence, Bytes{kStart}));
  return wait_until(*clock_, kImageLoads, "pattern sequence does not run", [&]() -> Result<bool> {
    ENAMEL_TRY_ASSIGN(const PatternStatus now, pattern_status());
    return now.ready;
  });
}

Result<void> Dlpc350::light(std::uint16_t code) {
  ENAMEL_TRY(write_currents(code));
  return channel_.write(kLedEnable, Bytes{code > 0 ? kLedsAsTable : std::uint8_t{0}});
}

Result<void> Dlpc350::or_dark(Result<void> done) {
  if (!done) blank();
  return done;
}

Result<void> Dlpc350::prepare() { return or_dark(go_dark()); }
Result<void> Dlpc350::arm(const PatternTiming& timing) { return or_dark(set_up(timing)); }
Result<void> Dlpc350::start() { return or_dark(run()); }
Result<void> Dlpc350::stop() { return or_dark(channel_.write(kSequence, Bytes{kStop})); }
Result<void> Dlpc350::set_led(std::uint16_t code) { return or_dark(light(code)); }

void Dlpc350::blank() noexcept {
  if (auto off = channel_.write(kLedEnable, Bytes{0}); !off) log::error("projector", "{}", off.error().message());
}

Result<ControllerStatus> Dlpc350::status() {
  ENAMEL_TRY_ASSIGN(const unsigned hardware, byte(kHardwareStatus));
  ENAMEL_TRY_ASSIGN(const unsigned system, byte(kSystemStatus));
  ENAMEL_TRY_ASSIGN(const Bytes version, channel_.read(kVersion, 4));
  ControllerStatus s;
  s.type = "DLPC350";
  s.version = fmt::format("{}.{}.{}", version[3], version[2], version[0] | (unsigned{version[1]} << 8U));
  s.initialised = (hardware & kInitialised) != 0;
  s.system_error = (hardware & kMirrorError) != 0 || (system & kMemoryGood) == 0;
  s.sequence_error = (hardware & (kSequenceError | kForcedSwap)) != 0;
  s.sequence_abort = (hardware & kSequenceAbort) != 0;
  return s;
}

Result<PatternStatus> Dlpc350::pattern_status() {
  ENAMEL_TRY_ASSIGN(const unsigned now, byte(kMainStatus));
  return PatternStatus{(now & kSequenceRuns) != 0 && (now & kParked) == 0, std::nullopt};
}

}  // namespace enamel::fw
