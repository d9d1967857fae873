#include "protocol/base/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "protocol/base/check.hpp"

namespace enamel {

// Values below kSub have a bucket each; above, the leading bit selects the octave and the next four bits the bucket.
std::size_t LogHistogram::bucket_of(std::uint64_t v) noexcept {
  if (v < kSub) return static_cast<std::size_t>(v);
  const auto octave = static_cast<std::size_t>(std::bit_width(v)) - 5;  // 0 for 16..31
  return (octave + 1) * kSub + static_cast<std::size_t>((v >> octave) & (kSub - 1));
}

std::uint64_t LogHistogram::upper_bound(std::size_t bucket) noexcept {
  if (bucket < kSub) return bucket;
  const std::size_t octave = bucket / kSub - 1;
  const std::uint64_t first = (kSub + bucket % kSub) << octave;
  return first + ((std::uint64_t{1} << octave) - 1);
}

void LogHistogram::record(std::int64_t value) noexcept {
  const std::uint64_t v = value > 0 ? static_cast<std::uint64_t>(value) : 0;
  const auto bump = [](std::atomic<std::uint64_t>& a, std::uint64_t by) {
    a.store(a.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
  };
  bump(buckets_[bucket_of(v)], 1);
  bump(sum_, v);
  if (v > max_.load(std::memory_order_relaxed)) max_.store(v, std::memory_order_relaxed);
}

LogHistogram::Summary LogHistogram::summary() const {
  std::array<std::uint64_t, kBuckets> copy{};
  Summary out;
  for (std::size_t i = 0; i < kBuckets; ++i) {
    copy[i] = buckets_[i].load(std::memory_order_relaxed);
    out.count += copy[i];
  }
  if (out.count == 0) return out;
  out.max = static_cast<std::int64_t>(max_.load(std::memory_order_relaxed));
  out.mean = static_cast<double>(sum_.load(std::memory_order_relaxed)) / static_cast<double>(out.count);
  const auto percentile = [&](double q) {
    const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(out.count)));
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      seen += copy[i];
      if (seen >= rank) return std::min(static_cast<std::int64_t>(upper_bound(i)), out.max);
    }
    return out.max;
  };
  out.p50 = percentile(0.50);
  out.p95 = percentile(0.95);
  out.p99 = percentile(0.99);
  return out;
}

MetricsRegistry::Entry& MetricsRegistry::entry(std::string_view name) {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == name; });
  if (found != entries_.end()) return *found;
  entries_.push_back(Entry{std::string(name), nullptr, nullptr, nullptr});
  return entries_.back();
}

Counter& MetricsRegistry::counter(std::string_view name) {
  Entry& e = entry(name);
  ENAMEL_CHECK(!e.gauge && !e.histogram, "one metric name, two kinds");
  if (!e.counter) e.counter = std::make_unique<Counter>();
  return *e.counter;
}

Gauge& MetricsRegistry::gauge(std::string_view name) {
  Entry& e = entry(name);
  ENAMEL_CHECK(!e.counter && !e.histogram, "one metric name, two kinds");
  if (!e.gauge) e.gauge = std::make_unique<Gauge>();
  return *e.gauge;
}

LogHistogram& MetricsRegistry::histogram(std::string_view name) {
  Entry& e = entry(name);
  ENAMEL_CHECK(!e.counter && !e.gauge, "one metric name, two kinds");
  if (!e.histogram) e.histogram = std::make_unique<LogHistogram>();
  return *e.histogram;
}

std::string MetricsRegistry::to_json() const {
  std::string out = "{";
  for (const Entry& e : entries_) {
    if (out.size() > 1) out += ", ";
    out += json_quote(e.name) + ": ";
    if (e.counter) {
      out += std::to_string(e.counter->value());
    } else if (e.gauge) {
      out += fmt::format(R"({{"value": {}, "max": {}}})", e.gauge->value(), e.gauge->max());
    } else {
      const LogHistogram::Summary s = e.histogram->summary();
      out += fmt::format(R"({{"count": {}, "mean": {:.1f}, "p50": {}, "p95": {}, "p99": {}, "max": {}}})", s.count,
                         s.mean, s.p50, s.p95, s.p99, s.max);
    }
  }
  return out + "}";
}

std::string json_quote(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

}  // namespace enamel
