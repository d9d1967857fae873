// Poses into a calibration folder that appears whole or not at all.
#pragma once

#include <optional>
#include <string>

#include "calib/io/calib_folder.hpp"

namespace enamel::calib {

/// Not thread-safe. Without commit() nothing is left behind.
class PoseWriter {
 public:
  /// Begins `folder` beside its place. Errors: kUsage when it exists and is not empty, kFileWrite.
  [[nodiscard]] static Result<PoseWriter> begin(const std::string& folder);
  PoseWriter(PoseWriter&& other) noexcept;
  PoseWriter& operator=(PoseWriter&&) = delete;
  ~PoseWriter();

  /// poses/NN in the order of writing, as 8- or 16-bit grey PNG. Errors: kFileWrite.
  [[nodiscard]] Result<void> write(const PoseFrames& frames, int bits);
  /// Adds rig.json (the probe's text with "nominal": true and the number of averaged frames and the
  /// temperature) and target.json, then puts
  /// the folder in its place. Errors: kFileWrite, kRigInvalid.
  [[nodiscard]] Result<void> commit(const Rig& nominal, const std::string& target_text, int averaged_frames,
                                    std::optional<double> temp_c);
  /// Where the folder lies until commit().
  [[nodiscard]] const std::string& partial() const { return partial_; }
  [[nodiscard]] int written() const { return written_; }

 private:
  explicit PoseWriter(std::string folder) : folder_(std::move(folder)), partial_(folder_ + ".partial") {}
  std::string folder_, partial_;
  int written_ = 0;
  bool is_done_ = false;
};

}  // namespace enamel::calib
