// Strict TOML configuration bound to structs: defaults < file < overrides (`--set a.b=value`).
//
//   Result<NoiseConfig> read_noise(ConfigReader& reader) — each module binds its own fields:
//     reader.bind("noise.seed", config.seed, {0, 1000}, "seed of the sensor noise");
//     reader.bind("noise.model", config.model, "one of: poisson, none");
//   At the end, once, whoever opened the file:  ENAMEL_TRY(reader.finish());
//
// A bind call leaves the value as it is (its default) when the key is absent or the value unusable. The first error is
// kept and returned by finish(); a key of the file that nobody bound is an error too. Every message names file and
// line.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel {

/// Closed interval; the default admits every finite value of the type.
template <class T>
struct Range {
  T min = std::numeric_limits<T>::lowest();
  T max = std::numeric_limits<T>::max();
};

template <class T>
concept ConfigInteger = std::integral<T> && !std::same_as<T, bool>;

/// A handle on one parsed file, or on a table in it: copies and sub-tables share state. Not thread-safe.
class ConfigReader {
 public:
  /// kFileNotFound, kFileRead, kConfigSyntax.
  [[nodiscard]] static Result<ConfigReader> from_file(const std::filesystem::path& path);
  /// `name` stands for the file in messages. kConfigSyntax.
  [[nodiscard]] static Result<ConfigReader> from_text(std::string_view text, std::string_view name);
  /// No file: defaults and overrides only.
  [[nodiscard]] static ConfigReader empty();

  /// "a.b=value", before the first bind. The value is TOML; what is not TOML is taken as a string (mode=T).
  /// kConfigSyntax when there is no key or no '='.
  [[nodiscard]] Result<void> set(std::string_view assignment);

  template <ConfigInteger T>
  void bind(std::string_view key, T& value, std::type_identity_t<Range<T>> range, std::string_view doc) {
    std::int64_t v = clamp_to_int64(value);
    bind_int(key, v, {clamp_to_int64(range.min), clamp_to_int64(range.max)},
             {clamp_to_int64(Range<T>{}.min), clamp_to_int64(Range<T>{}.max)}, doc);
    value = static_cast<T>(v);
  }
  template <std::floating_point T>
  void bind(std::string_view key, T& value, std::type_identity_t<Range<T>> range, std::string_view doc) {
    bind_float(key, value, range, doc);
  }
  template <class T>
  requires(ConfigInteger<T> || std::floating_point<T>) void bind(std::string_view key, T& value, std::string_view doc) {
    bind(key, value, Range<T>{}, doc);
  }
  void bind(std::string_view key, bool& value, std::string_view doc);
  void bind(std::string_view key, std::string& value, std::string_view doc);
  void bind(std::string_view key, std::filesystem::path& value, std::string_view doc);
  void bind(std::string_view key, std::vector<std::string>& value, std::string_view doc);
  /// Numbers; every element must lie in `range`.
  void bind(std::string_view key, std::vector<double>& value, Range<double> range, std::string_view doc);
  /// Exactly N numbers.
  template <std::size_t N>
  void bind(std::string_view key, std::array<double, N>& value, Range<double> range, std::string_view doc) {
    bind_fixed(key, value, range, doc);
  }
  /// An enumeration by the names of its values: {{"none", Model::kNone}, {"poisson", Model::kPoisson}}.
  template <class E>
  requires std::is_enum_v<E>
  void bind(std::string_view key, E& value, std::type_identity_t<std::span<const std::pair<std::string_view, E>>> names,
            std::string_view doc) {
    std::vector<std::string_view> choices;
    std::size_t index = 0;
    for (const auto& [name, e] : names) {
      if (e == value) index = choices.size();
      choices.push_back(name);
    }
    bind_choice(key, index, choices, doc);
    if (index < names.size()) value = names[index].second;
  }

  /// The sub-table `key`; need not exist in the file.
  [[nodiscard]] ConfigReader table(std::string_view key) const;
  /// Number of elements of an array of tables ([[key]]); 0 when absent.
  [[nodiscard]] std::size_t table_count(std::string_view key);
  /// Element i of an array of tables.
  [[nodiscard]] ConfigReader table(std::string_view key, std::size_t i) const;
  /// Whether the file or an override gives this key (a value or a table).
  [[nodiscard]] bool has(std::string_view key) const;

  /// Adds an error of the caller's own (values that contradict each other) at the key's line; code kConfigValue.
  void reject(std::string_view key, std::string_view why);

  /// First error by bind order, else the first key or table that nobody bound.
  [[nodiscard]] Result<void> finish() const;

  /// Everything bound, with its resolved value and its doc and range as comments, as TOML that reads back the same.
  [[nodiscard]] std::string dump() const;

 private:
  struct State;
  ConfigReader(std::shared_ptr<State> state, std::string prefix);

  template <ConfigInteger T>
  static constexpr std::int64_t clamp_to_int64(T v) {
    constexpr auto kMax = std::numeric_limits<std::int64_t>::max();
    return std::cmp_greater(v, kMax) ? kMax : static_cast<std::int64_t>(v);
  }
  void bind_int(std::string_view key, std::int64_t& value, Range<std::int64_t> range, Range<std::int64_t> whole,
                std::string_view doc);
  void bind_float(std::string_view key, float& value, Range<float> range, std::string_view doc);
  void bind_float(std::string_view key, double& value, Range<double> range, std::string_view doc);
  void bind_choice(std::string_view key, std::size_t& index, std::span<const std::string_view> names,
                   std::string_view doc);
  void bind_fixed(std::string_view key, std::span<double> value, Range<double> range, std::string_view doc);
  [[nodiscard]] std::string full(std::string_view key) const;

  std::shared_ptr<State> state_;
  std::string prefix_;  // "a.b." or ""
};

}  // namespace enamel
