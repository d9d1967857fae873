// What stands behind the data section. Nothing of it is needed to find a message; it tells what should be there.
#include <algorithm>

#include "protocol/base/crc32.hpp"
#include "protocol/mcap/reader_impl.hpp"

namespace enamel::mcap {
namespace {

constexpr std::uint64_t kMaxSummary = std::uint64_t{256} << 20U;

// nullopt: there is none, the file ends before it or it is damaged.
std::optional<std::size_t> footer_in(ByteSpan summary) {
  std::size_t at = 0;
  while (summary.size() - at >= kRecordHeader) {
    const auto head = read_head(summary.subspan(at));
    if (head->length > summary.size() - at - kRecordHeader) return std::nullopt;
    if (head->op == Op::kFooter) {
      return head->length == kFooterRecord - kRecordHeader ? std::optional(at) : std::nullopt;
    }
    at += kRecordHeader + head->length;
  }
  return std::nullopt;
}

}  // namespace

Result<void> Reader::Impl::read_summary() {
  if (!ended_) return {};
  if (!data_end) problems.emplace_back("the end of the data section is damaged");
  if (source.size() - summary_at_ > kMaxSummary) {
    problems.emplace_back("more than a summary stands behind the data section");
    return {};
  }
  ENAMEL_TRY_ASSIGN(const auto bytes, source.read(summary_at_, source.size() - summary_at_));
  const ByteSpan rest(bytes);
  const auto footer = footer_in(rest);
  if (!footer) {
    const auto magic = std::as_bytes(std::span(kMagic));
    const bool has_end = rest.size() >= magic.size() && std::ranges::equal(rest.last(magic.size()), magic);
    truncated = !has_end;
    if (has_end) problems.emplace_back("the summary is damaged");
    return {};
  }
  ByteReader fields(rest.subspan(*footer + kRecordHeader));
  const auto summary_start = fields.get<std::uint64_t>();
  fields.skip(sizeof(std::uint64_t));
  const auto crc = fields.get<std::uint32_t>();
  const std::size_t covered = *footer + kFooterRecord - sizeof crc;
  const bool points_here = summary_start == 0 ? *footer == 0 : summary_start == summary_at_;
  // 0: the writer did not compute it (permitted by the specification).
  if (!points_here || (crc != 0 && crc32(rest.first(covered)) != crc)) {
    problems.emplace_back("the summary is damaged (CRC)");
    return {};
  }
  const ByteSpan end = rest.subspan(*footer + kFooterRecord);
  truncated = end.size() < kMagic.size();
  if (!truncated && !std::ranges::equal(end, std::as_bytes(std::span(kMagic)))) {
    problems.emplace_back("the file does not end with the last record");
  }
  ByteReader records(rest.first(*footer));
  while (records.remaining() > 0) {
    const auto head = read_head(records.take(kRecordHeader));
    if (!take_summary_record(head->op, records.take(head->length))) problems.emplace_back("the summary is damaged");
  }
  return {};
}

bool Reader::Impl::take_summary_record(Op op, ByteSpan body) {
  if (op == Op::kStatistics) return (statistics = read_statistics(body)).has_value();
  if (op == Op::kSchema) {
    auto schema = read_schema(body);
    if (schema) schemas.push_back(std::move(*schema));
    return schema.has_value();
  }
  if (op == Op::kChannel) {
    auto channel = read_channel(body);
    if (channel) channels.push_back(std::move(*channel));
    return channel.has_value();
  }
  return true;
}

}  // namespace enamel::mcap
