#include "protocol/image/refusal.hpp"

namespace enamel::image {

RefusalText describe_refusal(std::uint32_t number) noexcept {
  switch (number) {
#define ENAMEL_REFUSAL(name, code, status, what, cause, remedy) \
  case code:                                                    \
    return {#name, what, cause, remedy};
#include "protocol/image/refusals.def"
#undef ENAMEL_REFUSAL
    default:
      return {};
  }
}

}  // namespace enamel::image
