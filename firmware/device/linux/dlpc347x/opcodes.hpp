// Opcodes that are used. Writes carry a payload; reads send theirs, then fetch the answer.
#pragma once

#include <cstdint>

namespace enamel::fw::dlpc {

inline constexpr std::uint8_t kWriteMode = 0x05;        ///< operating mode
inline constexpr std::uint8_t kWriteLedControl = 0x50;  ///< 0 by hand, 1 by content
inline constexpr std::uint8_t kReadLedControl = 0x51;
inline constexpr std::uint8_t kWriteLedEnable = 0x52;      ///< bits red, green, blue
inline constexpr std::uint8_t kWriteLedCurrent = 0x54;     ///< three u16
inline constexpr std::uint8_t kWriteLedMaxCurrent = 0x5C;  ///< three u16
inline constexpr std::uint8_t kReadLedMaxCurrent = 0x5D;
inline constexpr std::uint8_t kWriteBrightnessBoost = 0x80;   ///< LABB: control and sharpness, strength
inline constexpr std::uint8_t kWriteAdaptiveLight = 0x84;     ///< CAIC: display bits, gain in 1/31, clipping in 1/63
inline constexpr std::uint8_t kWriteColourAdjustment = 0x86;  ///< CCA
inline constexpr std::uint8_t kWriteTriggerIn = 0x90;         ///< bit 0 enable, bit 1 active high
inline constexpr std::uint8_t kWriteTriggerOut = 0x92;       ///< bit 0 which, bit 1 enable, bit 2 invert; i32 delay, us
inline constexpr std::uint8_t kWritePatternReady = 0x94;     ///< bit 0 enable, bit 1 active high
inline constexpr std::uint8_t kWriteOrderEntry = 0x98;       ///< control byte, entry of 23 bytes
inline constexpr std::uint8_t kReadValidateExposure = 0x9D;  ///< mode, sequence type, u32 us
inline constexpr std::uint8_t kWritePatternControl = 0x9E;   ///< 0 start, 1 stop …; repeats
inline constexpr std::uint8_t kReadPatternStatus = 0x9F;
inline constexpr std::uint8_t kReadShortStatus = 0xD0;
inline constexpr std::uint8_t kReadSystemStatus = 0xD1;
inline constexpr std::uint8_t kReadVersion = 0xD2;        ///< u16 patch, minor, major
inline constexpr std::uint8_t kReadCommunication = 0xD3;  ///< send 2: flags, aborted opcode
inline constexpr std::uint8_t kReadController = 0xD4;
inline constexpr std::uint8_t kReadTemperature = 0xD6;    ///< u16, 0.1 degC
inline constexpr std::uint8_t kReadFlashPrecheck = 0xDD;  ///< u32 bytes
inline constexpr std::uint8_t kWriteFlashType = 0xDE;
inline constexpr std::uint8_t kWriteFlashLength = 0xDF;  ///< u16: of each following block
inline constexpr std::uint8_t kWriteFlashErase = 0xE0;   ///< AA BB CC DD
inline constexpr std::uint8_t kWriteFlashStart = 0xE1;
inline constexpr std::uint8_t kWriteFlashContinue = 0xE2;
inline constexpr std::uint8_t kReadFlashStart = 0xE3;
inline constexpr std::uint8_t kReadFlashContinue = 0xE4;

inline constexpr std::uint8_t kModeInternalPatterns = 4;
inline constexpr std::uint8_t kReloadFromFlash = 2;     ///< of kWriteOrderEntry
inline constexpr std::uint8_t kSensingPatterns = 0xD0;  ///< of kWriteFlashType
inline constexpr std::uint8_t kForever = 0xFF;

// Bits of the short status.
inline constexpr unsigned kInitialised = 1U << 0U, kSystemError = 1U << 3U, kEraseBusy = 1U << 4U,
                          kFlashError = 1U << 5U, kSequenceError = 1U << 6U, kMainApplication = 1U << 7U;

}  // namespace enamel::fw::dlpc
