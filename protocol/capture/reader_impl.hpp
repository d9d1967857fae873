// State of CaptureReader. Private to this folder.
#pragma once

#include <map>
#include <set>

#include "protocol/capture/capture.hpp"
#include "protocol/capture/layout.hpp"
#include "protocol/mcap/reader.hpp"

namespace enamel::capture {

inline proto::ByteView as_octets(mcap::ByteSpan bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

struct BurstPlace {
  std::uint64_t burst_index = 0;
  std::size_t chunk = 0, slot = 0;
};

struct CaptureReader::Impl {
  mcap::Reader in;
  std::string path;
  CaptureInfo info;
  std::string rig;
  std::map<std::uint16_t, Kind> kinds;
  std::map<std::uint16_t, std::set<std::string>> schema_names;  // a damaged one has its copy in the summary
  // Position of next(): a block that is loaded and the slot in it.
  std::size_t next_block = 0, slot = 0;
  mcap::Chunk chunk;
  std::uint64_t seen = 0, lost = 0;  // bursts so far
  // Random access: table made on first use, last chunk kept.
  bool table_made = false;
  std::vector<BurstPlace> table;
  std::optional<Error> table_error;
  std::optional<std::size_t> cached;
  mcap::Chunk cache;

  Impl(mcap::Reader reader, std::string file) : in(std::move(reader)), path(std::move(file)) {}
  Result<void> fill_info();
  void learn(const std::vector<mcap::Channel>& channels, const std::vector<mcap::Schema>& more_schemas);
  void assume_own_numbering();
  void count_by_statistics(const mcap::Statistics& statistics);
  void count_by_reading();
  std::uint64_t bursts_in(const mcap::Block& block) const;
  std::optional<std::string> rig_of_device_info();
  void seek_rig(const Error& why_not_attached);
  void count(Kind kind, std::uint64_t n);
  bool knows_bursts() const;
  std::optional<Kind> kind_of(const mcap::Message& message) const;
  template <class Accept>
  Result<std::optional<Record>> advance(Accept&& accept);
  Result<std::optional<Record>> at_end();
  void make_table();
  Result<proto::Burst> burst_at(const BurstPlace& place);
  tl::unexpected<Error> not_found(const std::string& what) const;
};

}  // namespace enamel::capture
