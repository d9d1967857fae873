#include "tests/support/procam_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "calib/io/calib_folder.hpp"
#include "calib/solve/board_view.hpp"
#include "protocol/base/file.hpp"

namespace enamel::test {
namespace {

constexpr int kBits = 10, kStep = 2;  // every second picture is the positive one, columns first
constexpr int kWhite = 40, kBlack = 41;
constexpr float kMinContrast_dn = 20;

struct Window {
  int x = 0, y = 0;
};

Result<Map<float>> crop(const std::string& pose, int picture) {
  return calib::load_grey(fmt::format("{}/crop_{:02d}.png", pose, picture));
}

/// Gray code, most significant bit first, in the camera's whole frame.
Result<calib::CoordinateMap> decode(const std::string& pose, int first, Window at, int width, int height) {
  ENAMEL_TRY_ASSIGN(const Map<float> white, crop(pose, kWhite));
  ENAMEL_TRY_ASSIGN(const Map<float> black, crop(pose, kBlack));
  Map<int> code(white.width(), white.height()), last(white.width(), white.height());
  for (int bit = 0; bit < kBits; ++bit) {
    ENAMEL_TRY_ASSIGN(const Map<float> image, crop(pose, first + kStep * bit));
    for (std::size_t i = 0; i < code.size(); ++i) {
      last[i] ^= image[i] > 0.5F * (white[i] + black[i]) ? 1 : 0;
      code[i] = 2 * code[i] + last[i];
    }
  }
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  calib::CoordinateMap out{Map<float>(width, height, kNone), Map<float>(width, height, 1.0F / 12)};
  for (int v = 0; v < white.height(); ++v) {
    for (int u = 0; u < white.width(); ++u) {
      if (white(u, v) - black(u, v) >= kMinContrast_dn)
        out.value_px(at.x + u, at.y + v) = static_cast<float>(code(u, v));
    }
  }
  return out;
}

calib::LensValues lens(int width, int height, double f) {
  return {width, height, f, f, 0.5 * (width - 1), 0.5 * (height - 1), {}};
}

}  // namespace

Result<ProcamSet> load_procam(const std::string& folder) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(folder + "/crops.json"));
  const auto json = nlohmann::json::parse(text);
  const int width = json["image_size"][0], height = json["image_size"][1];
  ProcamSet set;
  set.board.type = calib::TargetType::kChessboard;
  set.board.cols = json["chessboard_inner_corners"][0];
  set.board.rows = json["chessboard_inner_corners"][1];
  set.board.pitch_mm = json["square"];
  set.nominal.camera = lens(width, height, 3000);
  set.nominal.projector = lens(json["projector_size"][0], json["projector_size"][1], 2000);
  for (std::size_t i = 0; i < 4; ++i) set.nominal.T_proj_cam[i][i] = 1;
  for (const auto& entry : json["poses"]) {
    const std::string name = "pose" + std::to_string(entry["pose"].get<int>()), pose = folder + "/" + name;
    const Window at{entry["crop_x0"], entry["crop_y0"]};
    ENAMEL_TRY_ASSIGN(const Map<float> white, calib::load_grey(pose + "/white_full.png", width, height));
    const auto corners = calib::find_chessboard(white, set.board);
    if (!corners) {
      set.rejected.push_back(name);
      continue;
    }
    ENAMEL_TRY_ASSIGN(const auto u, decode(pose, 0, at, width, height));
    ENAMEL_TRY_ASSIGN(const auto v, decode(pose, kStep * kBits, at, width, height));
    set.views.push_back(calib::board_view(name, *corners, set.board, u, v));
  }
  return set;
}

}  // namespace enamel::test
