// What a recording is said to hold, and which channel is which.
#include <algorithm>
#include <array>

#include "protocol/capture/reader_impl.hpp"

namespace enamel::capture {

void CaptureReader::Impl::count(Kind kind, std::uint64_t n) {
  const std::array<std::uint64_t*, kKinds> counters{&info.bursts, &info.shed,         &info.statuses,
                                                    &info.events, &info.device_infos, &info.axes};
  *counters[static_cast<std::size_t>(kind)] += n;
}

bool CaptureReader::Impl::knows_bursts() const {
  return std::any_of(kinds.begin(), kinds.end(), [](const auto& entry) { return entry.second == Kind::kBurst; });
}

void CaptureReader::Impl::learn(const std::vector<mcap::Channel>& channels, const std::vector<mcap::Schema>& schemas) {
  for (const mcap::Schema& schema : schemas) schema_names[schema.id].insert(schema.name);
  for (const mcap::Channel& channel : channels) {
    if (channel.message_encoding != kMessageEncoding) continue;
    for (std::size_t k = 0; k < kKinds; ++k) {
      if (channel.topic == kChannelNames[k].topic &&
          schema_names[channel.schema_id].contains(std::string(kChannelNames[k].schema))) {
        kinds[channel.id] = static_cast<Kind>(k);
      }
    }
  }
}

// CaptureWriter numbers its channels from 1 in the order of Kind. Where the record of one is damaged and the summary,
// which has it again, is missing or damaged too, that is what is left; a message that is of another kind does not
// decode.
void CaptureReader::Impl::assume_own_numbering() {
  if (in.profile() != kProfile || (!in.truncated() && in.problems().empty())) return;
  for (std::size_t k = 0; k < kKinds; ++k) kinds.try_emplace(static_cast<std::uint16_t>(k + 1), static_cast<Kind>(k));
}

void CaptureReader::Impl::count_by_statistics(const mcap::Statistics& statistics) {
  for (const auto& [channel, n] : statistics.per_channel) {
    if (const auto it = kinds.find(channel); it != kinds.end()) count(it->second, n);
  }
  info.first_log_ns = static_cast<std::int64_t>(statistics.start_ns);
  info.last_log_ns = static_cast<std::int64_t>(statistics.end_ns);
}

// Without a summary the messages of the readable blocks are counted one by one; next() reports the others.
void CaptureReader::Impl::count_by_reading() {
  bool first = true;
  for (std::size_t n = 0; n < in.blocks().size(); ++n) {
    const auto loaded = in.read(n);
    if (!loaded) {
      info.bursts += bursts_in(in.blocks()[n]);
      continue;
    }
    learn(loaded->channels, loaded->schemas);
    for (const mcap::Message& m : loaded->messages) {
      if (const auto kind = kind_of(m)) count(*kind, 1);
      const auto t = static_cast<std::int64_t>(m.header.log_ns);
      info.first_log_ns = first ? t : std::min(info.first_log_ns, t);
      info.last_log_ns = first ? t : std::max(info.last_log_ns, t);
      first = false;
    }
  }
}

// How many bursts a block holds that cannot be read: as its index says. Without one the summary tells at the end; where
// that is missing too, a burst is all that a chunk of this program holds, and less than a page holds none.
std::uint64_t CaptureReader::Impl::bursts_in(const mcap::Block& block) const {
  constexpr std::uint64_t kPage = 4096;
  std::uint64_t told = 0;
  for (const auto& [channel, n] : block.told) {
    if (const auto it = kinds.find(channel); it != kinds.end() && it->second == Kind::kBurst) told += n;
  }
  if (!block.told.empty()) return told;
  return in.statistics() || block.length < kPage ? 0 : 1;
}

Result<void> CaptureReader::Impl::fill_info() {
  learn(in.channels(), in.schemas());
  assume_own_numbering();
  info.truncated = in.truncated();
  info.file_bytes = in.file_bytes();
  info.problems = in.problems();
  if (in.statistics() && knows_bursts()) {
    count_by_statistics(*in.statistics());
  } else {
    count_by_reading();
  }
  if (!knows_bursts()) return fail(ErrorCode::kCaptureInvalid, path + ": MCAP file without channel enamel/v1/burst");
  if (info.truncated && in.blocks().empty()) {
    return fail(ErrorCode::kCaptureInvalid, path + ": cut before its first whole chunk");
  }
  for (const mcap::Metadata& metadata : in.metadata()) {
    if (metadata.name != kMetadataName) continue;
    for (const auto& [key, value] : metadata.values) {
      if (key == kProgramKey) {
        info.program = value;
      } else {
        info.metadata.emplace_back(key, value);
      }
    }
  }
  for (const mcap::AttachmentIndex& a : in.attachments())
    info.attachments.push_back({a.name, a.media_type, a.data_size});
  return {};
}

// The probe tells its calibration itself: a second copy, in recordings of live scans.
std::optional<std::string> CaptureReader::Impl::rig_of_device_info() {
  for (std::size_t n = 0; n < in.blocks().size(); ++n) {
    const auto loaded = in.read(n);
    if (!loaded) continue;
    for (const mcap::Message& m : loaded->messages) {
      if (kind_of(m) != Kind::kDeviceInfo) continue;
      const auto told = proto::from_cdr<proto::DeviceInfo>(as_octets(m.data));
      if (told && !told->calibration_blob.empty()) {
        return std::string(told->calibration_blob.begin(), told->calibration_blob.end());
      }
    }
  }
  return std::nullopt;
}

void CaptureReader::Impl::seek_rig(const Error& why_not_attached) {
  const bool attached = why_not_attached.code != ErrorCode::kFileNotFound;
  const auto is_damaged = [](const mcap::Block& b) { return b.kind == mcap::Block::Kind::kDamaged; };
  if (!attached && !info.truncated && std::none_of(in.blocks().begin(), in.blocks().end(), is_damaged)) return;
  auto told = rig_of_device_info();
  info.problems.push_back((attached ? why_not_attached.detail : path + ": no rig.json is left") +
                          (told ? "; what the probe told of itself is used" : ""));
  rig = std::move(told).value_or("");
}

}  // namespace enamel::capture
