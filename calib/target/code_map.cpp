#include "calib/target/code_map.hpp"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "protocol/base/json_text.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::calib {
namespace {

constexpr int kWindow = 4;
constexpr int kCodes = 1 << (kWindow * kWindow);
constexpr std::uint32_t kMapStream = 0xC0DE;  // of the random numbers
constexpr int kMaxFillSteps = 50'000'000;

/// The four readings of the window whose lower right corner is (col, row).
std::array<int, 4> codes_at(const CodeMap& map, int col, int row) {
  std::array<int, 4> codes{};
  for (int y = 0; y < kWindow; ++y) {
    for (int x = 0; x < kWindow; ++x) {
      const int bit = map.at(col - kWindow + 1 + x, row - kWindow + 1 + y);
      int u = x, v = y;
      for (int& code : codes) {
        code |= bit << (v * kWindow + u);
        const int turned = kWindow - 1 - v;
        v = u;
        u = turned;
      }
    }
  }
  return codes;
}

bool is_distinct(const std::array<int, 4>& c) {
  return c[0] != c[1] && c[0] != c[2] && c[0] != c[3] && c[1] != c[2] && c[1] != c[3] && c[2] != c[3];
}

/// Fills a map cell by cell and takes back what leads nowhere.
class Filler {
 public:
  Filler(int cols, int rows, std::uint64_t seed)
      : map_{cols, rows, std::vector<std::uint8_t>(static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows))},
        used_(kCodes),
        tried_(map_.bits.size()),
        rng_(seed, 0, kMapStream) {}

  [[nodiscard]] bool fill() {
    std::size_t cell = 0;
    for (int step = 0; cell < map_.bits.size(); ++step) {
      if (step == kMaxFillSteps) return false;
      if (advance(cell)) {
        ++cell;
        continue;
      }
      tried_[cell] = 0;
      if (cell == 0) return false;
      release(--cell);
    }
    return true;
  }

  [[nodiscard]] CodeMap& map() { return map_; }

 private:
  bool has_window(std::size_t cell) const { return col(cell) >= kWindow - 1 && row(cell) >= kWindow - 1; }
  int col(std::size_t cell) const { return static_cast<int>(cell % static_cast<std::size_t>(map_.cols)); }
  int row(std::size_t cell) const { return static_cast<int>(cell / static_cast<std::size_t>(map_.cols)); }

  void release(std::size_t cell) {
    if (!has_window(cell)) return;
    for (const int code : codes_at(map_, col(cell), row(cell))) used_[static_cast<std::size_t>(code)] = false;
  }

  /// The next value of a cell that fits: `tried_` counts those tried.
  bool advance(std::size_t cell) {
    if (tried_[cell] == 0) map_.bits[cell] = static_cast<std::uint8_t>(rng_.below(2) ^ 1U);
    while (tried_[cell] < 2) {
      ++tried_[cell];
      map_.bits[cell] ^= 1U;
      if (!has_window(cell)) return true;
      const auto codes = codes_at(map_, col(cell), row(cell));
      bool is_free = is_distinct(codes);
      for (const int code : codes) is_free = is_free && !used_[static_cast<std::size_t>(code)];
      if (!is_free) continue;
      for (const int code : codes) used_[static_cast<std::size_t>(code)] = true;
      return true;
    }
    return false;
  }

  CodeMap map_;
  std::vector<bool> used_;
  std::vector<int> tried_;
  Rng rng_;
};

}  // namespace

Result<void> check_code_map(const CodeMap& map) {
  if (map.cols < kWindow || map.rows < kWindow)
    return fail(ErrorCode::kTargetFile, "a coded board has at least 4 x 4 dots: a window of that size tells its place");
  std::vector<int> owner(kCodes, -1);
  for (int row = kWindow - 1; row < map.rows; ++row) {
    for (int col = kWindow - 1; col < map.cols; ++col) {
      for (const int code : codes_at(map, col, row)) {
        int& first = owner[static_cast<std::size_t>(code)];
        if (first >= 0) {
          return fail(
              ErrorCode::kTargetFile,
              fmt::format("key 'rings': the 4 x 4 windows that end at column {}, row {} and at column {}, row {} "
                          "are alike in some turn; make the board with `enamel calibrate target coded`",
                          first % map.cols, first / map.cols, col, row));
        }
        first = row * map.cols + col;
      }
    }
  }
  return {};
}

Result<CodeMap> make_code_map(int cols, int rows, std::uint64_t seed) {
  constexpr int kMaxSide = 200;
  if (cols < kWindow || rows < kWindow || cols > kMaxSide || rows > kMaxSide ||
      8 * (cols - kWindow + 1) * (rows - kWindow + 1) > kCodes) {
    return fail(ErrorCode::kTargetFile,
                fmt::format("{} x {} dots: a coded board has from 4 x 4 to about 93 x 93 dots, 4 (cols - 3)(rows - 3) "
                            "at most 32768; make a smaller one",
                            cols, rows));
  }
  Filler filler(cols, rows, seed);
  if (!filler.fill())
    return fail(ErrorCode::kTargetFile, "no map of this size found from this seed; take another --seed");
  return std::move(filler.map());
}

Result<std::string> coded_target_text(const CodeMap& map, double pitch_mm, double radius_mm, double ring_inner_mm) {
  nlohmann::ordered_json json{{"type", "coded_dots"},      {"cols", map.cols},       {"rows", map.rows},
                              {"pitch_mm", pitch_mm},      {"radius_mm", radius_mm}, {"ring_inner_mm", ring_inner_mm},
                              {"circles", "white on dark"}};
  for (int row = 0; row < map.rows; ++row) {
    std::string bits;
    for (int col = 0; col < map.cols; ++col) bits += map.at(col, row) != 0 ? '1' : '0';
    json["rings"].push_back(bits);
  }
  std::string text = json_text(json, 1) + "\n";
  ENAMEL_TRY(parse_target(text));
  return text;
}

}  // namespace enamel::calib
