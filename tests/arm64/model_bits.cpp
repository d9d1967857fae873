// Fuses and registers the bursts of model_bits_scene.hpp; for processors on which no test framework is at hand. Exit 1
// when a bit of the field or of the view differs from what the unit test expects, or the pose by 0.1 um.
#include <cstdio>

#include "tests/unit/register/model_bits_scene.hpp"

int main() {
  const auto found = enamel::test::model_bits();
  const double apart_um = 1e3 * enamel::test::apart_mm(found.T_model_cam, enamel::test::registered_pose());
  std::printf("field %u (expected %u), view %u (expected %u), pose %.2e um off\n", found.field,
              enamel::test::kFieldBits, found.view, enamel::test::kViewBits, apart_um);
  const bool same = found.field == enamel::test::kFieldBits && found.view == enamel::test::kViewBits;
  return same && found.registered && apart_um < 0.1 ? 0 : 1;
}
