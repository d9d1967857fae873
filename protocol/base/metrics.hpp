// Counters, gauges and histograms with one writer each; anyone may read at any time.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace enamel {

/// One writer thread at a time (hand-over needs a happens-before edge); relaxed, so reading never slows the writer.
class Counter {
 public:
  void add(std::uint64_t n = 1) noexcept {
    v_.store(v_.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return v_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> v_{0};
};

/// Last value and its maximum. One writer.
class Gauge {
 public:
  void set(std::int64_t v) noexcept {
    v_.store(v, std::memory_order_relaxed);
    if (v > max_.load(std::memory_order_relaxed)) max_.store(v, std::memory_order_relaxed);
  }
  [[nodiscard]] std::int64_t value() const noexcept { return v_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t max() const noexcept { return max_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::int64_t> v_{0};
  std::atomic<std::int64_t> max_{0};
};

/// Log-linear histogram of non-negative integers (ns): 16 buckets per power of two, so a percentile is within 1/16 of
/// the true value (below 16: exact). One writer.
class LogHistogram {
 public:
  struct Summary {
    std::uint64_t count = 0;
    std::int64_t p50 = 0;
    std::int64_t p95 = 0;
    std::int64_t p99 = 0;
    std::int64_t max = 0;
    double mean = 0.0;
  };

  /// Negative values count as 0.
  void record(std::int64_t value) noexcept;
  [[nodiscard]] Summary summary() const;

 private:
  static constexpr std::size_t kSub = 16;
  static constexpr std::size_t kBuckets = kSub * 61;
  static std::size_t bucket_of(std::uint64_t v) noexcept;
  static std::uint64_t upper_bound(std::size_t bucket) noexcept;

  std::array<std::atomic<std::uint64_t>, kBuckets> buckets_{};
  std::atomic<std::uint64_t> sum_{0};
  std::atomic<std::uint64_t> max_{0};
};

/// Owns named metrics and writes them as one JSON object {"name": value, …} in order of creation. Creating is not
/// thread-safe (do it at start); snapshots are safe while writers run. Names are unique: asking again gives the same.
class MetricsRegistry {
 public:
  Counter& counter(std::string_view name);
  Gauge& gauge(std::string_view name);
  LogHistogram& histogram(std::string_view name);
  /// A counter is a number; a gauge {"value","max"}; a histogram {"count","mean","p50","p95","p99","max"}.
  [[nodiscard]] std::string to_json() const;

 private:
  struct Entry {
    std::string name;
    std::unique_ptr<Counter> counter;
    std::unique_ptr<Gauge> gauge;
    std::unique_ptr<LogHistogram> histogram;
  };
  Entry& entry(std::string_view name);

  std::deque<Entry> entries_;
};

/// `text` as a JSON string with quotes.
[[nodiscard]] std::string json_quote(std::string_view text);

}  // namespace enamel
