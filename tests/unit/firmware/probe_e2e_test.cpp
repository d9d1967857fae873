// The real program, a real recording, real DDS on loopback.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <span>

#include "firmware/storage/scan_lock.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/capture/capture.hpp"
#include "tests/unit/firmware/probe_process.hpp"

namespace enamel::fw::test {
namespace {

using proto::Opcode;
using proto::ProbeState;

constexpr int kBursts = 40;

std::uint32_t crc_of(const std::string& text) { return crc32(std::as_bytes(std::span(text))); }

/// Noise pictures at times with odd nanoseconds: nothing can agree by accident.
proto::Burst noise_burst(std::uint64_t i, std::uint32_t rig_crc) {
  std::mt19937_64 random(i + 1);
  proto::Burst b;
  b.burst_index = i + 5;
  b.width = 64;
  b.height = 48;
  b.temp_centi_c = static_cast<std::int16_t>(3200 + static_cast<int>(i));
  b.calib_crc32 = rig_crc;
  const std::uint64_t t0 = 1'000'000'007 + i * 33'333'333 + i * i;
  const std::size_t size = std::size_t{b.width} * b.height;
  for (std::size_t k = 0; k < 4; ++k) {
    proto::FrameMeta m;
    m.pattern_index = static_cast<std::uint8_t>(k);
    m.exposure_us = 3700;
    m.t_strobe_ns = t0 + k * 4'004'001;
    m.offset = static_cast<std::uint32_t>(k * size);
    m.length = static_cast<std::uint32_t>(size);
    b.meta.push_back(m);
    for (std::size_t p = 0; p < size; ++p) b.payload.push_back(static_cast<std::uint8_t>(random() & 0xFFU));
  }
  b.payload_crc32 = crc32(std::as_bytes(std::span(std::as_const(b.payload))));
  return b;
}

class ProbeE2e : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    tag = std::string("fw-") + test->name() + "-" + std::to_string(getpid());
    path = testing::TempDir() + tag + ".mcap";
    capture::CaptureHeader header;
    header.rig_text = rig;
    auto writer = capture::CaptureWriter::create(path, header);
    ASSERT_TRUE(writer.has_value());
    for (std::uint64_t i = 0; i < kBursts; ++i) {
      recorded.push_back(noise_burst(i, crc_of(rig)));
      ASSERT_TRUE(writer->write_burst(recorded.back(), static_cast<std::int64_t>(i)).has_value());
    }
    ASSERT_TRUE(writer->finish().has_value());
  }
  void TearDown() override { std::filesystem::remove(path); }
  [[nodiscard]] std::vector<std::string> args(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"--play", path, "--dds-tag", tag, "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  static void expect_conserved(const proto::Status& s) {
    std::uint32_t dropped = 0;
    for (const std::uint32_t d : s.dropped) dropped += d;
    EXPECT_EQ(s.bursts_begun, s.bursts_emitted + dropped);
  }

  std::string tag, path;
  std::string rig = "{\"format\": \"rig/1\", \"of\": \"e2e\"}";
  std::vector<proto::Burst> recorded;
};

TEST_F(ProbeE2e, plays_a_recording_bit_identically_and_ends_the_session) {
  ProbeProcess probe(args({"--serial", "E2E-1"}));
  TestHost host(tag);
  ASSERT_TRUE(host.find());
  const proto::DeviceInfo& info = host.seen_infos.front();
  EXPECT_EQ(info.serial, "E2E-1");
  EXPECT_EQ(info.probe_id, crc_of("E2E-1"));
  EXPECT_EQ(std::string(info.calibration_blob.begin(), info.calibration_blob.end()), rig);
  ASSERT_TRUE(host.start_scan(info.probe_id, 77));
  auto next_ping = host.clock.now();
  ASSERT_TRUE(host.until([&] {
    if (host.clock.now() >= next_ping) {
      (void)host.command(info.probe_id, Opcode::kPing);
      next_ping = host.clock.now() + std::chrono::seconds(1);
    }
    return host.told(proto::kEventSessionEnded) && host.last_status(info.probe_id)->bursts_begun == kBursts;
  }));
  ASSERT_EQ(host.seen_bursts.size(), std::size_t{kBursts});
  const std::int64_t shift =
      static_cast<std::int64_t>(host.seen_bursts[0].meta[0].t_strobe_ns - recorded[0].meta[0].t_strobe_ns);
  const proto::Status& last = *host.last_status(info.probe_id);
  const bool real_time = !host.told(proto::kEventTimeStretched);
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const proto::Burst& got = host.seen_bursts[i];
    EXPECT_TRUE(proto::is_consistent(got));
    EXPECT_EQ(got.payload, recorded[i].payload);
    EXPECT_EQ(got.burst_index, recorded[i].burst_index);
    EXPECT_EQ(got.burst_seq, i);
    EXPECT_EQ(got.session_id, 77U);
    EXPECT_EQ(got.temp_centi_c, recorded[i].temp_centi_c);
    EXPECT_EQ(got.calib_crc32, crc_of(rig));
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(got.meta[k].t_strobe_ns - got.meta[0].t_strobe_ns,
                recorded[i].meta[k].t_strobe_ns - recorded[i].meta[0].t_strobe_ns);
      if (real_time) {
        EXPECT_EQ(static_cast<std::int64_t>(got.meta[k].t_strobe_ns - recorded[i].meta[k].t_strobe_ns), shift);
      }
    }
  }
  EXPECT_EQ(last.session_id, 77U);
  EXPECT_EQ(last.bursts_emitted, std::uint32_t{kBursts});
  expect_conserved(last);
  EXPECT_EQ(last.state, ProbeState::kIdle);
  EXPECT_EQ(last.led_ma, 0);
  (void)host.command(info.probe_id, Opcode::kSessionClose);
  EXPECT_EQ(probe.wait(), 0);
  const auto summary = nlohmann::json::parse(probe.output());
  EXPECT_EQ(summary["begun"], kBursts);
  EXPECT_EQ(summary["emitted"], kBursts);
  EXPECT_EQ(summary["under_way"], 0);
}

TEST_F(ProbeE2e, a_host_that_comes_late_finds_the_final_status) {
  ProbeProcess probe(args({"--speed", "4"}));
  {
    TestHost host(tag);
    ASSERT_TRUE(host.find());
    ASSERT_TRUE(host.start_scan(host.seen_infos[0].probe_id, 3));
    ASSERT_TRUE(host.until([&] { return host.told(proto::kEventSessionEnded); }));
  }
  // Cyclone wants one participant configuration per process: the late host is the same process, with new readers.
  TestHost late(tag);
  ASSERT_TRUE(late.until([&] { return !late.seen_statuses.empty() && late.told(proto::kEventSessionEnded); }));
  EXPECT_EQ(late.seen_statuses.back().bursts_begun, std::uint32_t{kBursts});
  expect_conserved(late.seen_statuses.back());
}

TEST_F(ProbeE2e, pauses_with_the_light_off_within_three_seconds_of_the_hosts_last_word) {
  ProbeProcess probe(args({"--loops", "100"}));
  TestHost host(tag);
  ASSERT_TRUE(host.find());
  const std::uint32_t id = host.seen_infos[0].probe_id;
  ASSERT_TRUE(host.start_scan(id, 1));
  ASSERT_TRUE(host.wait_state(id, ProbeState::kScanning));
  const auto last_word = host.command(id, Opcode::kPing);  // then silence, as of a killed host
  ASSERT_TRUE(last_word.has_value());
  ASSERT_TRUE(host.wait_state(id, ProbeState::kPaused));
  // The burst that was under way at the pause is still being published.
  static_cast<void>(
      host.until([&] { return host.last_status(id)->bursts_begun == host.last_status(id)->bursts_emitted; }));
  const proto::Status& paused = *host.last_status(id);
  EXPECT_EQ(paused.led_ma, 0);
  for (const auto& e : host.seen_events) {
    if (e.code == static_cast<std::uint16_t>(ProbeState::kPaused)) {
      EXPECT_LE(e.t_ns - last_word->t_ns, 3'000'000'000U);  // device clock
    }
  }
  expect_conserved(paused);
  EXPECT_EQ(paused.bursts_begun, paused.bursts_emitted);  // the pause lost nothing
  const auto back = host.command(id, Opcode::kSessionOpen);
  EXPECT_EQ(back->status, proto::ReplyStatus::kOk);
  EXPECT_EQ(host.command(id, Opcode::kScanStart, 1)->status, proto::ReplyStatus::kOk);
  EXPECT_TRUE(host.wait_state(id, ProbeState::kScanning));
}

TEST_F(ProbeE2e, sigterm_switches_the_light_off_says_so_and_exits_cleanly) {
  ProbeProcess probe(args({"--loops", "100"}));
  TestHost host(tag);
  ASSERT_TRUE(host.find());
  const std::uint32_t id = host.seen_infos[0].probe_id;
  ASSERT_TRUE(host.start_scan(id, 1));
  ASSERT_TRUE(host.until([&] { return host.seen_bursts.size() > 5; }));
  const HostTime asked = host.clock.now();
  probe.signal(SIGTERM);
  EXPECT_EQ(probe.wait(), 0);
  RecordProperty("exit_ms", static_cast<int>((host.clock.now() - asked).count() / 1'000'000));
  host.poll();
  EXPECT_EQ(host.last_status(id)->led_ma, 0);
  EXPECT_FALSE(probe.output().empty());
}

TEST_F(ProbeE2e, two_probes_are_told_apart_and_commanded_apart) {
  ProbeProcess one(args({"--serial", "A"}));
  ProbeProcess two(args({"--serial", "B"}));
  TestHost host(tag);
  ASSERT_TRUE(host.find(2));
  const std::uint32_t a = crc_of("A");
  const std::uint32_t b = crc_of("B");
  EXPECT_NE(a, b);
  ASSERT_TRUE(host.wait_state(b, ProbeState::kIdle));
  ASSERT_TRUE(host.start_scan(a, 1));
  ASSERT_TRUE(host.until([&] { return host.seen_bursts.size() > 3; }));
  for (const auto& burst : host.seen_bursts) EXPECT_EQ(burst.probe_id, a);
  EXPECT_EQ(host.last_status(b)->state, ProbeState::kIdle);
}

TEST_F(ProbeE2e, answers_clock_exchanges) {
  ProbeProcess probe(args({}));
  TestHost host(tag);
  ASSERT_TRUE(host.find());
  ASSERT_TRUE(host.until([&] { return host.sync_requests.peers().matched > 0; }));
  const std::uint32_t id = host.seen_infos[0].probe_id;
  std::uint32_t seq = 0;
  ASSERT_TRUE(host.until([&] {
    (void)host.sync_requests.write({id, ++seq, 42, to_ns(host.clock.now())});
    return !host.seen_syncs.empty();
  }));
  const proto::TimeSyncRep& r = host.seen_syncs.front();
  EXPECT_EQ(r.client_id, 42U);
  EXPECT_GE(r.t2_probe_ns, r.t1_host_ns);  // one machine, one monotonic clock
  EXPECT_GE(r.t3_probe_ns, r.t2_probe_ns);
  EXPECT_LE(r.t3_probe_ns, to_ns(host.clock.now()));
}

TEST_F(ProbeE2e, scans_and_updates_keep_each_other_out) {
  const std::string lock_path = path + ".lock";
  ProbeProcess probe(args({"--scan-lock", lock_path, "--loops", "1000"}));
  TestHost host(tag);
  ASSERT_TRUE(host.find());
  const std::uint32_t id = host.seen_infos.front().probe_id;
  const auto updater = ScanLock::open(lock_path);
  ASSERT_TRUE(updater.has_value());
  ASSERT_TRUE(host.wait_state(id, ProbeState::kIdle));
  EXPECT_TRUE((*updater)->take());
  EXPECT_TRUE(host.wait_state(id, ProbeState::kUpdating));
  EXPECT_TRUE(host.command(id, Opcode::kSessionOpen).has_value());
  EXPECT_EQ(host.command(id, Opcode::kWarmup)->status, proto::ReplyStatus::kBadState);
  EXPECT_EQ(run_to_end({"--self-test", "--dds-tag", tag, "--seconds", "10"}), 3) << "not in an update";
  (*updater)->release();
  ASSERT_TRUE(host.start_scan(id, 5));
  EXPECT_FALSE((*updater)->take()) << "the probe scans";
  EXPECT_EQ(host.command(id, Opcode::kScanStop)->status, proto::ReplyStatus::kOk);
  EXPECT_TRUE(host.wait_state(id, ProbeState::kReady));
  EXPECT_TRUE((*updater)->take());
  std::filesystem::remove(lock_path);
}

TEST_F(ProbeE2e, the_self_test_asks_the_probe_that_runs) {
  const std::vector<std::string> ask{"--self-test", "--dds-tag", tag, "--serial", "E2E-2", "--seconds", "10"};
  std::vector<std::string> short_of_time = ask;
  short_of_time.back() = "1";
  EXPECT_EQ(run_to_end(short_of_time), 3) << "no probe runs";
  ProbeProcess probe(args({"--serial", "E2E-2", "--loops", "1000"}));
  EXPECT_EQ(run_to_end(ask), 0) << "also while it is still starting";
  TestHost host(tag);
  ASSERT_TRUE(host.find());
  const std::uint32_t id = host.seen_infos.front().probe_id;
  ASSERT_TRUE(host.wait_state(id, ProbeState::kIdle));
  host.seen_events.clear();
  EXPECT_EQ(run_to_end(ask), 0);
  EXPECT_TRUE(host.until([&] { return host.told(static_cast<std::uint16_t>(ProbeState::kSelftest)); }))
      << "the probe went through SELFTEST";
  ASSERT_TRUE(host.start_scan(id, 5));
  EXPECT_EQ(run_to_end(ask), 3) << "a person scans with it";
}

TEST_F(ProbeE2e, the_check_measures_a_player_and_writes_its_picture) {
  const std::string picture = path + ".pgm";
  ProbeProcess probe({"--play", path, "--loops", "20", "--check", "--json", "--picture", picture});
  EXPECT_EQ(probe.wait(), 0);
  const auto report = nlohmann::json::parse(probe.output());
  EXPECT_TRUE(report["good"]);
  EXPECT_EQ(report["findings"].size(), 6U);
  EXPECT_GT(std::filesystem::file_size(picture), recorded[0].payload.size());
  std::filesystem::remove(picture);
}

TEST_F(ProbeE2e, refuses_a_recording_whose_bursts_name_another_calibration) {
  capture::CaptureHeader header;
  header.rig_text = "{\"format\": \"rig/1\", \"of\": \"another\"}";
  auto writer = capture::CaptureWriter::create(path, header);
  ASSERT_TRUE(writer.has_value());
  ASSERT_TRUE(writer->write_burst(recorded[0], 0).has_value());
  ASSERT_TRUE(writer->finish().has_value());
  EXPECT_EQ(run_to_end(args({})), 2);
}

}  // namespace
}  // namespace enamel::fw::test
