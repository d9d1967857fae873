// boot_model FILE: boots from every flash of a file of boot_cases, several power cycles each, and prints what was
// chosen and what the control block became. The decision is the bootloader's own code; only this file reads files and
// prints.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "firmware/boot/policy.hpp"
#include "firmware/boot/slot_image.hpp"
#include "tests/arm64/boot_case.hpp"

namespace {

using namespace enamel;
using namespace enamel::fw;

using Bytes = std::span<const std::byte>;

/// Memory of which only the control blocks can be written.
class CaseFlash final : public Flash {
 public:
  CaseFlash(Bytes control, const std::array<Bytes, kSlots>& slots) : slots_(slots) {
    for (std::size_t i = 0; i < 2; ++i) std::copy_n(control.data() + i * kControlSize, kControlSize, copies_[i].data());
  }
  std::uint64_t size() const noexcept override { return flash_map::kSize; }
  FlashStatus read(std::uint64_t offset, std::span<std::byte> out) const noexcept override {
    std::fill(out.begin(), out.end(), std::byte{0xFF});
    for (std::size_t i = 0; i < 2; ++i) overlay(offset, out, i * kEraseBlock, copies_[i]);
    for (std::size_t i = 0; i < kSlots; ++i) {
      const std::uint64_t start = flash_map::kSlot + i * flash_map::kSlotSize;
      const std::size_t manifest = std::min<std::size_t>(image::kManifestStep, slots_[i].size());
      overlay(offset, out, start, slots_[i].first(manifest));
      overlay(offset, out, start + flash_map::kManifestArea, slots_[i].subspan(manifest));
    }
    return FlashStatus::kOk;
  }
  FlashStatus erase(std::uint64_t offset) noexcept override {
    if (offset / kEraseBlock >= 2) return FlashStatus::kOutside;
    copies_[offset / kEraseBlock].fill(std::byte{0xFF});
    return FlashStatus::kOk;
  }
  FlashStatus program(std::uint64_t offset, Bytes bytes) noexcept override {
    if (offset / kEraseBlock >= 2 || bytes.size() > kControlSize) return FlashStatus::kOutside;
    std::copy(bytes.begin(), bytes.end(), copies_[offset / kEraseBlock].begin());
    return FlashStatus::kOk;
  }
  [[nodiscard]] Sha256Digest control_digest() const {
    return RollingHash().update(copies_[0]).update(copies_[1]).digest();
  }

 private:
  static void overlay(std::uint64_t offset, std::span<std::byte> out, std::uint64_t start, Bytes content) noexcept {
    const std::uint64_t from = std::max(offset, start), to = std::min(offset + out.size(), start + content.size());
    if (from < to) std::copy_n(content.data() + (from - start), to - from, out.data() + (from - offset));
  }

  std::array<ControlBytes, 2> copies_{};
  std::array<Bytes, kSlots> slots_;
};

class Judge final : public SlotJudge {
 public:
  Judge(CaseFlash& flash, const image::Trust& trust) : flash_(&flash), trust_(trust) {}
  bool verifies(std::size_t slot) noexcept override {
    static SlotWorkspace workspace;
    return check_slot(boot_regions(*flash_).slot[slot], test::model_hardware(), trust_, workspace).has_value();
  }

 private:
  CaseFlash* flash_;
  image::Trust trust_;
};

struct Cases {
  std::vector<image::TrustedKey> keys;
  Bytes answers;
  std::vector<Bytes> contents;
  ByteReader rest{Bytes()};
};

Cases read_cases(Bytes file) {
  Cases cases;
  ByteReader in(file);
  for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
    image::TrustedKey& key = cases.keys.emplace_back();
    const Bytes bytes = in.take(key.key.size());
    std::transform(bytes.begin(), bytes.end(), key.key.begin(),
                   [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    key.development = in.get<std::uint8_t>() == 1;
  }
  cases.answers = in.take(in.get<std::uint32_t>() * std::size_t{32 + 64 + 32 + 1});
  for (auto n = in.get<std::uint32_t>(); n > 0; --n) cases.contents.push_back(in.take(in.get<std::uint32_t>()));
  cases.rest = in;
  return cases;
}

/// A line a power cycle.
void run_case(std::uint32_t number, CaseFlash& flash, const image::Trust& trust, RollingHash& all) {
  for (int cycle = 0; cycle < test::kPowerCycles; ++cycle) {
    ControlStore store(boot_regions(flash).control);
    Judge judge(flash, trust);
    const std::optional<std::size_t> slot = choose_slot(store, judge);
    const Sha256Digest control = flash.control_digest();
    char line[80];
    const int n = std::snprintf(line, sizeof line, "case %u, boot %d: %s, control %02x%02x%02x%02x\n",
                                static_cast<unsigned>(number), cycle,
                                !slot        ? "recovery"
                                : *slot == 0 ? "A"
                                             : "B",
                                control[0], control[1], control[2], control[3]);
    std::fputs(line, stdout);
    all.update(std::string_view(line, static_cast<std::size_t>(n))).update(std::as_bytes(std::span(control)));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ifstream in(argv[1], std::ios::binary);
  const std::vector<char> file((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  Cases cases = read_cases(std::as_bytes(std::span(file)));
  const image::Trust trust{cases.keys, 0, false, &test::model_ed25519(cases.answers)};
  RollingHash all;
  const auto count = cases.rest.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && cases.rest.ok(); ++i) {
    const Bytes control = cases.rest.take(2 * kControlSize);
    const std::size_t a = cases.rest.get<std::uint8_t>(), b = cases.rest.get<std::uint8_t>();
    if (!cases.rest.ok() || a >= cases.contents.size() || b >= cases.contents.size()) return 1;
    CaseFlash flash(control, {cases.contents[a], cases.contents[b]});
    run_case(i, flash, trust, all);
  }
  const Sha256Digest digest = all.digest();
  std::printf("%u cases, digest ", static_cast<unsigned>(count));
  for (const std::uint8_t byte : digest) std::printf("%02x", byte);
  std::printf("\n");
  return cases.rest.ok() && count > 0 ? 0 : 1;
}
