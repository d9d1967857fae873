// Angles of the axes: channel and table, and what says so when they are not of one mind.
#include "host/record/axes_readings.hpp"

#include <gtest/gtest.h>

#include "host/record/capture_tools.hpp"
#include "host/record/exchange_folder.hpp"
#include "protocol/types/axes_table.hpp"
#include "tests/unit/protocol/sample_capture.hpp"
#include "tests/unit/protocol/sample_folder.hpp"

namespace enamel::host {
namespace {

using proto::AxesReading;
using Readings = std::vector<AxesReading>;

const std::string kHead = "burst_id,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg\n";

/// Bursts 0, 1, 2 ..., with readings that say where both axes stood.
Readings drawn_readings(std::uint64_t seed, std::uint64_t count) {
  test::Random random(seed);
  Readings out;
  while (out.size() < count) {
    AxesReading reading;
    test::randomize(random, reading);
    if (!reading.is_whole()) continue;
    const proto::Burst burst = test::camera_burst(out.size(), 8, 6);
    reading.burst_index = burst.burst_index;
    reading.probe_id = burst.probe_id;
    reading.session_id = burst.session_id;
    reading.stop = static_cast<std::uint32_t>(out.size() / 2);
    out.push_back(reading);
  }
  return out;
}

/// Names no calibration: it is of any rig.
proto::Burst burst_of_sample(std::uint64_t index) {
  proto::Burst burst = test::camera_burst(index, 8, 6);
  burst.calib_crc32 = 0;
  return burst;
}

class AxesReadings : public ::testing::Test {
 protected:
  enum class Place : std::uint8_t { kBefore, kBehind, kAtTheEnd };

  /// A recording of `bursts` bursts with these messages and this table.
  void write(std::uint64_t bursts, const Readings& messages, const std::string& table = "",
             Place place = Place::kBefore) const {
    auto out = capture::CaptureWriter::create(path_, test::sample_header());
    ASSERT_TRUE(out) << out.error().message();
    const auto t = [](std::uint64_t n) { return static_cast<std::int64_t>(n) * 1000; };
    const auto tell = [&](std::uint64_t n) {
      for (const AxesReading& m : messages) {
        if (m.burst_index != n) continue;
        ASSERT_TRUE(out->write_axes(m, t(place == Place::kAtTheEnd ? bursts : n)));
      }
    };
    for (std::uint64_t n = 0; n < bursts; ++n) {
      if (place == Place::kBefore) tell(n);
      ASSERT_TRUE(out->write_burst(burst_of_sample(n), t(n)));
      if (place == Place::kBehind) tell(n);
    }
    if (place == Place::kAtTheEnd) {
      for (std::uint64_t n = 0; n < bursts; ++n) tell(n);
    }
    if (!table.empty()) {
      ASSERT_TRUE(out->attach("axes.csv", "text/csv", proto::Bytes(table.begin(), table.end())));
    }
    ASSERT_TRUE(out->finish());
  }
  Result<Readings> read(const std::string& path) const {
    ENAMEL_TRY_ASSIGN(const auto stream, open_bursts(path));
    return axes_of(*stream);
  }
  Result<Readings> read() const { return read(path_); }

  test::TempFolder folder_;
  std::string path_ = folder_ / "c.mcap", other_ = folder_ / "other.mcap", out_ = folder_ / "out";
};

TEST_F(AxesReadings, come_from_the_channel_or_the_table_wherever_they_were_logged) {
  const Readings all = drawn_readings(1, 9);
  for (const Place place : {Place::kBefore, Place::kBehind, Place::kAtTheEnd}) {
    write(9, all, "", place);
    EXPECT_EQ(read().value(), all);
    EXPECT_TRUE(capture_verify(path_)->clean());
  }
  write(9, {}, proto::axes_table_text(all));
  const Readings rows = read().value();
  ASSERT_EQ(rows.size(), all.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    EXPECT_TRUE(rows[n].has_angles_of(all[n])) << n;
    EXPECT_EQ(rows[n].session_id, all[n].session_id) << "of the burst";
    EXPECT_EQ(rows[n].stop, n) << "every row has other angles";
  }
  write(9, all, proto::axes_table_text(all));
  EXPECT_EQ(read().value(), all) << "both, and of one mind";
}

TEST_F(AxesReadings, stops_of_a_table_are_counted_by_what_was_commanded) {
  write(6, {}, kHead + "0,15,0,15.01,\n1,15,0,14.99,\n2,15,-20,,\n3,,-20,15,\n4,,-20,16,\n5,15,-20,,\n");
  std::vector<std::uint32_t> stops;
  const Readings rows = read().value();
  for (const AxesReading& reading : rows) stops.push_back(reading.stop);
  EXPECT_EQ(stops, (std::vector<std::uint32_t>{0, 0, 1, 1, 2, 3}));
}

TEST_F(AxesReadings, missing_ones_are_told) {
  Readings all = drawn_readings(2, 6);
  write(6, {});
  EXPECT_EQ(read().error().code, ErrorCode::kAxesMissing);
  const auto lacking = [&] {
    const auto answer = read();
    EXPECT_EQ(answer.error().code, ErrorCode::kAxesMissing);
    return answer ? std::string() : answer.error().detail;
  };
  write(6, {}, kHead + "0,1,1,,\n1,1,1,,\n2,1,1,,\n3,1,1,,\n5,1,1,,\n");
  EXPECT_NE(lacking().find("burst 4: no row of axes.csv"), std::string::npos);
  const AxesReading kept = all[3];
  all.erase(all.begin() + 3);
  write(6, all);
  EXPECT_NE(lacking().find("burst 3: no message"), std::string::npos);
  all.push_back(kept);
  all.back().session_id ^= 1U;
  write(6, all);
  EXPECT_NE(lacking().find("burst 3:"), std::string::npos) << "of another session";
  all.back() = kept;
  all.back().rot_cmd_deg = all.back().rot_read_deg = std::numeric_limits<double>::quiet_NaN();
  write(6, all);
  EXPECT_NE(lacking().find("burst 3:"), std::string::npos) << "says nothing of the rotation";
  all.back() = kept;
  write(6, all);
  EXPECT_TRUE(read()) << "negative control";
}

TEST_F(AxesReadings, channel_and_table_that_differ_are_told_with_the_first_burst) {
  const Readings all = drawn_readings(3, 8);
  test::Random random(4);
  for (int round = 0; round < 20; ++round) {
    Readings changed = all;
    const std::size_t at = random.below(all.size());
    for (std::size_t n = at; n < all.size(); n += 2) {
      double& deg = std::isnan(changed[n].rot_cmd_deg) ? changed[n].rot_read_deg : changed[n].rot_cmd_deg;
      deg = std::nextafter(deg, 0.0);
    }
    write(8, all, proto::axes_table_text(changed));
    const auto answer = read();
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, ErrorCode::kExchangeInvalid);
    EXPECT_NE(answer.error().detail.find("burst " + std::to_string(at) + ":"), std::string::npos);
    EXPECT_FALSE(capture_verify(path_)->clean());
  }
  Readings twice = all;
  twice.push_back(all[5]);
  write(8, twice);
  EXPECT_TRUE(read()) << "the same said twice";
  twice.back().swing_read_deg = 1.25;
  write(8, twice);
  EXPECT_EQ(read().error().code, ErrorCode::kExchangeInvalid);
  write(8, {}, kHead + "0,fifteen,0,,\n");
  EXPECT_EQ(read().error().code, ErrorCode::kExchangeInvalid);
}

TEST_F(AxesReadings, cut_repair_and_diff_treat_them_as_their_bursts) {
  const Readings all = drawn_readings(5, 9);
  for (const Place place : {Place::kBefore, Place::kBehind, Place::kAtTheEnd}) {
    write(9, all, proto::axes_table_text(all), place);
    ASSERT_EQ(capture_cut(path_, other_, 3, 6)->bursts, 4U);
    EXPECT_EQ(read(other_).value(), Readings(all.begin() + 3, all.begin() + 7));
    EXPECT_EQ(open_bursts(other_).value()->info().axes, 4U);
    EXPECT_TRUE(capture_verify(other_)->clean());
    ASSERT_TRUE(capture_repair(path_, other_));
    EXPECT_EQ(read(other_).value(), all);
    EXPECT_FALSE(capture_diff(path_, other_, true)->has_value());
  }
  Readings changed = all;
  changed[4].swing_cmd_deg = 1.5;
  write(9, all);
  ASSERT_TRUE(capture_repair(path_, other_));
  write(9, changed);
  const auto difference = capture_diff(path_, other_).value();
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->field, "axes.deg");
  EXPECT_EQ(difference->burst_index, 4U);
  EXPECT_NE(difference->left.find(",1.5,"), std::string::npos) << difference->left;
}

TEST_F(AxesReadings, of_a_folder_are_those_of_its_import_and_come_back_on_export) {
  const std::string in = folder_ / "in";
  test::make_folder_sample(in, 8);
  // Order, digits and a row less are kept.
  const std::string table = kHead + "4,15.000,-20,14.998,nan\n0,15,-20.0,,\n";
  test::spill(in + "/axes.csv", table);
  ASSERT_TRUE(import_folder(in, path_, "test 1"));
  EXPECT_EQ(open_bursts(path_).value()->info().axes, 2U);
  EXPECT_EQ(open_bursts(in).value()->info().axes, 2U);
  EXPECT_FALSE(capture_diff(in, path_, true)->has_value());
  EXPECT_TRUE(capture_verify(path_)->clean());
  const auto lacking = read();
  EXPECT_NE(lacking.error().detail.find("burst 3:"), std::string::npos);
  ASSERT_TRUE(export_folder(path_, out_));
  EXPECT_EQ(test::slurp(out_ + "/axes.csv"), test::slurp(in + "/axes.csv"));
  // Of a cut only the bursts that are left: what was exported can be imported.
  ASSERT_TRUE(capture_cut(path_, other_, 3, 4));
  ASSERT_TRUE(export_folder(other_, folder_ / "part"));
  const auto part = test::slurp(folder_ / "part/axes.csv");
  EXPECT_EQ(std::string(part.begin(), part.end()), kHead + "4,15,-20,14.998,nan\n");
  EXPECT_TRUE(import_folder(folder_ / "part", folder_ / "again.mcap", "test 1"));
}

TEST_F(AxesReadings, of_an_older_recording_are_exported_from_its_attachment) {
  const Readings all = drawn_readings(6, 3);
  const std::string table = proto::axes_table_text(all);
  write(3, {}, table);
  EXPECT_EQ(open_bursts(path_).value()->info().axes, 0U);
  EXPECT_EQ(count_axes(*open_bursts(path_).value()), 3U);
  ASSERT_TRUE(export_folder(path_, out_));
  const auto exported = test::slurp(out_ + "/axes.csv");
  EXPECT_EQ(std::string(exported.begin(), exported.end()), table);
  // A live recording has no table: it is made from the channel.
  write(3, all);
  ASSERT_TRUE(export_folder(path_, folder_ / "live"));
  EXPECT_EQ(test::slurp(folder_ / "live/axes.csv"), exported);
  write(3, {});
  ASSERT_TRUE(export_folder(path_, folder_ / "none"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none/axes.csv"));
  EXPECT_EQ(count_axes(*open_bursts(path_).value()), 0U);
}

}  // namespace
}  // namespace enamel::host
