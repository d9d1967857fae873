// The model as the screen last showed it, in a file beside the recording: after a crash it is on the screen again
// before the recording has been worked through.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "pipeline/types/preview.hpp"
#include "protocol/base/result.hpp"
#include "protocol/base/time.hpp"

namespace enamel::host {

/// Beside a session's recording. Gone when the scan has ended and its results are there.
[[nodiscard]] std::string checkpoint_path(const std::string& session_folder);

/// What a checkpoint keeps of a preview: the model's blocks, and where the probe was last in it.
struct ModelCheckpoint {
  std::shared_ptr<const ModelSnapshot> model;
  Pose T_model_cam = Pose::Identity();
};

/// layout: what a checkpoint begins with.
inline constexpr std::string_view kCheckpointMagic = "enamel-checkpoint-2\n";

/// Little endian, with a CRC-32 of all that comes before it.
[[nodiscard]] std::string checkpoint_bytes(const ModelCheckpoint& checkpoint);
/// Errors: kMeshInvalid (damaged, another format).
[[nodiscard]] Result<ModelCheckpoint> parse_checkpoint(std::string_view bytes);

/// As the screen takes it. Burst and track stay unknown: the probe may be anywhere by now.
[[nodiscard]] std::shared_ptr<const BurstPreview> as_preview(const ModelCheckpoint& checkpoint);

/// Writes the newest that it was offered, on a thread of its own. A disk that takes none is told once; the scan needs
/// no checkpoint.
class CheckpointWriter {
 public:
  CheckpointWriter(std::string path, Nanoseconds period);
  CheckpointWriter(const CheckpointWriter&) = delete;
  CheckpointWriter& operator=(const CheckpointWriter&) = delete;
  ~CheckpointWriter();

  /// From any thread; copies no surface.
  void offer(const BurstPreview& shown);

 private:
  void run(const std::stop_token& stop);

  std::string path_;
  Nanoseconds period_;
  std::mutex mutex_;  // guards newest_
  std::condition_variable_any tick_;
  ModelCheckpoint newest_;
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace enamel::host
