// Progress of several probes on stderr: on a terminal one row a probe that is drawn over, else one line a step.
#pragma once

#include <string>
#include <vector>

#include "host/update/flash_flow.hpp"

namespace enamel::flash_app {

/// Not thread-safe: one caller at a time.
class ProgressLines {
 public:
  explicit ProgressLines(const std::vector<update::PortInfo>& probes);

  void tell(const update::PortInfo& probe, const update::FlashProgress& progress);
  /// A line of its own, above the rows.
  void note(const std::string& text);

 private:
  struct Row {
    update::PortInfo probe;
    int percent = -1;
    update::Step step = update::Step::kPreflight;
    int seconds_left = 0;
  };
  [[nodiscard]] static std::string text(const Row& row);
  /// All rows, over those that stand there already.
  void draw();

  std::vector<Row> rows_;
  bool terminal_;
  bool drawn_ = false;
};

}  // namespace enamel::flash_app
