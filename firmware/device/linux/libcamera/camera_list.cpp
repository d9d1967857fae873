#include "firmware/device/linux/libcamera/camera_list.hpp"

#include <libcamera/libcamera.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "firmware/device/linux/libcamera/runtime.hpp"

namespace enamel::fw {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> nodes(const std::string& folder, const std::string& prefix) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().filename().string().starts_with(prefix)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

Result<std::vector<ListedCamera>> list_cameras() {
  ENAMEL_TRY_ASSIGN(const auto runtime, CameraRuntime::get());
  std::vector<ListedCamera> list;
  for (const auto& camera : runtime->cameras()) {
    ListedCamera listed{camera->id(), model_of(*camera), {}, {}};
    // Formats can be asked for without acquiring: a camera in use is listed as well.
    if (const auto config = camera->generateConfiguration({libcamera::StreamRole::Raw}); config && !config->empty()) {
      listed.modes = modes_of(config->at(0));
    }
    for (const auto& [id, info] : camera->controls()) listed.controls.push_back(id->name());
    std::sort(listed.controls.begin(), listed.controls.end());
    list.push_back(std::move(listed));
  }
  return list;
}

Result<void> find_camera(const std::string& name) {
  ENAMEL_TRY_ASSIGN(const auto runtime, CameraRuntime::get());
  ENAMEL_TRY(runtime->find(name));
  return {};
}

std::string why_no_camera(const std::string& dev, const std::string& sys) {
  const auto video = nodes(dev, "video"), media = nodes(dev, "media");
  for (const auto* group : {&media, &video}) {
    for (const fs::path& node : *group) {
      if (::access(node.c_str(), R_OK | W_OK) == 0) continue;
      if (errno == EPERM)
        return node.string() + " is denied by the service's sandbox: its unit needs DeviceAllow for it";
      return "no permission on " + node.string() + "; add the user to the groups video and render, or run as root";
    }
  }
  if (video.empty() && media.empty()) {
    return fs::exists(sys + "/class/video4linux")
               ? "the kernel knows no video device: is the sensor in the device tree (overlay), is its cable seated? "
                 "`dmesg | grep -iE 'ov92|imx|csi'` tells what its driver met"
               : "this kernel has no video support (CONFIG_VIDEO_DEV), or its modules are not loaded";
  }
  if (media.empty()) {
    return "there is " + video.front().string() +
           " but no /dev/media*: libcamera needs the media controller; load the driver of the camera's receiver";
  }
  return "there are " + std::to_string(video.size()) + " video and " + std::to_string(media.size()) +
         " media devices, but none that libcamera has a pipeline for: is udevd running, is libcamera-ipa installed? "
         "LIBCAMERA_LOG_LEVELS=*:DEBUG says more";
}

}  // namespace enamel::fw
