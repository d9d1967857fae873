// Flashes to boot from, as a file: written by boot_cases on the host, read by boot_model on any processor.
//   u32 keys, each {32 key, u8 development}
//   u32 answers of Ed25519, each {32 key, 64 signature, 32 SHA-256 of the message, u8 verifies}
//   u32 slot contents, each {u32 length, manifest and payload}
//   u32 cases, each {2 x 512 control block copies, 2 x u8 slot content}
#pragma once

#include <cstdint>

#include "protocol/image/trust.hpp"

namespace enamel::test {

inline constexpr int kPowerCycles = 5;

inline image::Hardware model_hardware() { return {image::kProductId, 2, {1, 0, 0, 0}, 1}; }

/// What a program is linked with: libsodium, or the answers that it gave.
[[nodiscard]] const image::Ed25519& model_ed25519(std::span<const std::byte> answers);

}  // namespace enamel::test
