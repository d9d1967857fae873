// From the session's thread to the viewer's: only the newest frame counts, nobody waits.
#pragma once

#include <memory>

#include "pipeline/types/preview.hpp"
#include "protocol/base/latest_slot.hpp"

namespace enamel::view {

/// One writer (the session), one reader (the thread that owns the window). put() and take() are wait-free; a slow
/// viewer loses frames, never the session time.
using PreviewMailbox = LatestSlot<std::shared_ptr<const PreviewFrame>>;

}  // namespace enamel::view
