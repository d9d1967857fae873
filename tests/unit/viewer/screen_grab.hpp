// What the X server shows of the window whose GL context is current on this thread.
#pragma once

#include "viewer/gl/picture.hpp"

namespace enamel::view::test {

/// Empty picture when there is no such window.
[[nodiscard]] Picture grab_screen();

}  // namespace enamel::view::test
