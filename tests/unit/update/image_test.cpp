// The image format: what is built is read back, and nothing that was altered passes.
#include <gtest/gtest.h>

#include <cstring>

#include "protocol/image/dfu_suffix.hpp"
#include "tests/support/firmware_image.hpp"

namespace enamel::image {
namespace {

using test::build;
using test::KeyRing;
using test::plain_description;
using test::random_payload;
using test::test_hardware;

constexpr std::size_t kPayload = 2 * kChunkSize + 777;

class Image : public testing::Test {
 protected:
  [[nodiscard]] Checked<void> check(std::span<const std::byte> file) const { return check(file, keys_.trust()); }
  [[nodiscard]] Checked<void> check(std::span<const std::byte> file, const Trust& trust) const {
    const Checked<Manifest> manifest = parse_manifest(file);
    if (!manifest) return refuse(manifest.error());
    return check_manifest(*manifest, test_hardware(), trust, installed_);
  }
  [[nodiscard]] std::vector<std::byte> signed_by(std::size_t key,
                                                 const ImageDescription& d = plain_description()) const {
    return build(d, payload_, {&keys_.signer(key), 1});
  }

  KeyRing keys_;
  std::vector<std::byte> payload_ = random_payload(kPayload, 7);
  Installed installed_;
};

TEST_F(Image, is_read_back_as_built) {
  ImageDescription d = plain_description();
  d.components = {{1, 0, 0, 1000, {}}, {2, 0, 1000, kPayload - 1000, {}}};
  const std::vector<std::byte> file = signed_by(0, d);
  const Checked<Manifest> m = parse_manifest(file);
  ASSERT_TRUE(m.has_value());
  EXPECT_EQ(m->payload_len, kPayload);
  EXPECT_EQ(m->chunk_count, 3U);
  EXPECT_EQ(m->version, d.version);
  EXPECT_EQ(m->security_counter, 5U);
  EXPECT_EQ(m->min_bootloader, d.min_bootloader);
  EXPECT_EQ(file.size(), m->image_len() + kSuffixSize);
  EXPECT_EQ(m->chunk_length(2), 777U);
  EXPECT_EQ(m->chunk_digest(1), sha256(std::span(payload_).subspan(kChunkSize, kChunkSize)));
  int components = 0;
  for_each_tlv(*m, [&](std::uint16_t type, std::span<const std::byte> value) {
    if (type != tlv::kComponent) return;
    const auto c = parse_component(value);
    ASSERT_TRUE(c.has_value());
    EXPECT_EQ(c->sha256, sha256(std::span(payload_).subspan(c->offset, c->length)));
    ++components;
  });
  EXPECT_EQ(components, 2);
  EXPECT_TRUE(check(file).has_value());
}

TEST_F(Image, every_single_bit_of_the_manifest_counts) {
  std::vector<std::byte> file = signed_by(0);
  ASSERT_TRUE(check(file).has_value());
  const std::size_t length = parse_manifest(file)->manifest_len;
  for (std::size_t bit = 0; bit < 8 * length; ++bit) {
    const auto mask = static_cast<std::byte>(1U << (bit % 8));
    file[bit / 8] ^= mask;
    EXPECT_FALSE(check(file).has_value()) << "bit " << bit << " may change unseen";
    file[bit / 8] ^= mask;
  }
  EXPECT_TRUE(check(file).has_value());
}

TEST_F(Image, identity_is_named_before_signatures) {
  ImageDescription d = plain_description();
  d.product_id = 0x31303130;
  EXPECT_EQ(check(build(d, payload_, {})).error(), Refusal::kProduct);
  d = plain_description();
  d.hw_rev_min = 3;
  EXPECT_EQ(check(signed_by(0, d)).error(), Refusal::kHardware);
  d = plain_description();
  d.min_bootloader = ImageVersion{1, 0, 0, 1};
  EXPECT_EQ(check(signed_by(0, d)).error(), Refusal::kHardware);
  d = plain_description();
  d.protocol = ProtocolRange{2, 3};
  EXPECT_EQ(check(signed_by(0, d)).error(), Refusal::kHardware);
}

TEST_F(Image, every_reason_of_distrust_has_its_name) {
  EXPECT_EQ(check(build(plain_description(), payload_, {})).error(), Refusal::kUnsigned);
  const Signer stranger = test::make_signer(99);
  EXPECT_EQ(check(build(plain_description(), payload_, {&stranger, 1})).error(), Refusal::kUnknownKey);
  Trust revoked = keys_.trust();
  revoked.revoked = 1;
  EXPECT_EQ(check(signed_by(0), revoked).error(), Refusal::kKeyRevoked);
  EXPECT_TRUE(check(signed_by(1), revoked).has_value());
  Signer forger = keys_.signer(0);
  forger.sign = test::make_signer(99).sign;
  EXPECT_EQ(check(build(plain_description(), payload_, {&forger, 1})).error(), Refusal::kSignature);
}

TEST_F(Image, development_keys_need_fuse_and_flag) {
  ImageDescription d = plain_description();
  EXPECT_EQ(check(signed_by(2, d)).error(), Refusal::kDevSigned);
  Trust fused = keys_.trust();
  fused.development_fuse = true;
  EXPECT_EQ(check(signed_by(2, d), fused).error(), Refusal::kDevSigned) << "it could pass for a release";
  d.flags |= image_flags::kDevelopment;
  EXPECT_EQ(check(signed_by(2, d)).error(), Refusal::kDevSigned);
  EXPECT_TRUE(check(signed_by(2, d), fused).has_value());
}

TEST_F(Image, factory_images_are_for_the_factory) {
  ImageDescription d = plain_description();
  d.flags |= image_flags::kFactoryOnly;
  EXPECT_EQ(check(signed_by(0, d)).error(), Refusal::kFactoryOnly);
  Trust delivered_later = keys_.trust();
  delivered_later.in_factory = true;
  EXPECT_TRUE(check(signed_by(0, d), delivered_later).has_value());
  EXPECT_TRUE(check(signed_by(0), delivered_later).has_value());
}

TEST_F(Image, both_signatures_must_verify) {
  const Signer both[] = {keys_.signer(0), keys_.signer(1)};
  EXPECT_TRUE(check(build(plain_description(), payload_, both)).has_value());
  Signer forged[] = {keys_.signer(0), keys_.signer(1)};
  forged[1].sign = test::make_signer(99).sign;
  EXPECT_EQ(check(build(plain_description(), payload_, forged)).error(), Refusal::kSignature);
}

TEST_F(Image, lower_counter_never_lower_version_only_when_asked) {
  const std::vector<std::byte> file = signed_by(0);
  installed_.running = ImageVersion{1, 2, 3, 5};
  EXPECT_EQ(check(file).error(), Refusal::kRollback);
  installed_.allow_older = true;
  EXPECT_TRUE(check(file).has_value());
  installed_.min_security_counter = 6;
  EXPECT_EQ(check(file).error(), Refusal::kRollback);
}

TEST_F(Image, other_files_are_called_what_they_are) {
  const std::vector<std::byte> file = signed_by(0);
  for (const std::size_t size : {std::size_t{0}, std::size_t{64}, std::size_t{200}, std::size_t{4095}}) {
    EXPECT_EQ(parse_manifest(std::span(file).first(size)).error(), Refusal::kTruncated) << size;
  }
  std::vector<std::byte> dfuse(8192);
  std::memcpy(dfuse.data(), "DfuSe\x01", 6);
  EXPECT_EQ(parse_manifest(dfuse).error(), Refusal::kDfuSe);
  EXPECT_EQ(parse_manifest(random_payload(8192, 3)).error(), Refusal::kMagic);
  ImageDescription encrypted = plain_description();
  encrypted.flags |= image_flags::kEncrypted;
  EXPECT_EQ(check(signed_by(0, encrypted)).error(), Refusal::kMagic);
  ImageDescription calibration = plain_description();
  calibration.components = {{6, 0, 0, 10, {}}};
  EXPECT_EQ(check(signed_by(0, calibration)).error(), Refusal::kMagic);
}

TEST_F(Image, suffix_names_the_device_and_guards_the_file) {
  std::vector<std::byte> file = signed_by(0);
  const Checked<DfuSuffix> suffix = read_suffix(file);
  ASSERT_TRUE(suffix.has_value());
  EXPECT_EQ(suffix->vendor, kUsbVendor);
  EXPECT_EQ(suffix->device, 0x0102);
  file[file.size() / 2] ^= std::byte{1};
  EXPECT_EQ(read_suffix(file).error(), Refusal::kTruncated);
  EXPECT_EQ(read_suffix(std::span(file).first(file.size() - 1)).error(), Refusal::kTruncated);
}

TEST_F(Image, what_cannot_be_is_not_built) {
  ImageDescription d = plain_description();
  EXPECT_FALSE(build_image(d, {}, {}).has_value());
  d.components = {{1, 0, kPayload, 1, {}}};
  EXPECT_FALSE(build_image(d, payload_, {}).has_value());
}

TEST(Refusals, have_texts_and_status) {
  EXPECT_EQ(describe_refusal(704).name, "kSignature");
  EXPECT_TRUE(describe_refusal(0).what.empty());
  EXPECT_EQ(dfu_status(Refusal::kChunkHash), DfuStatus::kErrVerify);
}

}  // namespace
}  // namespace enamel::image
