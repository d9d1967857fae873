// Decodes the burst of bits_scene.hpp in both modes; for processors on which no test framework is at hand. Exit 1 when
// a bit differs from what the unit test expects on this repository's main machine.
#include <cstdio>

#include "tests/unit/decode/bits_scene.hpp"

namespace {

bool same(const char* name, const enamel::calib::Rig& rig, const enamel::test::BitHashes& expected) {
  const auto found = enamel::test::bit_hashes(rig);
  std::printf("mode %s: frames %u (expected %u), decoded %u (expected %u)\n", name, found.frames, expected.frames,
              found.decoded, expected.decoded);
  return found.frames == expected.frames && found.decoded == expected.decoded;
}

}  // namespace

int main() {
  const bool t = same("T", enamel::test::cropped_rig(320, 160), enamel::test::kModeT);
  const bool m = same("M", enamel::test::micro_rig(320, 160), enamel::test::kModeM);
  return t && m ? 0 : 1;
}
