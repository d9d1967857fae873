#include "firmware/device/linux/dlpc347x/pattern_block.hpp"

#include <string>

namespace enamel::fw {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kBlockHeader = 20, kOrderEntry = 24, kSetHeader = 8, kWord = 4;
constexpr std::uint8_t kAlongRows = 0, kAlongColumns = 1;  // pattern's direction: horizontal lines, vertical lines

void put32(Bytes& to, std::uint32_t v) {
  for (unsigned i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>((v >> (8 * i)) & 0xFFU));
}

struct Line {
  int before = 0;
  int behind = 0;
  int pixels = 0;
  [[nodiscard]] std::uint32_t plane_bytes() const {
    const auto bits = static_cast<std::uint32_t>(before + pixels + behind);
    return (bits + 8 * kWord - 1) / (8 * kWord) * kWord;
  }
};

/// Eight-bit levels; of fewer bits the high ones.
void put_pattern(Bytes& to, const std::vector<std::uint8_t>& levels, const Line& line, int bits) {
  for (int plane = 0; plane < bits; ++plane) {
    const std::size_t begin = to.size();
    to.resize(begin + line.plane_bytes(), 0);
    const auto bit = static_cast<unsigned>(8 - bits + plane);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const std::size_t at = static_cast<std::size_t>(line.before) + i;
      const unsigned lit = (unsigned{levels[i]} >> bit) & 1U;
      to[begin + at / 8] = static_cast<std::uint8_t>(to[begin + at / 8] | (lit << (at % 8)));
    }
  }
}

}  // namespace

Result<Bytes> pattern_block(const calib::Rig& rig, const Dmd& dmd, const PatternTiming& timing, std::uint8_t leds) {
  if (rig.projector.width != dmd.width || rig.projector.height != dmd.height) {
    return fail(ErrorCode::kPatternSet, "the rig's projector has " + std::to_string(rig.projector.width) + "x" +
                                            std::to_string(rig.projector.height) + " pixels, a " +
                                            std::string(dmd.name) + " " + std::to_string(dmd.width) + "x" +
                                            std::to_string(dmd.height));
  }
  if (timing.bits < 1 || timing.bits > 8) {
    return fail(ErrorCode::kConfigValue, "patterns of " + std::to_string(timing.bits) + " bits, must be from 1 to 8");
  }
  const calib::PatternTable table = calib::pattern_table(rig);
  const Line line = table.axis_v ? Line{dmd.before_rows, 0, dmd.height} : Line{0, dmd.behind_columns, dmd.width};
  const auto count = static_cast<std::uint32_t>(table.frames.size());
  const std::uint32_t data = count * static_cast<std::uint32_t>(timing.bits) * line.plane_bytes();
  const std::uint32_t order = kWord + kOrderEntry, sets = 2 * kWord + kSetHeader + data;
  Bytes block{'P', 'A', 'T', 'N'};
  for (const std::uint32_t v : {kBlockHeader + order, sets, kBlockHeader, order}) put32(block, v);

  put32(block, 1);
  block.insert(block.end(), {0, static_cast<std::uint8_t>(count), leds, 0});
  for (const std::uint32_t v : {0U, 0U, timing.illum_us, timing.pre_us, timing.post_us}) put32(block, v);

  put32(block, 1);
  put32(block, kBlockHeader + order + 2 * kWord);  // where the set begins, from the block's begin
  block.insert(block.end(), {static_cast<std::uint8_t>(count), table.axis_v ? kAlongRows : kAlongColumns,
                             static_cast<std::uint8_t>(timing.bits), 0});
  put32(block, data);
  for (const auto& levels : table.frames) put_pattern(block, levels, line, timing.bits);
  return block;
}

}  // namespace enamel::fw
