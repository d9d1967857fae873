#include "firmware/device/linux/libcamera/runtime.hpp"

#include <cstdlib>
#include <cstring>
#include <mutex>

#include "firmware/device/linux/libcamera/camera_list.hpp"

namespace enamel::fw {

Result<std::shared_ptr<CameraRuntime>> CameraRuntime::get() {
  static std::mutex mutex;
  static std::weak_ptr<CameraRuntime> known;
  const std::lock_guard lock(mutex);
  if (auto runtime = known.lock()) return runtime;
  // Its log goes to stderr, among our own messages; who looks for a fault in it sets the variable.
  static_cast<void>(::setenv("LIBCAMERA_LOG_LEVELS", "*:ERROR", 0));
  std::shared_ptr<CameraRuntime> runtime(new CameraRuntime);
  if (const int error = runtime->manager_.start(); error != 0) {
    return fail(ErrorCode::kCamera, std::string("libcamera does not start: ") + std::strerror(-error));
  }
  runtime->started_ = true;
  known = runtime;
  return runtime;
}

CameraRuntime::~CameraRuntime() {
  if (started_) manager_.stop();
}

Result<std::shared_ptr<libcamera::Camera>> CameraRuntime::find(const std::string& name) const {
  const auto all = cameras();
  std::vector<std::shared_ptr<libcamera::Camera>> fits;
  std::string known;
  for (const auto& camera : all) {
    known += (known.empty() ? "" : ", ") + camera->id();
    if (camera->id() == name) return camera;
    if (name == "any" || model_of(*camera) == name) fits.push_back(camera);
  }
  if (fits.size() == 1) return fits.front();
  if (all.empty()) return fail(ErrorCode::kCamera, "no camera: " + why_no_camera());
  if (fits.empty()) return fail(ErrorCode::kCamera, "no camera '" + name + "'; there is " + known);
  return fail(ErrorCode::kCamera,
              "'" + name + "' is " + std::to_string(fits.size()) + " cameras; name one of " + known);
}

std::vector<std::string> modes_of(const libcamera::StreamConfiguration& stream) {
  std::vector<std::string> modes;
  for (const libcamera::PixelFormat& format : stream.formats().pixelformats()) {
    for (const libcamera::Size& size : stream.formats().sizes(format)) {
      modes.push_back(format.toString() + " " + size.toString());
    }
  }
  return modes;
}

std::string model_of(const libcamera::Camera& camera) {
  return camera.properties().get(libcamera::properties::Model).value_or("");
}

}  // namespace enamel::fw
