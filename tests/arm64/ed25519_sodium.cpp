#include "tests/arm64/boot_case.hpp"

namespace enamel::test {

const image::Ed25519& model_ed25519(std::span<const std::byte>) { return image::sodium_ed25519(); }

}  // namespace enamel::test
