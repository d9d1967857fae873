#include "protocol/image/refusal.hpp"

namespace enamel::image {

RefusalText describe_refusal(std::uint32_t number) noexcept {
  switch (number) {
#define ENAMEL_REFUSAL(name, code, status, exit, what, cause, remedy) \
  case code:                                                          \
    return {#name, what, cause, remedy};
#include "protocol/image/refusals.def"
#undef ENAMEL_REFUSAL
    default:
      return {};
  }
}

int exit_code(Refusal why) noexcept {
  switch (why) {
#define ENAMEL_REFUSAL(name, code, status, exit, what, cause, remedy) \
  case Refusal::name:                                                 \
    return exit;
#include "protocol/image/refusals.def"
#undef ENAMEL_REFUSAL
  }
  return 8;
}

}  // namespace enamel::image
