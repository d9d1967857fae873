// Strong identifiers: a burst number cannot be passed where a session number is meant.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace enamel {

template <class Tag, class Rep>
struct StrongId {
  Rep value{};
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 mistakes the comparison with 0 inside <=>
  friend constexpr auto operator<=>(const StrongId&, const StrongId&) = default;
};

using BurstId = StrongId<struct BurstTag, std::uint64_t>;      ///< counts projected bursts of one session, from 0
using SessionId = StrongId<struct SessionTag, std::uint32_t>;  ///< chosen by the host at SESSION_OPEN
using ProbeId = StrongId<struct ProbeTag, std::uint32_t>;      ///< derived from the probe's serial

}  // namespace enamel

template <class Tag, class Rep>
struct std::hash<enamel::StrongId<Tag, Rep>> {
  std::size_t operator()(const enamel::StrongId<Tag, Rep>& id) const noexcept { return std::hash<Rep>{}(id.value); }
};
