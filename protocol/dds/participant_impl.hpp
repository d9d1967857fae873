// Cyclone side of Participant. Private to this folder.
#pragma once

#include <dds/dds.h>

#include <memory>

#include "protocol/dds/participant.hpp"

namespace enamel::dds {

/// Cyclone allows one configured domain of a number in a process: participants with equal options share it.
struct DomainHolder {
  ParticipantOptions options;
  dds_entity_t entity = 0;  ///< 0 when CYCLONEDDS_URI rules
  DomainHolder() = default;
  DomainHolder(const DomainHolder&) = delete;
  DomainHolder& operator=(const DomainHolder&) = delete;
  ~DomainHolder();
};

struct Participant::Impl {
  std::shared_ptr<DomainHolder> domain;
  dds_entity_t entity = 0;
  Impl(std::shared_ptr<DomainHolder> domain_in, dds_entity_t entity_in)
      : domain(std::move(domain_in)), entity(entity_in) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { dds_delete(entity); }
};

[[nodiscard]] tl::unexpected<Error> dds_fail(dds_return_t rc, const std::string& what);

}  // namespace enamel::dds
