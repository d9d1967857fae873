// Where rendered bursts go: a recording or an exchange folder, with the truth beside them.
#pragma once

#include <memory>
#include <string>

#include "protocol/base/result.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::twin {

class RenderSink {
 public:
  virtual ~RenderSink() = default;
  /// Where the axes stand at each burst, before the first one: axes.csv, and how many bursts see one pose.
  [[nodiscard]] virtual Result<void> axes(const std::string& table, int bursts_a_stop) = 0;
  [[nodiscard]] virtual Result<void> burst(const proto::Burst& burst) = 0;
  /// Extra file by relative path ("truth/poses.csv").
  [[nodiscard]] virtual Result<void> file(const std::string& name, const std::string& bytes) = 0;
  [[nodiscard]] virtual Result<void> finish() = 0;
};

/// A path that ends in .mcap makes a recording, any other a folder. Errors: kFileWrite.
[[nodiscard]] Result<std::unique_ptr<RenderSink>> open_sink(const std::string& path, const std::string& rig_text);

}  // namespace enamel::twin
