// Maps of a board whose dots identify themselves: a field of bits in which every 4 x 4 window, in any of its four
// turns, occurs once. A mirrored window may occur: a board is not seen from behind.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/target/target.hpp"
#include "protocol/base/result.hpp"

namespace enamel::calib {

struct CodeMap {
  int cols = 0, rows = 0;
  std::vector<std::uint8_t> bits;  ///< row major

  [[nodiscard]] std::uint8_t at(int col, int row) const {
    return bits[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col)];
  }
};

/// Error: kTargetFile naming two windows that are alike, or a map smaller than a window.
[[nodiscard]] Result<void> check_code_map(const CodeMap& map);

/// A map drawn from `seed`: the same arguments, the same map. Sides from 4 dots on; at most half of the 65536 codes may
/// be needed, 4 (cols - 3) (rows - 3) <= 32768. Error: kTargetFile with the limit.
[[nodiscard]] Result<CodeMap> make_code_map(int cols, int rows, std::uint64_t seed);

/// target.json of such a board, white on dark, lengths in mm. Error: kTargetFile, as parse_target has it.
[[nodiscard]] Result<std::string> coded_target_text(const CodeMap& map, double pitch_mm, double radius_mm,
                                                    double ring_inner_mm);

}  // namespace enamel::calib
