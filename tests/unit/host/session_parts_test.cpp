// A session scanned in several goes reads as one recording.
#include <gtest/gtest.h>

#include <filesystem>

#include "host/record/session_stream.hpp"
#include "host/session/recorded_counts.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::host {
namespace {

constexpr const char* kRig = "{\"format\": \"rig/1\"}\n";

class SessionParts : public ::testing::Test {
 protected:
  /// `bursts` bursts of session `id`, numbered from 0, and a last status that tells of `begun`.
  void write(const std::string& name, std::uint32_t id, std::uint64_t bursts, std::uint32_t begun,
             const std::string& rig = kRig) {
    auto out = capture::CaptureWriter::create(folder_ / name, {rig, "test", {{"serial", "P1"}}});
    ASSERT_TRUE(out);
    for (std::uint64_t n = 0; n < bursts; ++n) {
      proto::Burst burst = test::camera_burst(n, 16, 12);
      burst.session_id = id;
      burst.burst_seq = n;
      ASSERT_TRUE(out->write_burst(burst, static_cast<std::int64_t>(n)));
    }
    proto::Status status;
    status.session_id = id;
    status.bursts_begun = status.bursts_emitted = begun;
    ASSERT_TRUE(out->write_status(status, static_cast<std::int64_t>(bursts)));
    ASSERT_TRUE(out->finish());
  }
  test::TempFolder folder_;
};

TEST_F(SessionParts, read_as_one_and_are_counted_apart) {
  write("capture.mcap", 4, 3, 5);
  write("capture-2.mcap", 9, 6, 6);
  write("capture-4.mcap", 9, 1, 1);  // a part is missing in front of it: not of this session
  EXPECT_EQ(session_parts(folder_ / "").size(), 2U);
  EXPECT_EQ(std::filesystem::path(next_part(folder_ / "")).filename(), "capture-3.mcap");
  const auto stream = open_bursts(folder_ / "");
  ASSERT_TRUE(stream) << stream.error().message();
  EXPECT_EQ((*stream)->info().bursts, 9U);
  EXPECT_EQ((*stream)->rig_text(), kRig);
  LossLedger ledger;
  RecordedCounts counts(ledger);
  for (auto record = (*stream)->next(); record && *record; record = (*stream)->next()) {
    if (counts.take(**record) == nullptr) continue;
    ledger.accepted();
    ledger.fused();
  }
  const BurstCounts sum = ledger.counts();
  EXPECT_EQ(sum.captured, 11U) << "five and six: the two that nobody received are counted once";
  EXPECT_EQ(sum.lost_on_wire, 2U);
  EXPECT_EQ(counts.session_id(), 9U);
  (*stream)->rewind();
  EXPECT_TRUE((*stream)->next()->has_value());
}

TEST_F(SessionParts, of_probes_that_are_calibrated_differently_are_no_session) {
  write("capture.mcap", 4, 1, 1);
  write("capture-2.mcap", 5, 1, 1, "{\"format\": \"rig/1\", \"serial\": \"other\"}\n");
  EXPECT_EQ(open_bursts(folder_ / "").error().code, ErrorCode::kRigForeign);
}

TEST_F(SessionParts, a_last_part_that_was_killed_before_its_first_burst_is_nothing) {
  write("capture.mcap", 4, 2, 2);
  auto bytes = test::slurp(folder_ / "capture.mcap");
  bytes.resize(12);
  test::spill(folder_ / "capture-2.mcap", bytes);
  const auto stream = open_bursts(folder_ / "");
  ASSERT_TRUE(stream) << stream.error().message();
  EXPECT_EQ((*stream)->info().bursts, 2U);
  test::spill(folder_ / "capture.mcap", bytes);
  EXPECT_EQ(open_bursts(folder_ / "").error().code, ErrorCode::kCaptureInvalid) << "control: the first one is needed";
}

}  // namespace
}  // namespace enamel::host
