#include "firmware/app/camera_command.hpp"

#include <iostream>
#include <nlohmann/json.hpp>

#include "protocol/base/json_text.hpp"
#ifdef ENAMEL_HAS_LIBCAMERA
#include "firmware/device/linux/libcamera/camera_list.hpp"
#endif

namespace enamel::fw {
#ifdef ENAMEL_HAS_LIBCAMERA
namespace {

void print_json(const std::vector<ListedCamera>& list, const std::string& why) {
  nlohmann::ordered_json cameras = nlohmann::ordered_json::array();
  for (const ListedCamera& c : list) {
    cameras.push_back({{"id", c.id}, {"model", c.model}, {"modes", c.modes}, {"controls", c.controls}});
  }
  nlohmann::ordered_json out{{"cameras", cameras}};
  if (!why.empty()) out["why_none"] = why;
  std::cout << json_text(out) << std::endl;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "none" : text;
}

}  // namespace

Result<int> print_cameras(bool json) {
  ENAMEL_TRY_ASSIGN(const auto list, list_cameras());
  const std::string why = list.empty() ? why_no_camera() : "";
  if (json) {
    print_json(list, why);
  } else {
    for (const ListedCamera& c : list) {
      std::cout << c.id << "  " << c.model << "\n  modes:    " << joined(c.modes)
                << "\n  controls: " << joined(c.controls) << "\n";
    }
  }
  if (!list.empty()) return 0;
  return fail(ErrorCode::kCamera, "no camera: " + why);
}
#else
Result<int> print_cameras(bool) {
  return fail(ErrorCode::kHal, "--camera list: this build has no libcamera (ENAMEL_WITH_LIBCAMERA is off)");
}
#endif

}  // namespace enamel::fw
