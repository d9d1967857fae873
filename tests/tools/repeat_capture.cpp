// repeat_capture IN OUT BURSTS: a long recording made of a short one, played forward, backward, forward … so that the
// hand goes there and back over the same surface. Bursts are numbered anew and their times go on; the gap between two
// is what it was the other way. A tool of the tests, for what only long scans show: memory, and whether a stage slows
// down. What a burst itself shows of its motion stays as it was taken, backward too.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "protocol/capture/capture.hpp"

namespace {

namespace ep = enamel::proto;
using enamel::Result;
using enamel::capture::CaptureReader;
using enamel::capture::CaptureWriter;

/// 0 1 … n-1 n-2 … 1 0 1 …
std::uint64_t there_and_back(std::uint64_t i, std::uint64_t n) {
  if (n < 2) return 0;
  const std::uint64_t at = i % (2 * (n - 1));
  return at < n ? at : 2 * (n - 1) - at;
}

/// Unset stamps are 0 and stay so.
void shift(std::uint64_t& t_ns, std::int64_t by_ns) {
  if (t_ns != 0) t_ns = static_cast<std::uint64_t>(static_cast<std::int64_t>(t_ns) + by_ns);
}

class Renumbering {
 public:
  void operator()(ep::Burst& burst) {
    const auto recorded = static_cast<std::int64_t>(burst.t_first_exposure_ns);
    if (count_ == 0) {
      first_ = burst;
      first_.payload = {};
      next_sensor_seq_ = burst.meta.empty() ? 0 : burst.meta.front().sensor_seq;
    } else {
      offset_ns_ = last_ns_ + std::abs(recorded - last_recorded_ns_) - recorded;
    }
    last_recorded_ns_ = recorded;
    last_ns_ = recorded + offset_ns_;
    burst.burst_seq = first_.burst_seq + count_;
    burst.burst_index = first_.burst_index + count_;
    burst.probe_id = first_.probe_id;
    burst.session_id = first_.session_id;
    shift(burst.t_first_exposure_ns, offset_ns_);
    shift(burst.t_publish_ns, offset_ns_);
    for (ep::FrameMeta& frame : burst.meta) {
      frame.sensor_seq = next_sensor_seq_++;
      for (auto* t : {&frame.t_strobe_ns, &frame.t_sensor_ns, &frame.t_trig_rise_ns, &frame.t_trig_fall_ns})
        shift(*t, offset_ns_);
    }
    ++count_;
  }
  [[nodiscard]] std::int64_t last_ns() const noexcept { return last_ns_; }

 private:
  ep::Burst first_;
  std::uint64_t count_ = 0;
  std::uint32_t next_sensor_seq_ = 0;
  std::int64_t offset_ns_ = 0, last_ns_ = 0, last_recorded_ns_ = 0;
};

/// The truth goes along where it is of the surface; that of each burst would name other bursts.
bool stays_true(const std::string& attachment) {
  return attachment != enamel::capture::kRigAttachment && !attachment.ends_with(".csv");
}

Result<void> repeat(const std::string& in, const std::string& out, std::uint64_t bursts) {
  ENAMEL_TRY_ASSIGN(auto reader, CaptureReader::open(in));
  const std::uint64_t n = reader.info().bursts;
  if (n == 0) return enamel::fail(enamel::ErrorCode::kBurstNotFound, in + " holds no burst");
  enamel::capture::CaptureHeader header{reader.rig_text(), reader.info().program, reader.info().metadata};
  header.metadata.emplace_back("repeated", std::to_string(n) + " there and back: " + std::to_string(bursts));
  ENAMEL_TRY_ASSIGN(auto writer, CaptureWriter::create(out, header));
  Renumbering renumber;
  for (std::uint64_t i = 0; i < bursts; ++i) {
    ENAMEL_TRY_ASSIGN(ep::Burst burst, reader.burst(there_and_back(i, n)));
    renumber(burst);
    ENAMEL_TRY(writer.write_burst(burst, renumber.last_ns()));
  }
  for (const enamel::capture::AttachmentInfo& a : reader.info().attachments) {
    if (!stays_true(a.name)) continue;
    ENAMEL_TRY_ASSIGN(const ep::Bytes bytes, reader.attachment(a.name));
    ENAMEL_TRY(writer.attach(a.name, a.media_type, bytes));
  }
  return writer.finish();
}

}  // namespace

int main(int argc, char** argv) {
  const bool help = argc == 2 && std::string_view(argv[1]) == "--help";
  if (argc != 4) {
    std::fprintf(help ? stdout : stderr, "usage: %s IN.mcap OUT.mcap BURSTS\n", argv[0]);
    return help ? 0 : 1;
  }
  const auto done = repeat(argv[1], argv[2], std::strtoull(argv[3], nullptr, 10));
  if (done) return 0;
  std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return enamel::exit_code(done.error().code);
}
