// Any bytes as a firmware image, or a good image with some of it altered and its checksums mended: the parser stays
// inside them, nobody forges a signature, and the probe's receiver says the same as the checks, before it erases
// anything.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

#include "firmware/boot/slot_image.hpp"
#include "firmware/device/sim/flash_model.hpp"
#include "firmware/update/image_receiver.hpp"
#include "protocol/image/image_file.hpp"
#include "tests/fuzz/demand.hpp"
#include "tests/fuzz/fuzz_images.hpp"

namespace {

using namespace enamel;
using test::Bytes;
using test::demand;

constexpr std::size_t kOneChunk = 300, kTwoChunks = image::kChunkSize + 10;

struct World {
  test::KeyRing keys;
  image::Signer stranger = test::make_signer(99);
  std::array<image::Signer, 2> both = {keys.signer(0), keys.signer(1)};
  std::array<Bytes, 5> images = {
      test::make_image({2, 0, 0, 0}, 5, kOneChunk, {&keys.signer(0), 1}),
      test::make_image({3, 1, 0, 7}, 6, kTwoChunks, both),
      test::make_image({4, 0, 0, 0}, 6, kOneChunk, {&keys.signer(2), 1},
                       image::image_flags::kFull | image::image_flags::kDevelopment),
      test::make_image({5, 0, 0, 0}, 6, kOneChunk, {&stranger, 1}),
      test::make_image({6, 0, 0, 0}, 6, kOneChunk, {}),
  };
  fw::FlashModel flash{fw::flash_map::kSize};
};

const World& world() {
  static const World instance;
  return instance;
}

struct Input {
  Bytes bytes;
  bool signed_anew = false;  ///< by a trusted key: what is in it may be anything
};

Input input_of(test::ByteSource& in) {
  const std::uint8_t kind = in.byte() % 8;
  if (kind == 0) {
    const auto rest = in.rest();
    return {{rest.begin(), rest.end()}, false};
  }
  Input input{world().images[in.below(world().images.size())], kind >= 5};
  test::edit(input.bytes, in, in.below(5));
  if (in.one_in(8)) input.bytes.resize(in.number<std::uint32_t>() % (input.bytes.size() + 100));
  if (kind >= 2) test::repair(input.bytes, input.signed_anew ? &world().keys.signer(0) : nullptr);
  return input;
}

void demand_inside(const image::Manifest& m, std::span<const std::byte> image) {
  demand(m.bytes.size() == m.manifest_len && m.bytes.data() == image.data(), "the manifest lies at the start");
  demand(image::manifest_length(image) == m.manifest_len, "the header states the length");
  demand(m.chunk_table.size() == 32ULL * m.chunk_count, "a digest for every chunk");
  std::uint64_t payload = 0;
  for (std::uint32_t i = 0; i < m.chunk_count; ++i) {
    payload += m.chunk_length(i);
    static_cast<void>(m.chunk_digest(i));
  }
  demand(payload == m.payload_len && payload <= image::kMaxPayload, "the chunks are the payload");
  std::size_t tlvs = 0;
  image::for_each_tlv(m, [&](std::uint16_t type, std::span<const std::byte> value) {
    tlvs += 4 + value.size();
    const auto part = image::parse_component(value);
    demand(type != image::tlv::kComponent || (part && part->offset + part->length <= m.payload_len),
           "parts lie inside");
  });
  demand(tlvs == m.tlvs.size(), "TLVs follow each other");
}

void demand_no_forgery(const image::Manifest& m) {
  const bool ours = std::any_of(world().images.begin(), world().images.end(), [&](const Bytes& known) {
    const auto original = image::parse_manifest(known);
    return std::equal(m.signed_part.begin(), m.signed_part.end(), original->signed_part.begin(),
                      original->signed_part.end());
  });
  demand(ours, "what is altered does not verify");
}

/// The first refusal of the checks on the manifest, in their order.
image::Checked<image::Manifest> verdict(std::span<const std::byte> image, const image::Installed& installed) {
  const auto manifest = image::parse_manifest(image);
  if (!manifest) return manifest;
  const auto good = image::check_manifest(*manifest, test::test_hardware(), world().keys.trust(), installed);
  return good ? manifest : image::refuse(good.error());
}

/// Feeds the image in pieces, as blocks come.
image::Checked<void> feed(fw::ImageReceiver& receiver, std::span<const std::byte> image, std::size_t piece) {
  receiver.restart(false);
  for (std::size_t at = 0; at < image.size(); at += piece) {
    const auto taken = receiver.take(image.subspan(at, std::min(piece, image.size() - at)));
    if (!taken) return taken;
  }
  return {};
}

void demand_receiver_agrees(std::span<const std::byte> image, std::size_t piece) {
  const image::ImageVersion running{1, 0, 0, 0};
  const auto expected = verdict(image, {0, running, false});
  fw::FlashModel flash = world().flash;
  const auto untouched = flash.versions(fw::flash_map::kSlot, fw::flash_map::kSlotSize);
  const auto receiver = std::make_unique<fw::ImageReceiver>(
      fw::boot_regions(flash), fw::UpdateIdentity{test::test_hardware(), world().keys.trust(), 0, running});
  const auto taken = feed(*receiver, image, piece);
  const auto finished = receiver->finish();
  demand(flash.versions(fw::flash_map::kSlot, fw::flash_map::kSlotSize) == untouched, "what runs is not touched");
  if (!expected) {
    demand(flash.operations() == 0, "nothing is erased before the manifest is good");
    demand(!finished, "a refused image is not finished");
    const bool incomplete = expected.error() == image::Refusal::kTruncated || image.size() < image::kHeaderSize;
    demand(incomplete || (!taken && taken.error() == expected.error()), "receiver and checks agree");
    return;
  }
  fw::SlotWorkspace workspace;
  const auto slot = fw::boot_regions(flash).slot[1];
  for (std::uint32_t i = 0; i < receiver->chunks_done(); ++i) {
    const std::uint64_t at = fw::flash_map::kManifestArea + std::uint64_t{i} * image::kChunkSize;
    demand(fw::hash_region(slot, at, expected->chunk_length(i), workspace.piece) == expected->chunk_digest(i),
           "what was written is right");
  }
  const bool boots = fw::check_slot(slot, test::test_hardware(), world().keys.trust(), workspace).has_value();
  demand(!finished || boots, "what is finished boots");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  test::ByteSource in(data, size);
  const std::size_t piece = 1 + in.below(2 * image::kDfuTransferSize);
  const Input input = input_of(in);
  const auto manifest = image::parse_manifest(input.bytes);
  if (manifest) {
    demand_inside(*manifest, input.bytes);
    image::Trust trust = world().keys.trust();
    trust.development_fuse = true;
    if (!input.signed_anew && image::check_signatures(*manifest, trust)) demand_no_forgery(*manifest);
  }
  demand(!image::check_image_file(input.bytes, {}) || manifest, "a good file has a good manifest");
  demand_receiver_agrees(input.bytes, piece);
  return 0;
}
