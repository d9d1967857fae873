// Commands that are used, as CMD2.CMD3. TI DLPU010; what was confirmed by a second source: docs/probe.md.
#pragma once

#include <cstdint>

namespace enamel::fw::dlpc350 {

struct Command {
  std::uint8_t cmd2 = 0;
  std::uint8_t cmd3 = 0;
  const char* name = "";
};

inline constexpr Command kVersion{0x02, 0x05, "version"};  ///< four times u16 patch, u8 minor, u8 major
/// Red, green, blue, u8 each. A LightCrafter 4500 inverts it: 255 is dark, also with normal polarity.
inline constexpr Command kLedCurrent{0x0B, 0x01, "LED current"};
inline constexpr Command kLedPolarity{0x1A, 0x05, "LED polarity"};  ///< 0 normal
inline constexpr Command kLedEnable{0x1A, 0x07, "LED enable"};      ///< bits red, green, blue; bit 3: as the table says
inline constexpr Command kHardwareStatus{0x1A, 0x0A, "hardware status"};
inline constexpr Command kSystemStatus{0x1A, 0x0B, "system status"};
inline constexpr Command kMainStatus{0x1A, 0x0C, "main status"};
inline constexpr Command kValidate{0x1A, 0x1A, "validate"};                ///< write, then read until bit 7 is 0
inline constexpr Command kDisplayMode{0x1A, 0x1B, "display mode"};         ///< 0 video, 1 patterns
inline constexpr Command kTriggerOut1{0x1A, 0x1D, "trigger out 1"};        ///< bit 0 invert; rise, fall in 107.2 ns
inline constexpr Command kTriggerOut2{0x1A, 0x1E, "trigger out 2"};        ///< bit 0 invert; rise
inline constexpr Command kPatternSource{0x1A, 0x22, "pattern source"};     ///< 0 video port, 3 flash
inline constexpr Command kTriggerMode{0x1A, 0x23, "trigger mode"};         ///< 1: each pattern as the table says
inline constexpr Command kSequence{0x1A, 0x24, "pattern sequence"};        ///< 0 stop, 1 pause, 2 start
inline constexpr Command kExposure{0x1A, 0x29, "exposure and period"};     ///< u32 us, u32 us
inline constexpr Command kTableConfig{0x1A, 0x31, "table configuration"};  ///< entries, repeat, per TRIG_OUT_2, images
inline constexpr Command kMailboxAddress{0x1A, 0x32, "mailbox address"};
inline constexpr Command kMailbox{0x1A, 0x33, "mailbox"};  ///< 0 close, 1 image indices, 2 pattern table
inline constexpr Command kMailboxData{0x1A, 0x34, "mailbox data"};
inline constexpr Command kTriggerInDelay{0x1A, 0x35, "trigger in delay"};  ///< u32, 107.2 ns

inline constexpr std::uint8_t kLedsAsTable = 8;                            ///< of kLedEnable
inline constexpr std::uint8_t kStop = 0, kStart = 2;                       ///< of kSequence
inline constexpr std::uint8_t kCloseMailbox = 0, kImages = 1, kTable = 2;  ///< of kMailbox
inline constexpr std::uint8_t kUndelayed = 0xBB;                           ///< edge of a trigger out: 0 us

// Bits of the hardware status.
inline constexpr unsigned kInitialised = 1U << 0U, kMirrorError = 1U << 2U, kForcedSwap = 1U << 3U,
                          kSequenceAbort = 1U << 6U, kSequenceError = 1U << 7U;
inline constexpr unsigned kMemoryGood = 1U << 0U;                        ///< of the system status
inline constexpr unsigned kParked = 1U << 0U, kSequenceRuns = 1U << 1U;  ///< of the main status
inline constexpr unsigned kValidating = 1U << 7U;                        ///< of kValidate's answer

}  // namespace enamel::fw::dlpc350
