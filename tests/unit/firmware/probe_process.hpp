// A real enamel-probe as a child process, and a small host to talk to it.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "protocol/base/clock.hpp"
#include "protocol/dds/participant.hpp"
#include "protocol/dds/topics.hpp"

namespace enamel::fw::test {

/// Killed when it goes out of scope.
class ProbeProcess {
 public:
  explicit ProbeProcess(const std::vector<std::string>& args) {
    int fds[2] = {-1, -1};
    if (pipe(fds) != 0) return;
    pid_ = fork();
    if (pid_ == 0) {
      dup2(fds[1], STDOUT_FILENO);
      close(fds[0]);
      close(fds[1]);
      std::vector<std::string> full{ENAMEL_BIN_DIR "/enamel-probe"};
      full.insert(full.end(), args.begin(), args.end());
      std::vector<char*> argv;
      argv.reserve(full.size() + 1);
      for (std::string& a : full) argv.push_back(a.data());
      argv.push_back(nullptr);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(fds[1]);
    out_ = fds[0];
  }
  ~ProbeProcess() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    if (out_ >= 0) close(out_);
  }
  ProbeProcess(const ProbeProcess&) = delete;
  ProbeProcess& operator=(const ProbeProcess&) = delete;

  void signal(int number) const { kill(pid_, number); }
  /// Exit code, after the process has ended by itself; -1 when a signal ended it.
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  /// What it printed on stdout; call after wait().
  std::string output() {
    std::string text;
    char buffer[4096];
    for (ssize_t n = read(out_, buffer, sizeof buffer); n > 0; n = read(out_, buffer, sizeof buffer)) {
      text.append(buffer, static_cast<std::size_t>(n));
    }
    return text;
  }

 private:
  pid_t pid_ = -1;
  int out_ = -1;
};

inline int run_to_end(const std::vector<std::string>& args) {
  ProbeProcess probe(args);
  return probe.wait();
}

class TestHost {
 public:
  explicit TestHost(const std::string& tag)
      : participant(*dds::Participant::create({77, tag})),
        infos(*dds::Reader<proto::DeviceInfo>::create(participant)),
        statuses(*dds::Reader<proto::Status>::create(participant)),
        events(*dds::Reader<proto::Event>::create(participant)),
        replies(*dds::Reader<proto::CommandReply>::create(participant)),
        bursts(*dds::Reader<proto::Burst>::create(participant)),
        sync_replies(*dds::Reader<proto::TimeSyncRep>::create(participant)),
        commands(*dds::Writer<proto::Command>::create(participant)),
        sync_requests(*dds::Writer<proto::TimeSyncReq>::create(participant)) {}

  /// Takes what there is; true when `done` holds, false after 30 s.
  template <class F>
  bool until(F&& done) {
    const auto give_up = clock.now() + std::chrono::seconds(30);
    while (!done()) {
      if (clock.now() > give_up) return false;
      poll();
      clock.sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }
  void poll() {
    take(infos, seen_infos);
    take(statuses, seen_statuses);
    take(events, seen_events);
    take(replies, seen_replies);
    take(bursts, seen_bursts);
    take(sync_replies, seen_syncs);
  }
  bool find(std::size_t n = 1) {
    return until([&] { return seen_infos.size() >= n && commands.peers().matched >= static_cast<int>(n); });
  }
  /// Sends until answered.
  std::optional<proto::CommandReply> command(std::uint32_t probe_id, proto::Opcode opcode, std::int64_t arg = 0) {
    proto::Command c;
    c.probe_id = probe_id;
    c.cmd_id = next_id++;
    c.client_id = 42;
    c.opcode = opcode;
    c.arg_i[0] = arg;
    std::optional<proto::CommandReply> answer;
    auto next_send = clock.now();
    (void)until([&] {
      if (clock.now() >= next_send) {
        (void)commands.write(c);
        next_send = clock.now() + std::chrono::milliseconds(200);
      }
      for (const auto& r : seen_replies) {
        if (r.probe_id == probe_id && r.cmd_id == c.cmd_id) answer = r;
      }
      return answer.has_value();
    });
    return answer;
  }
  [[nodiscard]] const proto::Status* last_status(std::uint32_t probe_id) const {
    const auto of_probe = [&](const proto::Status& s) { return s.probe_id == probe_id; };
    const auto last = std::find_if(seen_statuses.rbegin(), seen_statuses.rend(), of_probe);
    return last != seen_statuses.rend() ? &*last : nullptr;
  }
  bool wait_state(std::uint32_t probe_id, proto::ProbeState state) {
    return until([&] {
      const proto::Status* s = last_status(probe_id);
      return s != nullptr && s->state == state;
    });
  }
  bool start_scan(std::uint32_t probe_id, std::int64_t session) {
    const auto ok = [](const auto& r) { return r && r->status == proto::ReplyStatus::kOk; };
    if (!wait_state(probe_id, proto::ProbeState::kIdle)) return false;
    if (!ok(command(probe_id, proto::Opcode::kSessionOpen))) return false;
    if (!ok(command(probe_id, proto::Opcode::kWarmup))) return false;
    if (!wait_state(probe_id, proto::ProbeState::kReady)) return false;
    return ok(command(probe_id, proto::Opcode::kScanStart, session));
  }
  [[nodiscard]] bool told(std::uint16_t code) const {
    for (const auto& e : seen_events) {
      if (e.code == code) return true;
    }
    return false;
  }

  SteadyClock clock;
  dds::Participant participant;
  dds::Reader<proto::DeviceInfo> infos;
  dds::Reader<proto::Status> statuses;
  dds::Reader<proto::Event> events;
  dds::Reader<proto::CommandReply> replies;
  dds::Reader<proto::Burst> bursts;
  dds::Reader<proto::TimeSyncRep> sync_replies;
  dds::Writer<proto::Command> commands;
  dds::Writer<proto::TimeSyncReq> sync_requests;
  std::vector<proto::DeviceInfo> seen_infos;
  std::vector<proto::Status> seen_statuses;
  std::vector<proto::Event> seen_events;
  std::vector<proto::CommandReply> seen_replies;
  std::vector<proto::Burst> seen_bursts;
  std::vector<proto::TimeSyncRep> seen_syncs;
  std::uint64_t next_id = 1;

 private:
  template <class T>
  static void take(dds::Reader<T>& reader, std::vector<T>& into) {
    auto taken = reader.take(64);
    ASSERT_TRUE(taken.has_value());
    for (auto& r : *taken) {
      ASSERT_TRUE(r.valid);
      into.push_back(std::move(r.value));
    }
  }
};

}  // namespace enamel::fw::test
