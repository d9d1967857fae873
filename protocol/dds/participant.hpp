// One side of the link: a DDS participant with our own Cyclone configuration (domain 77, loopback, unicast) unless
// CYCLONEDDS_URI is set, which then rules alone. Cyclone itself stays in the .cpp files of this folder.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "protocol/base/result.hpp"

namespace enamel::dds {

struct ParticipantOptions {
  std::uint32_t domain = 77;
  std::string tag = "enamel";  ///< only participants with the same tag see each other; --dds-tag
};

/// Movable. Writers and readers keep what they need alive: the order of destruction does not matter.
class Participant {
 public:
  /// Errors: kDds (bad configuration, no usable interface, or this process already uses the domain with another tag).
  [[nodiscard]] static Result<Participant> create(const ParticipantOptions& options);

  struct Impl;
  [[nodiscard]] const std::shared_ptr<Impl>& impl() const noexcept { return impl_; }

 private:
  explicit Participant(std::shared_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
  std::shared_ptr<Impl> impl_;
};

/// The Cyclone configuration that create() uses; for `enamel doctor` and for logs.
[[nodiscard]] std::string cyclone_config(const ParticipantOptions& options);

}  // namespace enamel::dds
