// Any text as configuration (TOML), its first line as a setting over it: every kind of key is read within its range or
// refused by name, and what comes out is a configuration that is read again to the same.
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "protocol/base/config.hpp"
#include "tests/fuzz/demand.hpp"

namespace {

using namespace enamel;
using test::demand;

enum class Mode : std::uint8_t { kFast, kExact };
constexpr std::array<std::pair<std::string_view, Mode>, 2> kModes{{{"fast", Mode::kFast}, {"exact", Mode::kExact}}};

struct Values {
  std::uint64_t seed = 7;
  int count = 3;
  double step_mm = 0.1;
  bool enabled = true;
  std::string name = "plain";
  std::vector<double> knots = {1, 2};
  std::array<double, 3> offset = {0, 0, 1};
  std::vector<std::string> tags;
  Mode mode = Mode::kFast;
  std::vector<double> radii;
};

Values bind(ConfigReader& r) {
  Values v;
  r.bind("seed", v.seed, "");
  r.bind("count", v.count, {1, 10}, "");
  r.bind("grid.step_mm", v.step_mm, {0.0, 1.0}, "");
  r.bind("grid.enabled", v.enabled, "");
  r.bind("name", v.name, "");
  r.bind("knots", v.knots, {0.0, 9.0}, "");
  r.bind("offset", v.offset, {-5.0, 5.0}, "");
  r.bind("tags", v.tags, "");
  r.bind("mode", v.mode, kModes, "");
  for (std::size_t i = 0; i < r.table_count("ball"); ++i) {
    double radius = 1;
    ConfigReader ball = r.table("ball", i);
    ball.bind("radius", radius, {0.1, 2.0}, "");
    v.radii.push_back(radius);
  }
  return v;
}

void demand_within(const Values& v) {
  demand(v.count >= 1 && v.count <= 10, "counts keep to their range");
  demand(v.step_mm >= 0 && v.step_mm <= 1, "lengths keep to their range");
  for (const double x : v.knots) demand(x >= 0 && x <= 9, "every element keeps to the range");
  for (const double x : v.offset) demand(std::isfinite(x), "numbers are finite");
  for (const double x : v.radii) demand(x >= 0.1 && x <= 2, "so do those of tables");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  auto reader = ConfigReader::from_text(text, "any");
  if (!reader) return 0;
  static_cast<void>(reader->set(text.substr(0, text.find('\n'))));
  const Values values = bind(*reader);
  if (!reader->finish()) return 0;
  demand_within(values);
  const std::string resolved = reader->dump();
  auto again = ConfigReader::from_text(resolved, "resolved");
  demand(again.has_value(), "what is written is read");
  bind(*again);
  demand(again->finish().has_value() && again->dump() == resolved, "and stays as it is");
  return 0;
}
