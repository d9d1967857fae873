// One end of a link under test: sends or receives bursts through the product's own topics and link profiles.
// usage: link_peer send|receive LINK|- SECONDS RATE [WIDTH HEIGHT]                                     default: 640 480
// LINK: as --link; -: what CYCLONEDDS_URI says. The receiver ends a second after the last burst it gets and prints one
// JSON object: bursts, distinct, out_of_order, damaged, latency_ms {p50, p99, max} from before write() to the callback.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <set>
#include <span>
#include <string>

#include "protocol/base/clock.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/dds/participant.hpp"
#include "protocol/dds/topics.hpp"

namespace {

using namespace enamel;
using namespace std::chrono_literals;

constexpr Nanoseconds kPatience = 20s;
constexpr int kQueue = 3;  // bursts that the probe's queue holds before it sheds

int report(const Error& error) {
  std::fprintf(stderr, "%s\n", error.message().c_str());
  return 1;
}

struct Load {
  double seconds = 0, rate = 0;
  std::uint16_t width = 640, height = 480;
};

proto::Burst burst(const Load& load) {
  proto::Burst b;
  b.width = load.width;
  b.height = load.height;
  std::mt19937 random(1);
  b.payload.resize(std::size_t{4} * load.width * load.height);
  for (auto& v : b.payload) v = static_cast<std::uint8_t>(random());
  b.payload_crc32 = crc32(std::as_bytes(std::span<const std::uint8_t>(b.payload)));
  return b;
}

Result<int> send(const dds::Participant& participant, const Load& load) {
  ENAMEL_TRY_ASSIGN(auto writer, dds::Writer<proto::Burst>::create(participant));
  SteadyClock clock;
  const HostTime patience = clock.now() + kPatience;
  while (writer.peers().matched == 0) {
    if (clock.now() > patience) return fail(ErrorCode::kDds, "no receiver");
    clock.sleep_for(5ms);
  }
  proto::Burst b = burst(load);
  const Nanoseconds period{static_cast<std::int64_t>(1e9 / load.rate)};
  const HostTime begin = clock.now();
  int shed = 0;
  for (int k = 0; k < static_cast<int>(load.seconds * load.rate); ++k) {
    const HostTime due = begin + period * k;
    if (clock.now() > due + period * kQueue) {
      ++shed;
      continue;
    }
    clock.sleep_until(due);
    b.burst_index = static_cast<std::uint64_t>(k);
    b.t_publish_ns = static_cast<std::uint64_t>(to_ns(clock.now()));
    if (!writer.write(b)) ++shed;  // no room for a second: the probe sheds then, too
  }
  static_cast<void>(writer.wait_acknowledged(5s));
  std::fprintf(stderr, "shed %d\n", shed);
  return 0;
}

double percentile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

Result<int> receive(const dds::Participant& participant, const Load& load) {
  ENAMEL_TRY_ASSIGN(auto reader, dds::Reader<proto::Burst>::create(participant));
  SteadyClock clock;
  HostTime end = clock.now() + kPatience;
  const HostTime latest = clock.now() + kPatience + Nanoseconds{static_cast<std::int64_t>((load.seconds + 10) * 1e9)};
  std::set<std::uint64_t> seen;
  std::vector<double> latency_ms;
  int bursts = 0, out_of_order = 0, damaged = 0;
  while (clock.now() < std::min(end, latest)) {
    if (reader.wait(100ms) != dds::Wake::kData) continue;
    const HostTime now = clock.now();
    ENAMEL_TRY_ASSIGN(const auto taken, reader.take());
    for (const auto& one : taken) {
      const proto::Burst& b = one.value;
      ++bursts;
      if (!one.valid || crc32(std::as_bytes(std::span<const std::uint8_t>(b.payload))) != b.payload_crc32) ++damaged;
      if (!seen.empty() && b.burst_index < *seen.rbegin()) ++out_of_order;
      seen.insert(b.burst_index);
      latency_ms.push_back(static_cast<double>(to_ns(now) - static_cast<std::int64_t>(b.t_publish_ns)) * 1e-6);
      end = now + 1s;
    }
  }
  std::sort(latency_ms.begin(), latency_ms.end());
  std::printf(
      "{\"bursts\": %d, \"distinct\": %zu, \"out_of_order\": %d, \"damaged\": %d, "
      "\"latency_ms\": {\"p50\": %.1f, \"p99\": %.1f, \"max\": %.1f}}\n",
      bursts, seen.size(), out_of_order, damaged, percentile(latency_ms, 0.5), percentile(latency_ms, 0.99),
      percentile(latency_ms, 1));
  return 0;
}

Result<int> run(const std::string& what, const std::string& link, const Load& load) {
  dds::LinkChoice choice;
  choice.tag = "enamel-link-test";
  if (link != "-") choice.link = link;
  ENAMEL_TRY_ASSIGN(const auto options, dds::participant_options(choice, dds::LinkEnd::kProbe));
  ENAMEL_TRY_ASSIGN(const auto participant, dds::Participant::create(options));
  return what == "send" ? send(participant, load) : receive(participant, load);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5 && argc != 7) {
    return std::fprintf(stderr, "usage: link_peer send|receive LINK|- SECONDS RATE [WIDTH HEIGHT]\n"), 2;
  }
  Load load{std::atof(argv[3]), std::atof(argv[4])};
  if (argc == 7) {
    load.width = static_cast<std::uint16_t>(std::atoi(argv[5]));
    load.height = static_cast<std::uint16_t>(std::atoi(argv[6]));
  }
  const auto code = run(argv[1], argv[2], load);
  return code ? *code : report(code.error());
}
