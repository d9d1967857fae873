// The recording that every end-to-end test plays: rendered once, by the test render_small.
#pragma once

#include <string>

namespace enamel::test {

inline std::string small_capture() { return std::string(ENAMEL_BIN_DIR) + "/../fixtures/small.mcap"; }

}  // namespace enamel::test
