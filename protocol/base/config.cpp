#include "protocol/base/config.hpp"

#include <cmath>
#include <fstream>
#include <iterator>

#include "protocol/base/config_state.hpp"

namespace enamel {

using config_detail::float_text;
using config_detail::Node;
using config_detail::Value;

namespace {

std::string in_range(std::string_view lo, std::string_view hi) {
  return "from " + std::string(lo) + " to " + std::string(hi);
}

/// Empty when it is the type's whole range.
template <class T>
std::string range_text(Range<T> range, Range<T> whole = {}) {
  const auto text = [](T v) {
    if constexpr (std::floating_point<T>) {
      return float_text(v);
    } else {
      return std::to_string(v);
    }
  };
  if (range.min > whole.min && range.max < whole.max) return in_range(text(range.min), text(range.max));
  if (range.min > whole.min) return "at least " + text(range.min);
  if (range.max < whole.max) return "at most " + text(range.max);
  return {};
}

/// A TOML integer is accepted where a float is wanted; inf and nan are not numbers anyone can scan with.
std::optional<double> number_of(const Value& v) {
  if (const auto* i = std::get_if<std::int64_t>(&v)) return static_cast<double>(*i);
  if (const auto* f = std::get_if<double>(&v); f != nullptr && std::isfinite(*f)) return *f;
  return std::nullopt;
}

std::string wanted(std::string_view type, const Node& n) {
  return "needs " + std::string(type) + ", not " + std::string(config_detail::type_name(n.value));
}

template <class T>
std::string list_text(std::span<const T> values) {
  std::string out = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out += ", ";
    if constexpr (std::floating_point<T>) {
      out += float_text(values[i]);
    } else {
      out += config_detail::string_text(values[i]);
    }
  }
  return out + "]";
}

template <class T>
Result<T> float_from(const Node& n, Range<T> range) {
  const std::optional<double> v = number_of(n.value);
  if (!v) return fail(ErrorCode::kConfigValue, wanted("a finite number", n));
  if (!(*v >= static_cast<double>(range.min) && *v <= static_cast<double>(range.max))) {
    return fail(ErrorCode::kConfigValue,
                "is " + float_text(*v) + ", must be " + in_range(float_text(range.min), float_text(range.max)));
  }
  return static_cast<T>(*v);
}

Result<std::vector<double>> numbers_from(const Node& n, Range<double> range) {
  const auto* list = std::get_if<std::vector<double>>(&n.value);
  if (list == nullptr) return fail(ErrorCode::kConfigValue, wanted("an array of numbers", n));
  for (const double v : *list) {
    if (!(v >= range.min && v <= range.max)) {
      return fail(ErrorCode::kConfigValue,
                  "holds " + float_text(v) + ", must be " + in_range(float_text(range.min), float_text(range.max)));
    }
  }
  return *list;
}

}  // namespace

ConfigReader::ConfigReader(std::shared_ptr<State> state, std::string prefix)
    : state_(std::move(state)), prefix_(std::move(prefix)) {}

Result<ConfigReader> ConfigReader::from_file(const std::filesystem::path& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) return fail(ErrorCode::kFileNotFound, path.string());
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path, ec)) return fail(ErrorCode::kFileRead, path.string());
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (in.bad()) return fail(ErrorCode::kFileRead, path.string());
  return from_text(text, path.string());
}

Result<ConfigReader> ConfigReader::from_text(std::string_view text, std::string_view name) {
  ConfigReader reader = empty();
  reader.state_->name = name;
  ENAMEL_TRY_ASSIGN(std::vector<Node> nodes, config_detail::flatten_toml(text, name));
  for (Node& n : nodes) {
    std::string path = n.path;
    reader.state_->given.emplace(std::move(path), std::move(n));
  }
  return reader;
}

ConfigReader ConfigReader::empty() { return {std::make_shared<State>(), ""}; }

Result<void> ConfigReader::set(std::string_view assignment) {
  const std::size_t eq = assignment.find('=');
  const std::string where = "--set " + std::string(assignment);
  if (eq == 0 || eq == std::string_view::npos) return fail(ErrorCode::kConfigSyntax, where + ": expected key=value");
  const std::string key(assignment.substr(0, eq));
  const std::string value(assignment.substr(eq + 1));
  if (value.find_first_of("\r\n") != std::string::npos) {
    return fail(ErrorCode::kConfigSyntax, where + ": the value must be on one line");
  }
  auto parsed = config_detail::flatten_toml("v = " + value, where);
  if (!parsed) parsed = config_detail::flatten_toml("v = " + config_detail::string_text(value), where);
  if (!parsed) return tl::unexpected<Error>(std::move(parsed).error());
  // A value or a list stands instead of all that the file has there; a table only adds to it.
  const std::string at = full(key);
  const bool is_table = parsed->front().is_table && parsed->front().path == "v";
  if (!is_table) {
    std::erase_if(state_->given, [&at](const auto& entry) {
      const std::string_view path = entry.first;
      return path == at || path.starts_with(at + ".") || path.starts_with(at + "[");
    });
  }
  for (Node& n : *parsed) {
    std::string path = at + n.path.substr(1);  // "v", "v.x", "v[0].x" -> "key…"
    n.path = path;
    n.where = where;
    state_->given.insert_or_assign(std::move(path), std::move(n));
  }
  return {};
}

void ConfigReader::bind_int(std::string_view key, std::int64_t& value, Range<std::int64_t> range,
                            Range<std::int64_t> whole, std::string_view doc) {
  const std::string path = full(key);
  if (const Node* n = state_->claim(path)) {
    const auto* v = std::get_if<std::int64_t>(&n->value);
    if (v == nullptr) {
      state_->add_error(path, wanted("an integer", *n));
    } else if (*v < range.min || *v > range.max) {
      state_->add_error(path, "is " + std::to_string(*v) + ", must be " +
                                  in_range(std::to_string(range.min), std::to_string(range.max)));
    } else {
      value = *v;
    }
  }
  state_->resolved(path, std::to_string(value), doc, range_text(range, whole));
}

void ConfigReader::bind_float(std::string_view key, float& value, Range<float> range, std::string_view doc) {
  const std::string path = full(key);
  if (const Node* n = state_->claim(path)) {
    const auto v = float_from(*n, range);
    if (v) value = *v;
    if (!v) state_->add_error(path, v.error().detail);
  }
  state_->resolved(path, float_text(value), doc, range_text(range));
}

void ConfigReader::bind_float(std::string_view key, double& value, Range<double> range, std::string_view doc) {
  const std::string path = full(key);
  if (const Node* n = state_->claim(path)) {
    const auto v = float_from(*n, range);
    if (v) value = *v;
    if (!v) state_->add_error(path, v.error().detail);
  }
  state_->resolved(path, float_text(value), doc, range_text(range));
}

void ConfigReader::bind(std::string_view key, bool& value, std::string_view doc) {
  const std::string path = full(key);
  if (const Node* n = state_->claim(path)) {
    if (const auto* v = std::get_if<bool>(&n->value)) {
      value = *v;
    } else {
      state_->add_error(path, wanted("true or false", *n));
    }
  }
  state_->resolved(path, value ? "true" : "false", doc, "");
}

void ConfigReader::bind(std::string_view key, std::string& value, std::string_view doc) {
  const std::string path = full(key);
  if (const Node* n = state_->claim(path)) {
    if (const auto* v = std::get_if<std::string>(&n->value)) {
      value = *v;
    } else {
      state_->add_error(path, wanted("a string", *n));
    }
  }
  state_->resolved(path, config_detail::string_text(value), doc, "");
}

void ConfigReader::bind(std::string_view key, std::filesystem::path& value, std::string_view doc) {
  std::string text = value.string();
  bind(key, text, doc);
  value = text;
}

void ConfigReader::bind(std::string_view key, std::vector<std::string>& value, std::string_view doc) {
  const std::string path = full(key);
  if (const Node* n = state_->claim(path)) {
    const auto* numbers = std::get_if<std::vector<double>>(&n->value);
    if (const auto* v = std::get_if<std::vector<std::string>>(&n->value)) {
      value = *v;
    } else if (numbers != nullptr && numbers->empty()) {
      value.clear();
    } else {
      state_->add_error(path, wanted("an array of strings", *n));
    }
  }
  state_->resolved(path, list_text(std::span<const std::string>(value)), doc, "");
}

void ConfigReader::bind(std::string_view key, std::vector<double>& value, Range<double> range, std::string_view doc) {
  const std::string path = full(key);
  if (const Node* n = state_->claim(path)) {
    auto v = numbers_from(*n, range);
    if (v) value = std::move(*v);
    if (!v) state_->add_error(path, v.error().detail);
  }
  state_->resolved(path, list_text(std::span<const double>(value)), doc, range_text(range));
}

void ConfigReader::bind_fixed(std::string_view key, std::span<double> value, Range<double> range,
                              std::string_view doc) {
  const std::string path = full(key);
  if (const Node* n = state_->claim(path)) {
    const auto v = numbers_from(*n, range);
    if (!v) {
      state_->add_error(path, v.error().detail);
    } else if (v->size() != value.size()) {
      state_->add_error(path,
                        "has " + std::to_string(v->size()) + " numbers, must have " + std::to_string(value.size()));
    } else {
      std::copy(v->begin(), v->end(), value.begin());
    }
  }
  state_->resolved(path, list_text(std::span<const double>(value)), doc, range_text(range));
}

void ConfigReader::bind_choice(std::string_view key, std::size_t& index, std::span<const std::string_view> names,
                               std::string_view doc) {
  const std::string path = full(key);
  std::string all;
  for (const std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
  if (const Node* n = state_->claim(path)) {
    const auto* v = std::get_if<std::string>(&n->value);
    const auto found = v != nullptr ? std::find(names.begin(), names.end(), *v) : names.end();
    if (found == names.end()) {
      state_->add_error(path, "must be one of " + all);
    } else {
      index = static_cast<std::size_t>(found - names.begin());
    }
  }
  const std::string_view now = index < names.size() ? names[index] : std::string_view();
  state_->resolved(path, config_detail::string_text(now), doc, "one of " + all);
}

std::string ConfigReader::full(std::string_view key) const { return prefix_ + std::string(key); }

}  // namespace enamel
