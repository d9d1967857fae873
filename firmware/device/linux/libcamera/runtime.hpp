// libcamera allows one camera manager a process; everything that has a camera keeps it alive.
#pragma once

#include <libcamera/libcamera.h>

#include <memory>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::fw {

class CameraRuntime {
 public:
  /// The process's one; started by the first who asks. Thread-safe. Errors: kCamera.
  [[nodiscard]] static Result<std::shared_ptr<CameraRuntime>> get();
  ~CameraRuntime();
  CameraRuntime(const CameraRuntime&) = delete;
  CameraRuntime& operator=(const CameraRuntime&) = delete;

  [[nodiscard]] std::vector<std::shared_ptr<libcamera::Camera>> cameras() const { return manager_.cameras(); }
  /// By id, by model, or the only one for "any". Errors: kCamera, with what there is.
  [[nodiscard]] Result<std::shared_ptr<libcamera::Camera>> find(const std::string& name) const;

 private:
  CameraRuntime() = default;
  libcamera::CameraManager manager_;
  bool started_ = false;
};

/// "R8 640x480", "R10 1280x800" …
[[nodiscard]] std::vector<std::string> modes_of(const libcamera::StreamConfiguration& stream);
[[nodiscard]] std::string model_of(const libcamera::Camera& camera);

}  // namespace enamel::fw
