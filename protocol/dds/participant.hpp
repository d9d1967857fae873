// One side of the link: a DDS participant with our own Cyclone configuration, that of a link profile. Without a
// profile: CYCLONEDDS_URI where it is set, which then rules alone, else loopback. Cyclone itself stays in the .cpp
// files of this folder.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/dds/link.hpp"

namespace enamel::dds {

struct ParticipantOptions {
  std::uint32_t domain = 77;
  std::string tag = "enamel";                      ///< only participants with the same tag see each other; --dds-tag
  std::optional<LinkProfile> link = std::nullopt;  ///< --link
};

/// What a command line says of the link.
struct LinkChoice {
  std::string tag = "enamel";           ///< --dds-tag
  std::string link = {};                ///< --link; empty: see ParticipantOptions
  std::vector<std::string> peers = {};  ///< --peer, instead of the profile's
};
enum class LinkEnd : std::uint8_t { kProbe, kHost };

/// Errors: kUsage, those of a profile's file.
[[nodiscard]] Result<ParticipantOptions> participant_options(const LinkChoice& choice, LinkEnd end);

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

/// Major versions other than ours that programs on this network speak, by their topics' names; ascending. Same domain
/// and tag only. Empty too where nobody can be asked.
[[nodiscard]] std::vector<int> foreign_versions(const Participant& participant);

/// The Cyclone configuration that create() uses on this interface.
[[nodiscard]] std::string cyclone_config(const ParticipantOptions& options, const std::string& interface);

}  // namespace enamel::dds
