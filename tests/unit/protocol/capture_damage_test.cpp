// What happens to recordings: killed writers, full disks, flipped bits, cuts.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "protocol/mcap/reader.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/unit/protocol/sample_capture.hpp"

namespace enamel::capture {
namespace {

using test::collect;
using test::TempFolder;

class Damage : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    auto out = CaptureWriter::create(path_, test::sample_header(), {.compress = GetParam()});
    records_ = test::write_sample(*out, 5);
    ASSERT_TRUE(out->attach("truth/x", "text/plain", proto::Bytes(50, 7)));
    ASSERT_TRUE(out->finish());
    bytes_ = test::slurp(path_);
  }
  void spill_with_a_bit_flipped(std::size_t at, test::Random& random) {
    auto damaged = bytes_;
    damaged[at] ^= static_cast<std::uint8_t>(1U << random.below(8));
    test::spill(path_, damaged);
  }
  TempFolder folder_;
  std::string path_ = folder_ / "c.mcap";
  std::vector<Record> records_;
  std::vector<std::uint8_t> bytes_;
};
INSTANTIATE_TEST_SUITE_P(Compression, Damage, ::testing::Bool());

TEST_P(Damage, a_truncated_file_opens_up_to_its_last_whole_chunk) {
  std::size_t seen = records_.size();
  bool opened_some = false;
  for (std::size_t n = bytes_.size() - 1; n > 0; n -= std::min<std::size_t>(n, 37)) {
    ASSERT_EQ(truncate(path_.c_str(), static_cast<off_t>(n)), 0);
    auto in = CaptureReader::open(path_);
    if (!in) {
      ASSERT_EQ(in.error().code, ErrorCode::kCaptureInvalid) << n << in.error().message();
      continue;
    }
    opened_some = true;
    EXPECT_TRUE(in->info().truncated);
    const auto all = collect(*in);
    EXPECT_TRUE(all.errors.empty()) << n;
    ASSERT_LE(all.records.size(), seen) << "a shorter file may not hold more";
    EXPECT_TRUE(std::equal(all.records.begin(), all.records.end(), records_.begin())) << n;
    EXPECT_EQ(in->rig_text(), test::kRigText);
    const CaptureInfo& info = in->info();
    EXPECT_EQ(info.bursts + info.shed + info.statuses + info.events + info.device_infos, all.records.size());
    seen = all.records.size();
  }
  EXPECT_TRUE(opened_some);
  EXPECT_LT(seen, 5U);
}

/// A bit in the name of a chunk's compression makes another one, which no reader can tell from a later writer's.
bool is_damage(const Error& e) {
  return e.code == ErrorCode::kCaptureCorrupt ||
         (e.code == ErrorCode::kCaptureInvalid && e.detail.find("compression '") != std::string::npos);
}

// Every flipped bit is noticed by at least one check, and never gives a record that was not written.
TEST_P(Damage, a_flipped_bit_is_found_wherever_it_is) {
  test::Random random(3);
  int corrupt = 0;
  for (std::size_t at = 0; at < bytes_.size(); at += 1 + random.below(40)) {
    spill_with_a_bit_flipped(at, random);
    auto in = CaptureReader::open(path_);
    bool found = !in;
    if (in) {
      const auto all = collect(*in);
      for (const Record& r : all.records) {
        ASSERT_NE(std::find(records_.begin(), records_.end(), r), records_.end()) << "byte " << at;
      }
      for (const Error& e : all.errors) EXPECT_TRUE(is_damage(e)) << "byte " << at << ": " << e.message();
      corrupt += all.errors.empty() ? 0 : 1;
      const auto mcap = mcap::Reader::open(path_);
      found = !all.errors.empty() || in->info().truncated || !in->info().problems.empty() ||
              !in->attachment("truth/x") || !mcap->verify_data_section();
    }
    EXPECT_TRUE(found) << "byte " << at << " of " << bytes_.size();
  }
  EXPECT_GT(corrupt, 20);
}

TEST_P(Damage, a_damaged_chunk_is_named_and_the_others_are_read) {
  const auto mcap = mcap::Reader::open(path_);
  ASSERT_EQ(mcap->blocks().size(), 6U);
  const auto& chunk = mcap->blocks()[2];
  bytes_[chunk.offset + chunk.length - 5] ^= 4U;
  test::spill(path_, bytes_);
  auto in = CaptureReader::open(path_);
  ASSERT_TRUE(in);
  const auto all = collect(*in);
  ASSERT_EQ(all.errors.size(), 1U);
  EXPECT_EQ(all.errors[0].code, ErrorCode::kCaptureCorrupt);
  EXPECT_NE(all.errors[0].detail.find("block 2"), std::string::npos) << all.errors[0].detail;
  EXPECT_EQ(all.records.size(), records_.size() - 4);
  EXPECT_TRUE(in->burst_with_id({12}).has_value());
  EXPECT_EQ(in->burst_with_id({14}).error().code, ErrorCode::kCaptureCorrupt);
}

// Of a damaged file everything outside of the damaged place is delivered, and what is missing is counted.
TEST_P(Damage, a_flipped_bit_costs_no_more_than_the_chunk_it_is_in) {
  test::Random random(17);
  const auto whole = mcap::Reader::open(path_);
  const auto is_burst = [](const Record& r) { return std::holds_alternative<proto::Burst>(r.value); };
  for (int i = 0; i < 3000; ++i) {
    const std::size_t at = random.below(bytes_.size());
    spill_with_a_bit_flipped(at, random);
    auto in = CaptureReader::open(path_);
    ASSERT_TRUE(in) << "byte " << at << ": " << in.error().message();
    const auto all = collect(*in);
    const auto bursts = static_cast<std::uint64_t>(std::count_if(all.records.begin(), all.records.end(), is_burst));
    const bool in_a_block = std::any_of(whole->blocks().begin(), whole->blocks().end(), [&](const mcap::Block& b) {
      return at >= b.offset && at < b.offset + b.length;
    });
    EXPECT_EQ(bursts + in->bursts_lost(), 5U) << "byte " << at;
    EXPECT_LE(in->bursts_lost(), in_a_block ? 1U : 0U) << "byte " << at;
    EXPECT_EQ(in->info().bursts, 5U) << "byte " << at;
  }
}

// The same where the file has no end either: what a killed writer left, damaged later.
TEST_P(Damage, a_flipped_bit_in_a_truncated_file_costs_no_more) {
  test::Random random(18);
  const auto whole = mcap::Reader::open(path_);
  const mcap::Block last = whole->blocks()[3];
  bytes_.resize(last.offset + last.length + 700);
  for (int i = 0; i < 1000; ++i) {
    const std::size_t at = random.below(bytes_.size() - 700);
    spill_with_a_bit_flipped(at, random);
    auto in = CaptureReader::open(path_);
    ASSERT_TRUE(in) << "byte " << at << ": " << in.error().message();
    const auto all = collect(*in);
    std::uint64_t bursts = 0;
    for (const Record& r : all.records) {
      if (std::holds_alternative<proto::Burst>(r.value)) ++bursts;
      EXPECT_NE(std::find(records_.begin(), records_.end(), r), records_.end()) << "byte " << at;
    }
    EXPECT_GE(bursts, 3U) << "byte " << at;
  }
}

// Random rubbish between the right magics, and rubbish with a right first part: an answer, never a crash.
TEST_P(Damage, rubbish_is_an_error) {
  test::Random random(8);
  for (int i = 0; i < 400; ++i) {
    auto damaged = bytes_;
    const std::size_t begin = 8 + random.below(damaged.size() - 16);
    const std::size_t end = std::min(damaged.size() - 8, begin + 1 + random.below(60));
    for (std::size_t k = begin; k < end; ++k) damaged[k] = random.number<std::uint8_t>();
    if (i % 3 == 0) damaged.resize(damaged.size() - 1 - random.below(200));
    test::spill(path_, damaged);
    auto in = CaptureReader::open(path_);
    if (!in) continue;
    for (const Record& r : collect(*in).records) {
      EXPECT_NE(std::find(records_.begin(), records_.end(), r), records_.end());
    }
  }
}

TEST_P(Damage, a_killed_writer_loses_at_most_the_burst_in_hand) {
  const pid_t child = fork();
  if (child == 0) {
    auto out = CaptureWriter::create(path_, test::sample_header(), {.compress = GetParam()});
    for (std::uint64_t i = 0; i < 7; ++i) static_cast<void>(out->write_burst(test::camera_burst(i, 16, 12), 1));
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  auto in = CaptureReader::open(path_);
  ASSERT_TRUE(in) << in.error().message();
  EXPECT_TRUE(in->info().truncated);
  EXPECT_GE(in->info().bursts, 6U);
  EXPECT_EQ(in->rig_text(), test::kRigText);
  EXPECT_EQ(in->burst(5).value(), test::camera_burst(5, 16, 12));
}

TEST_P(Damage, a_full_disk_is_reported_once_and_what_was_written_stays_readable) {
  signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  auto out = CaptureWriter::create(path_, test::sample_header(), {.compress = GetParam()});
  ASSERT_TRUE(out);
  rlimit limit = before;
  limit.rlim_cur = std::filesystem::file_size(path_) + 6000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  int errors = 0;
  std::uint64_t written = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto result = out->write_burst(test::camera_burst(i, 16, 12), 1);
    if (!result) {
      EXPECT_EQ(result.error().code, ErrorCode::kFileWrite);
      ++errors;
    } else if (!out->failed()) {
      ++written;
    }
  }
  const auto finished = out->finish();
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(errors, 1);
  EXPECT_TRUE(out->failed());
  EXPECT_EQ(out->dropped(), 20 - written - 1);
  EXPECT_EQ(finished.error().code, ErrorCode::kFileWrite);
  ASSERT_GT(written, 0U);
  auto in = CaptureReader::open(path_);
  ASSERT_TRUE(in) << in.error().message();
  EXPECT_TRUE(in->info().truncated);
  EXPECT_EQ(in->info().bursts, written);
  EXPECT_EQ(in->burst(written - 1).value(), test::camera_burst(written - 1, 16, 12));
}

TEST(FullDisk, is_reported_at_creation_too) {
  const auto out = CaptureWriter::create("/dev/full", {});
  ASSERT_FALSE(out);
  EXPECT_EQ(out.error().code, ErrorCode::kFileWrite);
}

}  // namespace
}  // namespace enamel::capture
