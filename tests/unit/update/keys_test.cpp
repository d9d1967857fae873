// Keys compiled into the probe: what the build's own key signs is for development probes only; which files may be
// given.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "firmware/keys/trusted_keys.hpp"
#include "protocol/image/image_file.hpp"
#include "tests/support/firmware_image.hpp"
#include "tests/support/run.hpp"

namespace enamel::fw {
namespace {

using image::Refusal;
using test::run;

class Keys : public testing::Test {
 protected:
  [[nodiscard]] std::string keygen(const std::string& name) const {
    EXPECT_EQ(run({test::program("enamel-sign"), "keygen", "--out", folder_ / name}).code, 0);
    return folder_ / name;
  }
  [[nodiscard]] test::Ran embed(const std::string& files) const {
    return run({"/usr/bin/env", "cmake", "-DKEYS=" + files, "-DOUT=" + (folder_ / "keys.cpp"), "-P",
                std::string(ENAMEL_SOURCE_DIR) + "/firmware/keys/embed_keys.cmake"});
  }
  [[nodiscard]] static std::string digits(const std::string& file) {
    return nlohmann::json::parse(read_file(file).value())["key"];
  }

  test::TempFolder folder_;
};

TEST_F(Keys, the_builds_own_key_is_for_development_probes_only) {
#ifdef ENAMEL_GIVEN_KEYS
  GTEST_SKIP() << "this build was given keys (ENAMEL_FIRMWARE_KEYS)";
#endif
  const std::string own = std::string(ENAMEL_BIN_DIR) + "/../keys/test.key";
  ASSERT_EQ(trusted_keys().size(), 1U);
  EXPECT_EQ(to_hex(trusted_keys()[0].key), digits(own + ".pub"));
  std::filesystem::copy_file(own, folder_ / "test.key");
  ASSERT_TRUE(write_file(folder_ / "app", "an application").has_value());
  const test::Ran made =
      run({test::program("enamel-sign"), "sign", "--key", folder_ / "test.key", "--payload", folder_ / "app",
           "--version", "1.0.0", "--counter", "1", "--hardware", "2", "--out", folder_ / "app.enfw"});
  ASSERT_EQ(made.code, 0) << made.err;
  const std::string file = read_file(folder_ / "app.enfw").value();
  const auto manifest = image::open_image(std::as_bytes(std::span(file)));
  ASSERT_TRUE(manifest.has_value());
  image::Trust trust{trusted_keys(), 0, true, &image::sodium_ed25519()};
  EXPECT_TRUE(image::check_signatures(*manifest, trust).has_value());
  trust.development_fuse = false;
  EXPECT_EQ(image::check_signatures(*manifest, trust).error(), Refusal::kDevSigned);
  EXPECT_EQ(image::check_signatures(*manifest, test::KeyRing().trust()).error(), Refusal::kUnknownKey);
}

TEST_F(Keys, files_of_keys_become_source_in_their_order) {
  const std::string current = keygen("current"), next = keygen("next");
  const test::Ran made = embed(current + ".pub;" + next + ".pub");
  ASSERT_EQ(made.code, 0) << made.err;
  std::string source = read_file(folder_ / "keys.cpp").value();
  for (const char* const noise : {"0x", ", "}) {
    for (std::size_t at = 0; (at = source.find(noise)) != std::string::npos;) source.erase(at, 2);
  }
  const std::size_t first = source.find(digits(current + ".pub")), second = source.find(digits(next + ".pub"));
  ASSERT_NE(first, std::string::npos) << source;
  ASSERT_NE(second, std::string::npos) << source;
  EXPECT_LT(first, second);
}

TEST_F(Keys, what_is_no_public_key_stops_the_build_by_its_name) {
  const std::string key = keygen("release");
  ASSERT_TRUE(write_file(folder_ / "other.pub", "{}").has_value());
  const std::string unsuitable[] = {key, folder_ / "other.pub", folder_ / "absent.pub", key + ".pub;" + key + ".pub",
                                    ""};
  for (const std::string& files : unsuitable) {
    const test::Ran refused = embed(files);
    EXPECT_NE(refused.code, 0) << files;
    EXPECT_EQ(refused.err.find(digits(key)), std::string::npos) << "a secret was printed";
    EXPECT_NE(refused.err.find(files.empty() ? "ENAMEL_FIRMWARE_KEYS" : files.substr(files.rfind('/'))),
              std::string::npos)
        << refused.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "keys.cpp"));
}

}  // namespace
}  // namespace enamel::fw
