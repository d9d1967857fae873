// What the commands read: a recording, an exchange folder or a session folder.
#pragma once

#include <string>

#include "host/record/burst_stream.hpp"

namespace enamel::app {

/// An attachment as text; empty when there is none.
[[nodiscard]] std::string attached_text(host::BurstStream& stream, const std::string& name);

}  // namespace enamel::app
