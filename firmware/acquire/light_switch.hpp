// The only hand on the LED: on exactly while someone wants it and the probe's state permits it.
#pragma once

#include <mutex>

#include "firmware/hal/light.hpp"

namespace enamel::fw {

/// Thread-safe. Taking the permission away switches off before the call returns.
class LightSwitch {
 public:
  explicit LightSwitch(Light& light) : light_(light) { light_.set_enabled(false); }
  ~LightSwitch() { light_.set_enabled(false); }
  LightSwitch(const LightSwitch&) = delete;
  LightSwitch& operator=(const LightSwitch&) = delete;

  void permit(bool yes) { set(permitted_, yes); }
  void want(bool yes) { set(wanted_, yes); }

 private:
  void set(bool& flag, bool yes) {
    const std::lock_guard lock(mutex_);
    flag = yes;
    light_.set_enabled(permitted_ && wanted_);
  }

  Light& light_;
  std::mutex mutex_;
  bool permitted_ = false;
  bool wanted_ = false;
};

}  // namespace enamel::fw
