// boot_cases FILE: writes the flashes that boot_model boots from (boot_case.hpp): every state, good and damaged slots,
// images of other keys, kinds and hardware, with the answers of libsodium that a model without it will need.
#include <cstdio>
#include <string>

#include "firmware/boot/control_block.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/rng.hpp"
#include "protocol/image/dfu_suffix.hpp"
#include "tests/arm64/boot_case.hpp"
#include "tests/support/firmware_image.hpp"

namespace {

using namespace enamel;
using test::build;

constexpr std::size_t kPayload = image::kChunkSize + 4321;
constexpr std::uint32_t kCases = 80;

using Image = std::vector<std::byte>;

std::vector<image::Signer> signers() { return {test::make_signer(1), test::make_signer(2), test::make_signer(3)}; }

/// What lies in slots: 0 is an erased one, 1 to 3 boot, the others do not.
std::vector<Image> contents() {
  const std::vector<image::Signer> keys = signers();
  const image::Signer stranger = test::make_signer(99);
  const auto payload = test::random_payload(kPayload, 1);
  image::ImageDescription plain = test::plain_description(), foreign = plain, development = plain;
  foreign.hw_rev_min = foreign.hw_rev_max = 9;
  development.flags |= image::image_flags::kDevelopment;
  std::vector<Image> out = {{},
                            build(plain, payload, {keys.data(), 1}),
                            build(plain, test::random_payload(500, 2), {&keys[1], 1}),
                            build(plain, payload, {keys.data(), 2}),
                            build(plain, payload, {&stranger, 1}),
                            build(plain, payload, {}),
                            build(foreign, payload, {keys.data(), 1}),
                            build(development, payload, {&keys[2], 1})};
  for (std::size_t i = 1; i < out.size(); ++i) out[i].resize(out[i].size() - image::kSuffixSize);
  for (const std::size_t at : {std::size_t{9}, std::size_t{200}, image::kManifestStep + 1, out[1].size() - 1}) {
    Image& damaged = out.emplace_back(out[1]);
    damaged[at] ^= std::byte{0x10};
  }
  return out;
}

/// Every signature of every image under every key.
std::uint32_t put_answers(ByteWriter& out, const std::vector<Image>& images) {
  std::uint32_t count = 0;
  for (const Image& bytes : images) {
    const auto manifest = image::parse_manifest(bytes);
    if (!manifest) continue;
    const Sha256Digest message = sha256(manifest->signed_part);
    for (std::size_t i = 0; i < manifest->signature_count; ++i) {
      for (const image::Signer& signer : signers()) {
        const image::SignatureBytes signature = manifest->signature(i);
        out.put_bytes(std::as_bytes(std::span(signer.key)));
        out.put_bytes(std::as_bytes(std::span(signature)));
        out.put_bytes(std::as_bytes(std::span(message)));
        const bool good = image::sodium_ed25519().verify(manifest->signed_part, signature, signer.key);
        out.put(static_cast<std::uint8_t>(good ? 1 : 0));
        ++count;
      }
    }
  }
  return count;
}

fw::ControlBlock draw_block(Rng& rng, std::uint32_t seq) {
  fw::ControlBlock block;
  block.seq = seq;
  block.active = static_cast<std::uint8_t>(rng.below(2));
  for (fw::SlotRecord& slot : block.slot) {
    slot.state = static_cast<fw::SlotState>(rng.below(7));
    slot.tries = static_cast<std::uint8_t>(rng.below(4));
    slot.security_counter = rng.below(9);
  }
  return block;
}

void put_case(ByteWriter& out, Rng& rng, std::size_t images) {
  const std::uint32_t seq = rng.below(4) == 0 ? 0xFFFFFFFF : rng.below(1000);
  for (const std::uint32_t copy : {0U, 1U}) {
    fw::ControlBytes bytes = encode(draw_block(rng, seq + copy));
    if (rng.below(8) == 0) bytes[rng.below(512)] ^= std::byte{4};
    out.put_bytes(bytes);
  }
  for (int slot = 0; slot < 2; ++slot) {
    const bool bootable = rng.below(4) != 0;
    out.put(static_cast<std::uint8_t>(bootable ? 1 + rng.below(3) : rng.below(static_cast<std::uint32_t>(images))));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  ByteWriter out;
  const test::KeyRing ring;
  const image::Trust trust = ring.trust();
  out.put(static_cast<std::uint32_t>(trust.keys.size()));
  for (const image::TrustedKey& key : trust.keys) {
    out.put_bytes(std::as_bytes(std::span(key.key)));
    out.put(static_cast<std::uint8_t>(key.development ? 1 : 0));
  }
  const std::vector<Image> images = contents();
  ByteWriter answers;
  out.put(put_answers(answers, images));
  out.put_bytes(answers.bytes());
  out.put(static_cast<std::uint32_t>(images.size()));
  for (const Image& bytes : images) {
    out.put(static_cast<std::uint32_t>(bytes.size()));
    out.put_bytes(bytes);
  }
  out.put(kCases);
  Rng rng(8, 0, 0);
  for (std::uint32_t i = 0; i < kCases; ++i) put_case(out, rng, images.size());
  const std::span<const std::byte> all = out.bytes();
  return write_file(argv[1], {reinterpret_cast<const char*>(all.data()), all.size()}) ? 0 : 1;
}
