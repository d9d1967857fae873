// Where a scan puts what it need not hold in memory, and how it gives memory back. Private to host/session.
#pragma once

#include <malloc.h>

#include <cstdlib>
#include <string>

#include "pipeline/model/segments/patch_store.hpp"
#include "protocol/base/log.hpp"

namespace enamel::host {

/// TMPDIR, else the folder for large temporary files: /tmp is memory on many systems.
[[nodiscard]] inline std::string default_scratch_folder() {
  const char* const named = std::getenv("TMPDIR");
  return named != nullptr && *named != '\0' ? named : "/var/tmp";
}

/// Kept bursts go to a file there; what the disk refuses is said.
[[nodiscard]] inline pipeline::PatchStoreConfig kept_in(const std::string& folder) {
  return {.folder = folder,
          .on_refused =
              [](const std::string& what) {
                log::warn("model",
                          "{}; bursts stay in memory from now on, 0.6 MB each: free space there, or name a folder"
                          " on another disk in TMPDIR",
                          what);
              },
          .on_lost =
              [](const std::string& what) {
                log::error("model", "{}; a burst that was kept there is lost: check the disk", what);
              }};
}

/// Between two parts of the work after a scan: what the first held would stay with the process unused.
inline void hand_back_free_pages() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace enamel::host
