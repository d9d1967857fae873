#include "host/record/capture_tools.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <functional>

#include "host/record/burst_stream.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/mcap/reader.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/unit/protocol/sample_capture.hpp"

namespace enamel::host {
namespace {

using test::TempFolder;

// Ten bursts of one rig; `change` may alter each before it is written.
void write(const std::string& path, const std::function<void(proto::Burst&)>& change = {},
           const std::string& rig = test::kRigText) {
  auto header = test::sample_header();
  header.rig_text = rig;
  auto out = capture::CaptureWriter::create(path, header);
  ASSERT_TRUE(out);
  const std::string text = test::kRigText;
  for (std::uint64_t i = 0; i < 10; ++i) {
    proto::Burst b = test::camera_burst(i, 16, 12);
    b.calib_crc32 = crc32(std::as_bytes(std::span(text.data(), text.size())));
    if (change) change(b);
    ASSERT_TRUE(out->write_burst(b, static_cast<std::int64_t>(1000 + i)));
    ASSERT_TRUE(out->write_shed({.burst_index = 100 + i}, static_cast<std::int64_t>(1000 + i)));
  }
  ASSERT_TRUE(out->attach("truth/x", "text/plain", proto::Bytes{1, 2}));
  ASSERT_TRUE(out->finish());
}

class CaptureTools : public ::testing::Test {
 protected:
  void SetUp() override { write(good_); }
  TempFolder folder_;
  std::string good_ = folder_ / "good.mcap";
  std::string other_ = folder_ / "other.mcap";
};

TEST_F(CaptureTools, diff_of_equal_recordings_is_nothing) {
  write(other_);
  EXPECT_FALSE(capture_diff(good_, other_, true).value());
}

TEST_F(CaptureTools, diff_names_the_first_difference) {
  struct Case {
    const char* field;
    std::function<void(proto::Burst&)> change;
  };
  const std::vector<Case> cases{
      {"t_publish_ns", [](auto& b) { b.t_publish_ns += 1; }},
      {"gyro_rps", [](auto& b) { b.gyro_rps[1] = 0.5F; }},
      {"meta[2].exposure_us", [](auto& b) { b.meta[2].exposure_us += 1; }},
      {"meta.size", [](auto& b) { b.meta.pop_back(); }},
      {"payload.size", [](auto& b) { b.payload.pop_back(); }},
      {"payload", [](auto& b) { b.payload[2 * 192 + 3 * 16 + 5] ^= 1U; }},
      {"payload_crc32", [](auto& b) { b.payload_crc32 ^= 1U; }},
  };
  for (const Case& c : cases) {
    write(other_, [&](proto::Burst& b) {
      if (b.burst_index >= 6) c.change(b);
    });
    const auto difference = capture_diff(good_, other_).value();
    ASSERT_TRUE(difference) << c.field;
    EXPECT_EQ(difference->field, c.field);
    EXPECT_EQ(difference->burst_index, 6U);
    EXPECT_EQ(difference->ordinal, 12U);
    EXPECT_NE(difference->left, difference->right);
    if (difference->field == "payload") {
      EXPECT_EQ(difference->left.substr(0, 25), "frame 2, row 3, column 5:");
    }
  }
}

TEST_F(CaptureTools, diff_sees_rig_kind_and_length) {
  write(other_, {}, "{}");
  EXPECT_EQ(capture_diff(good_, other_).value()->field, "rig");
  ASSERT_TRUE(capture_cut(good_, other_, 0, 8));
  EXPECT_EQ(capture_diff(good_, other_).value()->field, "records");
}

TEST_F(CaptureTools, cut_keeps_the_range_and_everything_else) {
  ASSERT_EQ(capture_cut(good_, other_, 3, 6)->bursts, 4U);
  const auto stream = open_bursts(other_).value();
  EXPECT_EQ(stream->info().bursts, 4U);
  EXPECT_EQ(stream->info().shed, 3U);
  EXPECT_EQ(stream->rig_text(), test::kRigText);
  EXPECT_EQ(stream->attachment("truth/x").value(), (proto::Bytes{1, 2}));
  const auto original = open_bursts(good_).value();
  for (std::uint64_t id = 3; id <= 6; ++id) {
    EXPECT_EQ(stream->burst_with_id({id}).value(), original->burst_with_id({id}).value());
  }
  EXPECT_TRUE(capture_verify(other_)->clean());
  EXPECT_EQ(capture_cut(good_, folder_ / "none.mcap", 50, 60).error().code, ErrorCode::kBurstNotFound);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.mcap"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.mcap.partial"));
}

TEST_F(CaptureTools, cut_makes_a_clean_copy_of_a_truncated_recording) {
  const auto size = std::filesystem::file_size(good_);
  const auto chunk = mcap::Reader::open(good_)->blocks()[7];
  ASSERT_EQ(truncate(good_.c_str(), static_cast<off_t>(chunk.offset + chunk.length)), 0);
  ASSERT_LT(chunk.offset, size);
  EXPECT_FALSE(capture_verify(good_)->clean());
  EXPECT_EQ(capture_cut(good_, other_, 0, ~std::uint64_t{0})->bursts, 8U);
  EXPECT_TRUE(capture_verify(other_)->clean());
}

TEST_F(CaptureTools, verify_finds_what_is_wrong) {
  EXPECT_TRUE(capture_verify(good_)->clean());
  EXPECT_EQ(capture_verify(good_)->bursts, 10U);
  const auto says = [&](const std::string& text) {
    const auto report = capture_verify(other_);
    return report && !report->clean() && report->problems.size() == 1 &&
           report->problems[0].find(text) != std::string::npos;
  };
  write(other_, [](auto& b) { b.payload[7] ^= b.burst_index == 4 ? 1U : 0U; });
  EXPECT_TRUE(says("burst 4: "));
  write(other_, [](auto& b) { b.burst_index = b.burst_index == 4 ? 3 : b.burst_index; });
  EXPECT_TRUE(says("does not ascend"));
  write(other_, [](auto& b) { b.calib_crc32 += 1; });
  EXPECT_TRUE(says("another calibration"));
  write(other_, {}, "");
  EXPECT_TRUE(says("no rig.json"));
  EXPECT_EQ(capture_verify(folder_ / "none").error().code, ErrorCode::kFileNotFound);
}

TEST_F(CaptureTools, verify_knows_a_probe_that_was_started_again) {
  // Two lives of three bursts; each begins with the probe's first word, where it says one at all.
  const auto lives = [&](bool says_so) {
    auto out = capture::CaptureWriter::create(other_, test::sample_header());
    ASSERT_TRUE(out);
    for (std::int64_t life = 0; life < 2; ++life) {
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::int64_t now = 1000 + 10 * life + i;
        proto::Status status;
        status.seq = says_so ? i : 3 * static_cast<std::uint32_t>(life) + i;
        ASSERT_TRUE(out->write_status(status, now));
        proto::Burst burst = test::camera_burst(i, 16, 12);
        burst.calib_crc32 = 0;
        ASSERT_TRUE(out->write_burst(burst, now));
      }
    }
    ASSERT_TRUE(out->finish());
  };
  lives(true);
  EXPECT_TRUE(capture_verify(other_)->clean());
  EXPECT_EQ(capture_verify(other_)->bursts, 6U);
  lives(false);
  EXPECT_FALSE(capture_verify(other_)->clean());
}

TEST_F(CaptureTools, verify_finds_every_flipped_bit) {
  const auto bytes = test::slurp(good_);
  test::Random random(6);
  for (int i = 0; i < 300; ++i) {
    auto damaged = bytes;
    const std::size_t at = random.below(damaged.size());
    damaged[at] ^= static_cast<std::uint8_t>(1U << random.below(8));
    test::spill(other_, damaged);
    const auto report = capture_verify(other_);
    EXPECT_FALSE(report && report->clean()) << "byte " << at;
  }
}

}  // namespace
}  // namespace enamel::host
