// What draw() puts together; each takes from the numbers what it needs.
#pragma once

#include "tests/support/draw/conditions.hpp"
#include "tests/support/draw/random.hpp"

namespace enamel::test {

[[nodiscard]] calib::Rig draw_rig(Random& r, calib::PatternMode mode);
[[nodiscard]] Response draw_response(Random& r);
[[nodiscard]] Optics draw_optics(Random& r);

/// Scene, paint and motion of `drawn` from the seed; its rig is there already.
void draw_view(std::uint64_t seed, int attempt, Drawn& drawn);

}  // namespace enamel::test
