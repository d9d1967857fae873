#include "host/record/axes_gather.hpp"

#include <set>

#include "host/record/exchange_names.hpp"
#include "protocol/types/axes_table.hpp"

namespace enamel::host {

AxesGather::AxesGather(BurstStream& stream) {
  const auto bytes = stream.attachment(kAxesFile);
  has_table_ = bytes.has_value() || bytes.error().code != ErrorCode::kFileNotFound;
  if (!has_table_) return;
  if (!bytes) {
    table_error_ = bytes.error();
    return;
  }
  text_.assign(bytes->begin(), bytes->end());
  auto rows = proto::parse_burst_axes(text_, kAxesFile);
  if (!rows) {
    table_error_ = std::move(rows).error();
    return;
  }
  for (const proto::AxesReading& row : *rows) rows_.emplace(row.burst_index, row);
}

void AxesGather::take(const capture::Record& record) {
  if (const auto* burst = std::get_if<proto::Burst>(&record.value)) {
    bursts_.emplace_back(burst->probe_id, burst->session_id, burst->burst_index);
  }
  const auto* reading = std::get_if<proto::AxesReading>(&record.value);
  if (reading == nullptr) return;
  const auto [at, is_new] = told_.try_emplace({reading->probe_id, reading->session_id, reading->burst_index}, *reading);
  if (!is_new && at->second != *reading && !told_twice_) told_twice_ = reading->burst_index;
}

// What says nothing of an axis is no reading.
std::optional<proto::AxesReading> AxesGather::reading_of(const Key& key) const {
  if (!told_.empty()) {
    const auto told = told_.find(key);
    return told != told_.end() && told->second.is_whole() ? std::optional(told->second) : std::nullopt;
  }
  const auto row = rows_.find(std::get<2>(key));
  if (row == rows_.end()) return std::nullopt;
  proto::AxesReading reading = row->second;
  std::tie(reading.probe_id, reading.session_id, reading.burst_index) = key;
  return reading;
}

std::vector<proto::AxesReading> AxesGather::readings() const {
  std::vector<proto::AxesReading> out;
  for (const Key& key : bursts_) {
    if (const auto reading = reading_of(key)) out.push_back(*reading);
  }
  if (told_.empty()) proto::number_stops(out);
  return out;
}

std::optional<Error> AxesGather::missing() const {
  if (told_.empty() && !has_table_) {
    return Error{ErrorCode::kAxesMissing, "neither messages on enamel/v1/axes nor an attachment axes.csv"};
  }
  if (told_.empty() && table_error_) return table_error_;
  for (const Key& key : bursts_) {
    if (!reading_of(key)) {
      return Error{ErrorCode::kAxesMissing, "burst " + std::to_string(std::get<2>(key)) + ": no " +
                                                (told_.empty() ? "row of axes.csv" : "message on enamel/v1/axes") +
                                                " says where the axes stood"};
    }
  }
  return std::nullopt;
}

std::optional<Error> AxesGather::contradiction() const {
  if (told_twice_) {
    return Error{ErrorCode::kExchangeInvalid,
                 "burst " + std::to_string(*told_twice_) + ": two messages on enamel/v1/axes tell different angles"};
  }
  // One that a damaged place took along contradicts nothing.
  if (table_error_ && table_error_->code == ErrorCode::kExchangeInvalid) return table_error_;
  std::set<std::uint64_t> seen;
  for (const Key& key : bursts_) {
    // The table does not tell sessions apart: it is of the first one that has the number.
    if (!seen.insert(std::get<2>(key)).second) continue;
    const auto told = told_.find(key);
    const auto row = rows_.find(std::get<2>(key));
    if (told == told_.end() || row == rows_.end() || told->second.has_angles_of(row->second)) continue;
    return Error{
        ErrorCode::kExchangeInvalid,
        "burst " + std::to_string(std::get<2>(key)) +
            ": its message on enamel/v1/axes and its row of axes.csv tell different angles; one of the two was "
            "changed after the scan"};
  }
  return std::nullopt;
}

std::optional<std::string> AxesGather::table() const {
  const auto all = readings();
  // A table that cannot be read goes along as it is.
  if (all.empty()) {
    const bool is_malformed = table_error_ && table_error_->code == ErrorCode::kExchangeInvalid;
    return is_malformed ? std::optional(text_) : std::nullopt;
  }
  std::size_t same = 0;
  for (const proto::AxesReading& reading : all) {
    const auto row = rows_.find(reading.burst_index);
    if (row != rows_.end() && row->second.has_angles_of(reading)) ++same;
  }
  return same == all.size() && same == rows_.size() ? text_ : proto::axes_table_text(all);
}

}  // namespace enamel::host
