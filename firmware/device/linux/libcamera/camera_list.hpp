// `enamel-probe --camera list`.
#pragma once

#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::fw {

struct ListedCamera {
  std::string id;
  std::string model;
  std::vector<std::string> modes;  ///< "R8 640x480": format of libcamera, size
  std::vector<std::string> controls;
};

/// Cameras that libcamera drives here. Errors: kCamera when it does not start. Empty: see why_no_camera().
[[nodiscard]] Result<std::vector<ListedCamera>> list_cameras();

/// There is one camera of this id or model. Errors: kCamera, with those there are or why there is none.
[[nodiscard]] Result<void> find_camera(const std::string& name);

/// What the system lacks for a camera to be there, in a sentence with a remedy. Looks below `dev` and `sys`.
[[nodiscard]] std::string why_no_camera(const std::string& dev = "/dev", const std::string& sys = "/sys");

}  // namespace enamel::fw
