// The twin's simulated GRBL controller, with a clock and a port of its own.
#pragma once

#include <utility>

#include "tools/twin/axes/grbl_model.hpp"

namespace enamel::test {

using twin::GrblFault;
using twin::GrblModelSetup;

struct OwnClock {
  SteadyClock own_clock;
};

/// Members are thread-safe.
class GrblModel : private OwnClock, public twin::GrblModel {
 public:
  explicit GrblModel(GrblModelSetup setup = {})
      : twin::GrblModel(twin::PseudoTerminal::open().value(), std::move(setup), own_clock) {}
};

}  // namespace enamel::test
