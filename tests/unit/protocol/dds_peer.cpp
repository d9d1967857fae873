// The other process of the transport tests.
//   dds_peer send TAG COUNT WIDTH HEIGHT PERIOD_US   sends that many bursts to the first reader that comes
//   dds_peer idle TAG SEQ                            publishes one status, listens for commands, waits to be killed
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "protocol/dds/topics.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace {

using namespace enamel;
using namespace std::chrono_literals;

int complain(const Error& error) {
  std::fputs((error.message() + "\n").c_str(), stderr);
  return 1;
}

int send(const dds::Participant& participant, int count, int width, int height, int period_us) {
  auto writer = dds::Writer<proto::Burst>::create(participant);
  if (!writer) return complain(writer.error());
  while (writer->peers().matched == 0) std::this_thread::sleep_for(5ms);
  int refused = 0;
  auto due = std::chrono::steady_clock::now();
  for (int i = 0; i < count; ++i) {
    std::this_thread::sleep_until(due);
    due += std::chrono::microseconds(period_us);
    const proto::Burst burst = test::camera_burst(static_cast<std::uint64_t>(i % 8), width, height);
    proto::Burst numbered = burst;
    numbered.burst_seq = static_cast<std::uint64_t>(i);
    // A refused burst was not sent: here it is offered again until there is room.
    for (auto result = writer->write(numbered); !result; result = writer->write(numbered)) {
      if (result.error().code != ErrorCode::kDds || ++refused > 100) return complain(result.error());
    }
  }
  std::printf("refused %d\n", refused);
  return writer->wait_acknowledged(30s) ? 0 : 2;
}

int idle(const dds::Participant& participant, int seq) {
  auto statuses = dds::Writer<proto::Status>::create(participant);
  auto commands = dds::Reader<proto::Command>::create(participant);
  if (!statuses || !commands) return complain(statuses ? commands.error() : statuses.error());
  proto::Status status;
  status.seq = static_cast<std::uint32_t>(seq);
  if (auto result = statuses->write(status); !result) return complain(result.error());
  std::this_thread::sleep_for(30s);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 1;
  const std::string mode = argv[1];
  const auto participant = dds::Participant::create({.tag = argv[2]});
  if (!participant) return complain(participant.error());
  if (mode == "send" && argc == 7) {
    return send(*participant, std::atoi(argv[3]), std::atoi(argv[4]), std::atoi(argv[5]), std::atoi(argv[6]));
  }
  return mode == "idle" ? idle(*participant, std::atoi(argv[3])) : 1;
}
