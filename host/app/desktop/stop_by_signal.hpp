// Ctrl-C brings a table to a stand instead of leaving it to run on without us.
#pragma once

#include "host/motion/axes.hpp"

namespace enamel::app {

/// One at a time, for as long as it lives.
class StopBySignal {
 public:
  explicit StopBySignal(motion::Axes& axes);
  ~StopBySignal();
  StopBySignal(const StopBySignal&) = delete;
  StopBySignal& operator=(const StopBySignal&) = delete;
};

}  // namespace enamel::app
