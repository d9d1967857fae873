#include "protocol/capture/capture.hpp"

#include <gtest/gtest.h>

#include "protocol/dds/qos.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/unit/protocol/sample_capture.hpp"

namespace enamel::capture {
namespace {

using test::collect;
using test::TempFolder;

class Capture : public ::testing::TestWithParam<bool> {
 protected:
  CaptureOptions options() const { return {.compress = GetParam()}; }
  TempFolder folder_;
  std::string path_ = folder_ / "c.mcap";
};
INSTANTIATE_TEST_SUITE_P(Compression, Capture, ::testing::Bool());

TEST_P(Capture, everything_comes_back_in_order) {
  auto out = CaptureWriter::create(path_, test::sample_header(), options());
  ASSERT_TRUE(out) << out.error().message();
  const auto records = test::write_sample(*out, 5);
  const proto::Bytes truth{1, 2, 3};
  ASSERT_TRUE(out->attach("truth/poses.csv", "text/csv", truth));
  ASSERT_TRUE(out->finish());
  auto in = CaptureReader::open(path_);
  ASSERT_TRUE(in) << in.error().message();
  const CaptureInfo& info = in->info();
  EXPECT_FALSE(info.truncated);
  EXPECT_EQ(info.bursts, 5U);
  EXPECT_EQ(info.shed, 5U);
  EXPECT_EQ(info.statuses, 5U);
  EXPECT_EQ(info.events, 5U);
  EXPECT_EQ(info.device_infos, 1U);
  EXPECT_EQ(info.first_log_ns, records.front().log_ns);
  EXPECT_EQ(info.last_log_ns, records.back().log_ns);
  EXPECT_EQ(info.program, "sample 1.0");
  EXPECT_EQ(info.metadata, test::sample_header().metadata);
  ASSERT_EQ(info.attachments.size(), 2U);
  EXPECT_EQ(info.attachments[1].name, "truth/poses.csv");
  EXPECT_EQ(info.attachments[1].media_type, "text/csv");
  EXPECT_EQ(in->rig_text(), test::kRigText);
  EXPECT_EQ(in->attachment("truth/poses.csv").value(), truth);
  EXPECT_EQ(in->attachment("truth/none.csv").error().code, ErrorCode::kFileNotFound);
  for (int pass = 0; pass < 2; ++pass) {
    const auto all = collect(*in);
    EXPECT_TRUE(all.errors.empty());
    EXPECT_EQ(all.records, records);
    in->rewind();
  }
}

TEST_P(Capture, bursts_are_found_by_position_and_by_number) {
  auto out = CaptureWriter::create(path_, test::sample_header(), options());
  test::write_sample(*out, 6);
  ASSERT_TRUE(out->finish());
  auto in = CaptureReader::open(path_);
  for (const std::uint64_t n : {5U, 0U, 3U, 3U, 1U}) {
    EXPECT_EQ(in->burst(n).value(), test::camera_burst(10 + 2 * n, 16, 12));
    EXPECT_EQ(in->burst_with_id({10 + 2 * n}).value(), test::camera_burst(10 + 2 * n, 16, 12));
  }
  EXPECT_EQ(in->burst(6).error().code, ErrorCode::kBurstNotFound);
  EXPECT_EQ(in->burst_with_id({11}).error().code, ErrorCode::kBurstNotFound);
  EXPECT_EQ(in->next_burst().value()->burst_index, 10U);
}

TEST_P(Capture, a_recording_without_bursts_is_a_recording) {
  ASSERT_TRUE(CaptureWriter::create(path_, {}, options())->finish());
  auto in = CaptureReader::open(path_);
  ASSERT_TRUE(in);
  EXPECT_EQ(in->info().bursts, 0U);
  EXPECT_EQ(in->rig_text(), "");
  EXPECT_FALSE(in->next().value());
}

TEST_P(Capture, a_burst_as_received_is_kept_byte_for_byte) {
  const proto::Burst burst = test::camera_burst(4, 8, 8);
  const proto::Bytes cdr = proto::to_cdr(burst).value();
  auto out = CaptureWriter::create(path_, {}, options());
  ASSERT_TRUE(out->write_burst_cdr(cdr, 1));
  EXPECT_EQ(out->write_burst_cdr(proto::ByteView(cdr).first(30), 2).error().code, ErrorCode::kMessageInvalid);
  ASSERT_TRUE(out->finish());
  auto in = CaptureReader::open(path_);
  EXPECT_EQ(in->info().bursts, 1U);
  EXPECT_EQ(proto::to_cdr(*in->next_burst().value()).value(), cdr);
}

TEST_P(Capture, a_message_beyond_its_bound_is_refused_and_nothing_is_written) {
  auto out = CaptureWriter::create(path_, {}, options());
  EXPECT_EQ(out->write_event({.text = std::string(500, 'x')}, 1).error().code, ErrorCode::kMessageInvalid);
  EXPECT_FALSE(out->failed());
  ASSERT_TRUE(out->finish());
  EXPECT_EQ(CaptureReader::open(path_)->info().events, 0U);
}

TEST_P(Capture, attachment_names_are_unique) {
  auto out = CaptureWriter::create(path_, test::sample_header(), options());
  EXPECT_FALSE(out->attach("rig.json", "application/json", {}));
  EXPECT_TRUE(out->attach("empty", "text/plain", {}));
  ASSERT_TRUE(out->finish());
  EXPECT_TRUE(CaptureReader::open(path_)->attachment("empty").value().empty());
}

TEST(CaptureFiles, foreign_ones_are_refused) {
  const TempFolder folder;
  EXPECT_EQ(CaptureReader::open(folder / "none").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(CaptureReader::open(folder / ".").error().code, ErrorCode::kFileRead);
  test::spill(folder / "empty", "");
  EXPECT_EQ(CaptureReader::open(folder / "empty").error().code, ErrorCode::kCaptureInvalid);
  test::spill(folder / "text", std::string(5000, 'x'));
  EXPECT_EQ(CaptureReader::open(folder / "text").error().code, ErrorCode::kCaptureInvalid);
  EXPECT_EQ(CaptureWriter::create(folder / "no/such/folder.mcap", {}).error().code, ErrorCode::kFileWrite);
}

proto::AxesReading drawn_reading(test::Random& random, std::uint64_t burst) {
  proto::AxesReading reading;
  test::randomize(random, reading);
  reading.burst_index = burst;
  return reading;
}

TEST_P(Capture, angles_of_the_axes_come_back_among_the_rest) {
  auto out = CaptureWriter::create(path_, test::sample_header(), options());
  test::Random random(31);
  auto records = test::write_sample(*out, 2);
  const std::int64_t t = records.back().log_ns;
  for (std::uint64_t n = 20; n < 24; ++n) {
    const auto reading = drawn_reading(random, n);
    ASSERT_TRUE(out->write_axes(reading, t));
    records.push_back({t, reading});
    ASSERT_TRUE(out->write_burst(test::camera_burst(n, 16, 12), t));
    records.push_back({t, test::camera_burst(n, 16, 12)});
  }
  const proto::AxesReading beyond{.rot_read_deg = 1e9};
  EXPECT_EQ(out->write_axes(beyond, t).error().code, ErrorCode::kMessageInvalid);
  ASSERT_TRUE(out->finish());
  auto in = CaptureReader::open(path_);
  ASSERT_TRUE(in) << in.error().message();
  EXPECT_EQ(in->info().axes, 4U);
  EXPECT_EQ(in->info().bursts, 6U);
  EXPECT_TRUE(in->info().problems.empty());
  EXPECT_EQ(collect(*in).records, records);
  in->rewind();
  for (int n = 0; n < 6; ++n) ASSERT_TRUE(in->next_burst().value()) << n;
  EXPECT_FALSE(in->next_burst().value()) << "angles are no bursts";
}

TEST_P(Capture, angles_of_a_recording_without_an_end_come_back_as_far_as_its_bursts) {
  test::Random random(32);
  const auto reading = drawn_reading(random, 1);
  {
    auto out = CaptureWriter::create(path_, test::sample_header(), options());
    ASSERT_TRUE(out->write_burst(test::camera_burst(0, 16, 12), 1));
    ASSERT_TRUE(out->write_axes(reading, 2));
    ASSERT_TRUE(out->write_burst(test::camera_burst(1, 16, 12), 2));
  }
  auto in = CaptureReader::open(path_);
  ASSERT_TRUE(in) << in.error().message();
  EXPECT_TRUE(in->info().truncated);
  EXPECT_EQ(in->info().axes, 1U);
  EXPECT_EQ(std::get<proto::AxesReading>(collect(*in).records.at(1).value), reading);
}

// Negative control: one reading makes the difference.
TEST_P(Capture, a_recording_without_angles_is_without_their_channel) {
  const auto bytes_of = [&](int readings) {
    auto out = CaptureWriter::create(path_, test::sample_header(), options());
    EXPECT_EQ(out->write_axes({.rot_cmd_deg = 1e9}, 1).error().code, ErrorCode::kMessageInvalid);
    for (int n = 0; n < readings; ++n) EXPECT_TRUE(out->write_axes({.rot_cmd_deg = 1}, 1));
    EXPECT_TRUE(out->finish());
    const auto bytes = test::slurp(path_);
    return std::string(bytes.begin(), bytes.end());
  };
  EXPECT_EQ(bytes_of(0).find(std::string(dds::kQos<proto::AxesReading>.topic)), std::string::npos);
  EXPECT_NE(bytes_of(1).find(std::string(dds::kQos<proto::AxesReading>.topic)), std::string::npos);
}

TEST(CaptureFiles, channels_are_named_as_the_topics) {
  const TempFolder folder;
  auto out = CaptureWriter::create(folder / "c.mcap", {}, {.compress = false});
  ASSERT_TRUE(out->finish());
  const auto bytes = test::slurp(folder / "c.mcap");
  const std::string text(bytes.begin(), bytes.end());
  for (const auto topic : {dds::kQos<proto::Burst>.topic, dds::kQos<proto::Status>.topic, dds::kQos<proto::Event>.topic,
                           dds::kQos<proto::DeviceInfo>.topic}) {
    EXPECT_NE(text.find(topic), std::string::npos) << topic;
  }
}

}  // namespace
}  // namespace enamel::capture
