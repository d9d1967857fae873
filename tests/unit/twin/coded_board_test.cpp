// Boards whose dots tell where they are, and the plate with the ball bar.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "protocol/base/file.hpp"
#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/board/target_file.hpp"
#include "tools/twin/surface/ring_plate.hpp"

namespace enamel::twin::testing {
namespace {

const std::string kTarget = std::string(ENAMEL_SOURCE_DIR) + "/config/targets/coded_board.json";

DotBoardConfig coded_board() {
  DotBoardConfig board;
  const auto read = read_target(kTarget, board);
  EXPECT_TRUE(read) << read.error().message();
  return board;
}

/// How many windows of 4 x 4, in any of four turns, look like another or like their own turn.
int doubles(const std::vector<std::string>& rings) {
  std::map<unsigned, int> seen;
  for (std::size_t r = 0; r + 4 <= rings.size(); ++r) {
    for (std::size_t c = 0; c + 4 <= rings[0].size(); ++c) {
      std::array<unsigned, 4> code{};
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
          const unsigned bit = rings[r + i][c + j] == '1' ? 1U : 0U;
          code[0] |= bit << (4 * i + j);
          code[1] |= bit << (4 * j + 3 - i);
          code[2] |= bit << (15 - 4 * i - j);
          code[3] |= bit << (4 * (3 - j) + i);
        }
      }
      for (const unsigned each : code) ++seen[each];
    }
  }
  int out = 0;
  for (const auto& [code, count] : seen) out += count - 1;
  return out;
}

TEST(CodedBoard, every_window_of_the_shipped_board_is_unique_in_all_turns) {
  const DotBoardConfig board = coded_board();
  EXPECT_EQ(board.cols, 40);
  EXPECT_EQ(board.rows, 40);
  EXPECT_EQ(doubles(board.rings), 0);
  EXPECT_GT(board.half_width_mm() * 2, 60) << "larger than the field of 18 mm";
}

TEST(CodedBoard, the_test_of_uniqueness_sees_a_copied_and_a_turned_window) {
  std::vector<std::string> copied = coded_board().rings, turned = copied;
  for (std::size_t i = 0; i < 4; ++i) {
    copied[20 + i].replace(17, 4, copied[3 + i].substr(30, 4));
    for (std::size_t j = 0; j < 4; ++j) turned[20 + i][17 + j] = coded_board().rings[3 + j][30 + 3 - i];
  }
  EXPECT_GE(doubles(copied), 4);
  EXPECT_GE(doubles(turned), 4);
}

TEST(CodedBoard, a_ring_has_a_hole_of_the_grounds_colour) {
  DotBoardConfig board;
  board.cols = board.rows = 3;
  board.pitch_mm = 2;
  board.radius_mm = 0.5;
  board.ring_inner_mm = 0.2;
  board.rings = {"000", "001", "000"};
  const DotPrint print = *make_dot_board(board, 1).print;
  const auto at = [&](double x, double y) { return print.albedo({x, y, 0}); };
  EXPECT_EQ(at(2, 0), print.ground_albedo);
  EXPECT_EQ(at(2.2 - 1e-9, 0), print.ground_albedo);
  EXPECT_EQ(at(2.2 + 1e-9, 0), print.dot_albedo);
  EXPECT_EQ(at(2.5 + 1e-9, 0), print.ground_albedo);
  EXPECT_EQ(at(0, 0), print.dot_albedo);
  EXPECT_EQ(at(-2, 0), print.dot_albedo) << "no mirror";
  EXPECT_EQ(at(0, 2), print.dot_albedo) << "rows run along y";
}

TEST(CodedBoard, target_json_says_what_was_read) {
  const DotBoardConfig board = coded_board();
  EXPECT_EQ(nlohmann::json::parse(target_json(board)), nlohmann::json::parse(*read_file(kTarget)));
  const auto plain = nlohmann::json::parse(target_json(DotBoardConfig{}));
  EXPECT_EQ(plain["type"], "circle_grid");
  EXPECT_FALSE(plain.contains("rings"));
}

void target_refused(const std::string& key, const nlohmann::json& value) {
  nlohmann::json json = {{"type", "coded_dots"},
                         {"cols", 4},
                         {"rows", 3},
                         {"pitch_mm", 1.6},
                         {"radius_mm", 0.4},
                         {"ring_inner_mm", 0.2},
                         {"rings", {"0101", "1100", "0011"}}};
  DotBoardConfig board;
  ASSERT_TRUE(parse_target(json.dump(), "t.json", board));
  json[key] = value;
  DotBoardConfig kept;
  const auto read = parse_target(json.dump(), "t.json", kept);
  ASSERT_FALSE(read) << key << " " << value;
  EXPECT_EQ(read.error().code, ErrorCode::kTargetFile);
  EXPECT_NE(read.error().detail.find("t.json: key '" + key + "'"), std::string::npos) << read.error().detail;
  EXPECT_EQ(kept.cols, DotBoardConfig{}.cols) << "nothing is taken of a bad file";
}

TEST(CodedBoard, faults_of_a_target_name_file_and_key) {
  target_refused("type", "chessboard");
  target_refused("type", 3);
  target_refused("cols", 4.5);
  target_refused("cols", 1000);
  target_refused("rows", "3");
  target_refused("pitch_mm", -1);
  target_refused("radius_mm", 0.9);
  target_refused("ring_inner_mm", 0.4);
  target_refused("ring_inner_mm", nullptr);
  target_refused("rings", "0101");
  target_refused("rings", nlohmann::json::array({"0101", "1100"}));
  target_refused("rings", {"0101", "1100", "001"});
  target_refused("rings", {"0101", "1102", "0011"});
  target_refused("rings", {"0101", 7, "0011"});
  target_refused("circles", "dark on white");
  target_refused("marks", nlohmann::json::array());
  DotBoardConfig board;
  EXPECT_EQ(parse_target("[1", "t.json", board).error().code, ErrorCode::kTargetFile);
  EXPECT_EQ(read_target("/nowhere/t.json", board).error().code, ErrorCode::kFileNotFound);
}

TEST(RingPlate, has_its_bar_where_it_is_certified_and_bumps_beside_it) {
  const RingPlateConfig config;
  double squares = 0;
  constexpr int kSeeds = 50;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const RingPlate plate = make_ring_plate(config, seed);
    const auto& balls = plate.surroundings.balls;
    ASSERT_GT(balls.size(), 100U);
    EXPECT_NEAR((balls[0].centre - balls[1].centre).norm(), 54, 1e-12);
    for (std::size_t i = 2; i < balls.size(); ++i) {
      for (std::size_t j = 0; j < 2; ++j)
        EXPECT_GT((balls[i].centre - balls[j].centre).norm(), balls[i].radius + balls[j].radius);
      const double r = balls[i].centre.head<2>().norm();
      EXPECT_TRUE(r >= config.inner_mm && r <= config.outer_mm) << r;
    }
    const auto certificate = nlohmann::json::parse(plate.certificate_json);
    squares += std::pow(double(certificate["distances_mm"][0][2]) - 54, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / kSeeds), 0.0025, 5 * 0.0025 / std::sqrt(2.0 * kSeeds));
  EXPECT_NE(make_ring_plate(config, 1).surroundings.balls[2].centre,
            make_ring_plate(config, 2).surroundings.balls[2].centre);
}

}  // namespace
}  // namespace enamel::twin::testing
