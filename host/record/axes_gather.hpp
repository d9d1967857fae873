// Collects the angles of a recording while its records go by. Private to this folder.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "host/record/burst_stream.hpp"
#include "protocol/types/axes.hpp"

namespace enamel::host {

/// One thread. Memory: a key and a reading for every burst.
class AxesGather {
 public:
  /// Takes the attachment axes.csv, if there is one.
  explicit AxesGather(BurstStream& stream);
  void take(const capture::Record& record);

  /// Of the bursts taken, in their order, those that have angles.
  [[nodiscard]] std::vector<proto::AxesReading> readings() const;
  /// Nothing when every burst has angles.
  [[nodiscard]] std::optional<Error> missing() const;
  /// Nothing when channel and attachment tell the same of every burst taken.
  [[nodiscard]] std::optional<Error> contradiction() const;
  /// axes.csv of the bursts taken: the attachment, byte for byte, while it says just this; nullopt where there are no
  /// angles.
  [[nodiscard]] std::optional<std::string> table() const;

 private:
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint64_t>;  ///< probe, session, burst
  [[nodiscard]] std::optional<proto::AxesReading> reading_of(const Key& key) const;

  std::string text_;  ///< of the attachment
  bool has_table_ = false;
  std::optional<Error> table_error_;
  std::map<std::uint64_t, proto::AxesReading> rows_;
  std::map<Key, proto::AxesReading> told_;  ///< by the channel
  std::vector<Key> bursts_;
  std::optional<std::uint64_t> told_twice_;  ///< burst of two messages that differ
};

}  // namespace enamel::host
