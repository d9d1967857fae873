#include "firmware/device/linux/dlpc347x/dlpc347x.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>

#include "firmware/device/linux/dlpc347x/opcodes.hpp"
#include "firmware/device/linux/projector/waiting.hpp"
#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

using namespace dlpc;
using Bytes = std::vector<std::uint8_t>;

constexpr Nanoseconds kBoot{3'000'000'000}, kReady{500'000'000}, kErase{30'000'000'000};
constexpr std::size_t kWriteBlock = 1024, kReadBlock = 256;
constexpr std::uint8_t kInternal = 1;  // of validate: which mode is asked for

std::uint32_t u32(std::span<const std::uint8_t> b, std::size_t i) {
  return b[i] | (std::uint32_t{b[i + 1]} << 8U) | (std::uint32_t{b[i + 2]} << 16U) | (std::uint32_t{b[i + 3]} << 24U);
}
void put(Bytes& to, std::uint32_t v, int bytes) {
  for (int i = 0; i < bytes; ++i) to.push_back(static_cast<std::uint8_t>((v >> (8 * i)) & 0xFFU));
}

const char* type_of(std::uint8_t id) {
  switch (id) {
    case 0x0F:
      return "DLPC3470";
    case 0x0B:
      return "DLPC3478";
    case 0x0C:
      return "DLPC3479";
    default:
      return nullptr;
  }
}

/// As the controller numbers its sequences; nullopt for a depth that it has none for.
std::optional<std::uint8_t> sequence_type(int bits) {
  switch (bits) {
    case 1:
      return std::uint8_t{0};
    case 8:
      return std::uint8_t{2};
    case 4:
    case 5:
    case 6:
      return static_cast<std::uint8_t>(bits);
    default:
      return std::nullopt;
  }
}

Bytes three_leds(std::uint16_t code, std::uint8_t leds) {
  Bytes b;
  for (const std::uint8_t led : {kRedLed, kGreenLed, kBlueLed}) put(b, (leds & led) != 0 ? code : 0U, 2);
  return b;
}

}  // namespace

Result<void> Dlpc347x::write(std::uint8_t opcode, std::span<const std::uint8_t> payload) {
  Bytes message{opcode};
  message.insert(message.end(), payload.begin(), payload.end());
  return bus_->write(message);
}

Result<Bytes> Dlpc347x::read(std::uint8_t opcode, std::span<const std::uint8_t> payload, std::size_t size) {
  Bytes message{opcode};
  message.insert(message.end(), payload.begin(), payload.end());
  Bytes answer(size);
  ENAMEL_TRY(bus_->write_read(message, answer));
  return answer;
}

Result<Dlpc347x> Dlpc347x::open(I2cBus& bus, Clock& clock, const ProjectorLimits& limits) {
  Dlpc347x projector(bus, clock, limits);
  ENAMEL_TRY(projector.prepare());
  return projector;
}

Result<void> Dlpc347x::prepare() {
  ENAMEL_TRY(wait_booted());
  ENAMEL_TRY_ASSIGN(const Bytes id, read(kReadController, {}, 1));
  if (type_of(id[0]) == nullptr) {
    return projector_refused(
        fmt::format("controller 0x{:02X} is no DLPC3470, 3478 or 3479; the profile names another type", id[0]));
  }
  ENAMEL_TRY(write(kWriteLedEnable, Bytes{0}));
  ENAMEL_TRY(limit_light());
  ENAMEL_TRY(write(kWriteBrightnessBoost, Bytes{0, 0}));
  ENAMEL_TRY(write(kWriteAdaptiveLight, Bytes{0, 31, 0}));
  ENAMEL_TRY(write(kWriteColourAdjustment, Bytes{0}));
  ENAMEL_TRY(write(kWriteLedControl, Bytes{0}));
  ENAMEL_TRY_ASSIGN(const Bytes control, read(kReadLedControl, {}, 1));
  if (control[0] != 0)
    return projector_refused("it keeps the LEDs under its own control: fringes would change with their content");
  return {};
}

Result<void> Dlpc347x::wait_booted() {
  unsigned last = 0;
  auto booted = wait_until(*clock_, kBoot, "not ready", [&]() -> Result<bool> {
    const auto status = read(kReadShortStatus, {}, 1);
    if (!status) return false;  // it does not answer while it boots
    last = (*status)[0];
    return (last & kInitialised) != 0;
  });
  if (!booted) {
    ENAMEL_TRY(read(kReadShortStatus, {}, 1));  // no answer at all: the bus says why
    return booted;
  }
  if ((last & kMainApplication) == 0)
    return projector_refused("its boot loader runs: its software must be written again");
  return {};
}

/// The ceiling is in the controller before any LED is on, so that no later mistake can pass it.
Result<void> Dlpc347x::limit_light() {
  const Bytes ceiling = three_leds(limits_.max_led_code, limits_.leds);
  ENAMEL_TRY(write(kWriteLedMaxCurrent, ceiling));
  ENAMEL_TRY_ASSIGN(const Bytes kept, read(kReadLedMaxCurrent, {}, ceiling.size()));
  if (kept != ceiling) return projector_refused("it does not keep the LED current's ceiling: the light stays off");
  return {};
}

Result<void> Dlpc347x::validate(const PatternTiming& timing) {
  const auto type = sequence_type(timing.bits);
  if (!type) return fail(ErrorCode::kBoardTiming, fmt::format("projector: no sequence of {} bits", timing.bits));
  Bytes ask{kInternal, *type};
  put(ask, timing.illum_us, 4);
  ENAMEL_TRY_ASSIGN(const Bytes answer, read(kReadValidateExposure, ask, 13));
  const std::uint32_t least = u32(answer, 1), pre = u32(answer, 5), post = u32(answer, 9);
  if ((answer[0] & 1U) != 0 && timing.illum_us >= least && timing.pre_us >= pre && timing.post_us >= post) return {};
  return fail(
      ErrorCode::kBoardTiming,
      fmt::format("projector: {} bits in {} us, {} us before, {} us after are not possible; it needs {}, {} and {}",
                  timing.bits, timing.illum_us, timing.pre_us, timing.post_us, least, pre, post));
}

Result<void> Dlpc347x::wait_erased() {
  return wait_until(*clock_, kErase, "flash still being erased", [&]() -> Result<bool> {
    ENAMEL_TRY_ASSIGN(const Bytes status, read(kReadShortStatus, {}, 1));
    if ((status[0] & kFlashError) != 0) return projector_refused("its flash cannot be erased");
    return (status[0] & kEraseBusy) == 0;
  });
}

Result<void> Dlpc347x::load(std::span<const std::uint8_t> block) {
  Bytes size;
  put(size, static_cast<std::uint32_t>(block.size()), 4);
  ENAMEL_TRY_ASSIGN(const Bytes precheck, read(kReadFlashPrecheck, size, 1));
  if (precheck[0] != 0)
    return projector_refused(fmt::format("{} bytes of patterns do not fit its flash", block.size()));
  ENAMEL_TRY(write(kWriteFlashType, Bytes{kSensingPatterns}));
  ENAMEL_TRY(write(kWriteFlashErase, Bytes{0xAA, 0xBB, 0xCC, 0xDD}));
  ENAMEL_TRY(wait_erased());
  const auto in_pieces = [&](std::size_t most, const auto& move) -> Result<void> {
    std::size_t length = 0;
    for (std::size_t at = 0; at < block.size(); at += length) {
      const std::size_t piece = std::min(most, block.size() - at);
      if (piece != length) {
        Bytes told;
        put(told, static_cast<std::uint32_t>(piece), 2);
        ENAMEL_TRY(write(kWriteFlashLength, told));
      }
      length = piece;
      ENAMEL_TRY(move(at, piece));
    }
    return {};
  };
  ENAMEL_TRY(in_pieces(kWriteBlock, [&](std::size_t at, std::size_t n) {
    return write(at == 0 ? kWriteFlashStart : kWriteFlashContinue, block.subspan(at, n));
  }));
  return in_pieces(kReadBlock, [&](std::size_t at, std::size_t n) -> Result<void> {
    ENAMEL_TRY_ASSIGN(const Bytes kept, read(at == 0 ? kReadFlashStart : kReadFlashContinue, {}, n));
    if (std::equal(kept.begin(), kept.end(), block.begin() + static_cast<std::ptrdiff_t>(at))) return {};
    return projector_refused(fmt::format("its flash holds other patterns than were written, from byte {} on", at));
  });
}

Result<void> Dlpc347x::arm(const PatternTiming& timing) {
  ENAMEL_TRY(validate(timing));
  const std::uint8_t enabled_high = 3;
  ENAMEL_TRY(write(kWriteTriggerIn, Bytes{enabled_high}));
  for (const std::uint8_t which : {std::uint8_t{0}, std::uint8_t{1}}) {
    Bytes out{static_cast<std::uint8_t>(which | 2U)};
    put(out, 0, 4);
    ENAMEL_TRY(write(kWriteTriggerOut, out));
  }
  ENAMEL_TRY(write(kWritePatternReady, Bytes{enabled_high}));
  Bytes entry(24, 0);
  entry[0] = kReloadFromFlash;
  ENAMEL_TRY(write(kWriteOrderEntry, entry));
  ENAMEL_TRY(write(kWriteMode, Bytes{kModeInternalPatterns}));
  ENAMEL_TRY(wait_until(*clock_, kReady, "not ready for a trigger", [&]() -> Result<bool> {
    ENAMEL_TRY_ASSIGN(const PatternStatus now, pattern_status());
    return now.ready;
  }));
  ENAMEL_TRY_ASSIGN(const ControllerStatus now, status());
  if (now.sequence_error) return projector_refused("it has no sequence for these patterns");
  return {};
}

Result<void> Dlpc347x::start() { return write(kWritePatternControl, Bytes{0, kForever}); }
Result<void> Dlpc347x::stop() { return write(kWritePatternControl, Bytes{1, 0}); }

Result<void> Dlpc347x::set_led(std::uint16_t code) {
  if (code > limits_.max_led_code) {
    return fail(ErrorCode::kConfigValue, fmt::format("LED current {}, at most {}", code, limits_.max_led_code));
  }
  ENAMEL_TRY(write(kWriteLedCurrent, three_leds(code, limits_.leds)));
  return write(kWriteLedEnable, Bytes{code > 0 ? limits_.leds : std::uint8_t{0}});
}

void Dlpc347x::blank() noexcept {
  if (auto off = write(kWriteLedEnable, Bytes{0}); !off) log::error("projector", "{}", off.error().message());
}

Result<ControllerStatus> Dlpc347x::status() {
  ENAMEL_TRY_ASSIGN(const Bytes brief, read(kReadShortStatus, {}, 1));
  ENAMEL_TRY_ASSIGN(const Bytes system, read(kReadSystemStatus, {}, 4));
  ENAMEL_TRY_ASSIGN(const Bytes version, read(kReadVersion, {}, 4));
  ENAMEL_TRY_ASSIGN(const Bytes id, read(kReadController, {}, 1));
  ENAMEL_TRY_ASSIGN(const Bytes heat, read(kReadTemperature, {}, 2));
  ControllerStatus s;
  s.type = type_of(id[0]) != nullptr ? type_of(id[0]) : fmt::format("0x{:02X}", id[0]);
  s.version = fmt::format("{}.{}.{}", version[3], version[2], version[0] | (unsigned{version[1]} << 8U));
  s.celsius = 0.1 * (heat[0] | (unsigned{heat[1]} << 8U));
  s.initialised = (brief[0] & kInitialised) != 0;
  s.system_error = (brief[0] & kSystemError) != 0 || (system[0] & 7U) != 0;
  s.sequence_error = (brief[0] & kSequenceError) != 0 || (system[2] & 2U) != 0 || (system[2] >> 3U) != 0;
  s.sequence_abort = (system[2] & 1U) != 0;
  s.led_errors = static_cast<std::uint8_t>((system[1] >> 3U) & 7U);
  s.watchdog = (system[3] & (1U << 5U)) != 0;
  return s;
}

Result<PatternStatus> Dlpc347x::pattern_status() {
  ENAMEL_TRY_ASSIGN(const Bytes s, read(kReadPatternStatus, {}, 7));
  return PatternStatus{s[0] != 0, s[5]};
}

}  // namespace enamel::fw
