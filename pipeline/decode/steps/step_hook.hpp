// How a caller who has a clock learns that a step of a burst is done.
#pragma once

#include <functional>

namespace enamel::pipeline {

/// Called after each step with its name; may be empty.
using StepHook = std::function<void(const char* step)>;

inline void tell(const StepHook& hook, const char* step) {
  if (hook) hook(step);
}

}  // namespace enamel::pipeline
