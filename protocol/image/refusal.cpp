#include "protocol/image/refusal.hpp"

namespace enamel::image {

RefusalText describe_refusal(std::uint32_t number) noexcept {
  switch (number) {
#define ENAMEL_REFUSAL(name, code, status, what, cause, remedy) \
  case code:                                                    \
    return {#name, what, cause, remedy};
#include "protocol/image/refusals.def"
#undef ENAMEL_REFUSAL
    default:
      return {};
  }
}

int exit_code(Refusal why) noexcept {
  switch (why) {
    case Refusal::kMagic:
    case Refusal::kProduct:
    case Refusal::kHardware:
    case Refusal::kTruncated:
    case Refusal::kDfuSe:
    case Refusal::kSerial:
      return 5;
    case Refusal::kSignature:
    case Refusal::kKeyRevoked:
    case Refusal::kUnknownKey:
    case Refusal::kDevSigned:
    case Refusal::kUnsigned:
      return 6;
    case Refusal::kRollback:
      return 7;
    case Refusal::kFlashWrite:
    case Refusal::kIncomplete:
    case Refusal::kBattery:
    case Refusal::kBusyScanning:
      return 8;
    case Refusal::kChunkHash:
      return 9;
    case Refusal::kSelfTest:
    case Refusal::kNotConfirmed:
      return 10;
  }
  return 8;
}

}  // namespace enamel::image
