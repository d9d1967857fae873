// The sign command as a function of its options.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::sign {

struct SignRequest {
  std::vector<std::string> keys;        ///< secret key files; the log lies beside the first
  std::string payload;                  ///< one application image, or
  std::vector<std::string> components;  ///< KIND:FILE each, laid one after the other
  std::string version, hardware, min_bootloader, notes, after, out;
  std::uint32_t security_counter = 0;
  bool factory_only = false;  ///< refused by probes in the field
  std::uint64_t build_time_unix_s = 0;
};

/// Writes the image and an entry of the log; SHA-256 of the file. Nothing is written when anything fails.
[[nodiscard]] Result<std::string> sign_image(const SignRequest& request);

}  // namespace enamel::sign
