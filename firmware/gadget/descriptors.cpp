#include "firmware/gadget/descriptors.hpp"

#include <linux/usb/functionfs.h>

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/update/usb_identity.hpp"

namespace enamel::fw {
namespace {

constexpr std::string_view kInterfaceName = "enamel firmware update";
constexpr std::uint16_t kEnglish = 0x0409;

/// Little endian, as USB has it.
class Bytes {
 public:
  void put8(std::uint32_t v) { bytes_.push_back(static_cast<std::byte>(v & 0xFFU)); }
  void put16(std::uint32_t v) {
    put8(v);
    put8(v >> 8U);
  }
  void put32(std::uint32_t v) {
    put16(v);
    put16(v >> 16U);
  }
  void put_text(std::string_view text) {
    for (const char c : text) put8(static_cast<std::uint8_t>(c));
    put8(0);
  }
  /// Its own length goes into the four bytes at `at`.
  [[nodiscard]] std::vector<std::byte> with_length_at(std::size_t at) && {
    for (unsigned i = 0; i < 4; ++i) bytes_[at + i] = static_cast<std::byte>((bytes_.size() >> 8U * i) & 0xFFU);
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
};

void put_interface(Bytes& out) {
  out.put8(USB_DT_INTERFACE_SIZE);
  out.put8(USB_DT_INTERFACE);
  out.put8(0);  // number; the gadget layer gives the real one
  out.put8(0);  // alternate setting
  out.put8(0);  // endpoints besides 0
  out.put8(USB_CLASS_APP_SPEC);
  out.put8(1);  // device firmware upgrade
  out.put8(2);  // DFU mode
  out.put8(1);  // name: first of function_strings()
}

}  // namespace

std::vector<std::byte> function_descriptors(const DfuConfig& config, Functional functional) {
  constexpr std::array kSpeeds = {FUNCTIONFS_HAS_FS_DESC, FUNCTIONFS_HAS_HS_DESC, FUNCTIONFS_HAS_SS_DESC};
  Bytes out;
  out.put32(FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  out.put32(0);
  out.put32(FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC | FUNCTIONFS_HAS_SS_DESC);
  for (std::size_t i = 0; i < kSpeeds.size(); ++i) out.put32(functional == Functional::kWith ? 2 : 1);
  for (std::size_t i = 0; i < kSpeeds.size(); ++i) {
    put_interface(out);
    if (functional == Functional::kWithout) continue;
    for (const std::uint8_t byte : dfu_functional_descriptor(config)) out.put8(byte);
  }
  return std::move(out).with_length_at(4);
}

std::vector<std::byte> function_strings() {
  Bytes out;
  out.put32(FUNCTIONFS_STRINGS_MAGIC);
  out.put32(0);
  out.put32(1);  // strings
  out.put32(1);  // languages
  out.put16(kEnglish);
  out.put_text(kInterfaceName);
  return std::move(out).with_length_at(4);
}

}  // namespace enamel::fw
