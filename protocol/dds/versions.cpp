#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "protocol/dds/participant_impl.hpp"
#include "protocol/types/device.hpp"

namespace enamel::dds {
namespace {

constexpr int kAtOnce = 64;

/// N of "enamel/vN/..."; 0: no topic of ours.
int major_of(std::string_view topic) {
  constexpr std::string_view kPrefix = "enamel/v";
  if (topic.substr(0, kPrefix.size()) != kPrefix) return 0;
  int major = 0;
  const char* const begin = topic.data() + kPrefix.size();
  const auto parsed = std::from_chars(begin, topic.data() + topic.size(), major);
  return parsed.ec == std::errc{} && parsed.ptr != topic.data() + topic.size() && *parsed.ptr == '/' ? major : 0;
}

}  // namespace

// Writers are enough: each of our programs writes something.
std::vector<int> foreign_versions(const Participant& participant) {
  std::vector<int> majors;
  const dds_entity_t reader =
      dds_create_reader(participant.impl()->entity, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  if (reader < 0) return majors;
  std::array<void*, kAtOnce> samples{};
  std::array<dds_sample_info_t, kAtOnce> infos{};
  for (;;) {
    const dds_return_t n = dds_take(reader, samples.data(), infos.data(), kAtOnce, kAtOnce);
    if (n <= 0) break;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      if (!infos[i].valid_data) continue;
      const int major = major_of(static_cast<const dds_builtintopic_endpoint_t*>(samples[i])->topic_name);
      if (major > 0 && major != static_cast<int>(proto::kProtocolVersion)) majors.push_back(major);
    }
    static_cast<void>(dds_return_loan(reader, samples.data(), n));
  }
  dds_delete(reader);
  std::sort(majors.begin(), majors.end());
  majors.erase(std::unique(majors.begin(), majors.end()), majors.end());
  return majors;
}

}  // namespace enamel::dds
