// enamel calibrate target coded: target.json of a board whose dots identify themselves.
#include <cstdio>
#include <memory>
#include <string>

#include "calib/target/code_map.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "protocol/base/file.hpp"

namespace enamel::app {
namespace {

struct CodedOptions {
  int cols = 40, rows = 40;
  double pitch_mm = 1.6, radius_mm = 0.4, ring_inner_mm = 0.2;
  std::uint64_t seed = 1;
  std::string out;
};

Result<int> run_coded(const CodedOptions& o) {
  ENAMEL_TRY_ASSIGN(const calib::CodeMap map, calib::make_code_map(o.cols, o.rows, o.seed));
  ENAMEL_TRY_ASSIGN(const std::string text, calib::coded_target_text(map, o.pitch_mm, o.radius_mm, o.ring_inner_mm));
  ENAMEL_TRY(write_file(o.out, text));
  std::printf("%s: %d x %d dots, %.1f x %.1f mm\n", o.out.c_str(), o.cols, o.rows, o.cols * o.pitch_mm,
              o.rows * o.pitch_mm);
  return 0;
}

}  // namespace

CalibrateCommand add_calibrate_target(CLI::App& app) {
  auto o = std::make_shared<CodedOptions>();
  CLI::App* target = app.add_subcommand("target", "target.json of a board to print");
  CLI::App* coded = target->add_subcommand("coded", "dots and rings that say which they are");
  target->require_subcommand(1);
  coded->add_option("--cols", o->cols, "dots a row")->capture_default_str();
  coded->add_option("--rows", o->rows, "rows")->capture_default_str();
  coded->add_option("--pitch-mm", o->pitch_mm, "between two dots")->capture_default_str();
  coded->add_option("--radius-mm", o->radius_mm, "of dots and rings")->capture_default_str();
  coded->add_option("--ring-inner-mm", o->ring_inner_mm, "of the rings' holes")->capture_default_str();
  coded->add_option("--seed", o->seed, "of the map: one seed, one board")->capture_default_str();
  coded->add_option("--out", o->out, "target.json to write")->required();
  return {target, [o] { return run_coded(*o); }};
}

}  // namespace enamel::app
