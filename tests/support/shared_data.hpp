// Where the data sets lie that tests may use and the repository does not hold.
#pragma once

#include <cstdlib>
#include <string>

namespace enamel::test {

/// $ENAMEL_SHARED, else `shared` beside the repository. May be absent: ask before use, skip with its name.
inline std::string shared_folder() {
  const char* named = std::getenv("ENAMEL_SHARED");
  return named != nullptr && *named != '\0' ? named : ENAMEL_SOURCE_DIR "/../shared";
}

}  // namespace enamel::test
