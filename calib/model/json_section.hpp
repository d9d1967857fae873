// One JSON object read key by key: remembers the first fault and the keys that nobody asked for. Private to
// calib/model.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::calib {

/// Collects the first fault over all sections of a file: later reads return defaults, the caller checks once at the
/// end.
class Faults {
 public:
  void add(const std::string& key, const std::string& what) {
    if (first_.empty()) first_ = "key '" + key + "' " + what;
  }
  [[nodiscard]] const std::string& first() const { return first_; }

 private:
  std::string first_;
};

class JsonSection {
 public:
  JsonSection(const nlohmann::json& object, std::string prefix, Faults& faults)
      : object_(object), prefix_(std::move(prefix)), faults_(faults) {}

  [[nodiscard]] bool has(const char* key) {
    const bool present = object_.contains(key);
    if (present) asked_.insert(key);
    return present;
  }

  [[nodiscard]] double number(const char* key) {
    const nlohmann::json* v = find(key);
    return v == nullptr ? 0 : as_number(*v, name(key));
  }
  [[nodiscard]] double number_within(const char* key, double low, double high) {
    const double n = number(key);
    if (has(key) && !(n >= low && n <= high)) {
      std::ostringstream what;
      what << "must be from " << low << " to " << high;
      refuse(key, what.str());
    }
    return n;
  }
  [[nodiscard]] double number_or(const char* key, double fallback) { return has(key) ? number(key) : fallback; }

  [[nodiscard]] int integer(const char* key, int low, int high) {
    const nlohmann::json* v = find(key);
    if (v == nullptr) return low;
    if (v->is_number_integer() || v->is_number_unsigned()) {
      const double d = v->get<double>();
      if (d >= low && d <= high) return v->get<int>();
    }
    faults_.add(name(key), "must be a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    return low;
  }

  [[nodiscard]] std::string string(const char* key) {
    const nlohmann::json* v = find(key);
    if (v == nullptr) return {};
    if (v->is_string()) return v->get<std::string>();
    faults_.add(name(key), "must be a string");
    return {};
  }

  /// Exactly `count` numbers.
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count) {
    const nlohmann::json* v = find(key);
    return v == nullptr ? std::vector<double>(count) : as_numbers(*v, count, name(key));
  }

  /// Any count of numbers.
  [[nodiscard]] std::vector<double> list(const char* key) {
    const nlohmann::json* v = find(key);
    return v == nullptr ? std::vector<double>() : as_numbers(*v, v->size(), name(key));
  }

  /// `rows` arrays of `cols` numbers, row major.
  [[nodiscard]] std::vector<double> matrix(const char* key, std::size_t rows, std::size_t cols) {
    std::vector<double> out;
    const nlohmann::json* v = find(key);
    if (v == nullptr || !v->is_array() || v->size() != rows) {
      if (v != nullptr) faults_.add(name(key), "must have " + std::to_string(rows) + " rows");
      return std::vector<double>(rows * cols);
    }
    for (const auto& row : *v) {
      const auto values = as_numbers(row, cols, name(key));
      out.insert(out.end(), values.begin(), values.end());
    }
    return out;
  }

  [[nodiscard]] JsonSection section(const char* key) {
    static const nlohmann::json kEmpty = nlohmann::json::object();
    const nlohmann::json* v = find(key);
    if (v != nullptr && !v->is_object()) {
      faults_.add(name(key), "must be an object");
      v = nullptr;
    }
    return {v == nullptr ? kEmpty : *v, name(key) + ".", faults_};
  }

  void refuse(const char* key, const std::string& what) { faults_.add(name(key), what); }

  void append_unknown(std::vector<std::string>& out) const {
    for (const auto& item : object_.items())
      if (!asked_.contains(item.key())) out.push_back(prefix_ + item.key());
  }

 private:
  [[nodiscard]] std::string name(const char* key) const { return prefix_ + key; }

  [[nodiscard]] const nlohmann::json* find(const char* key) {
    const auto it = object_.find(key);
    if (it == object_.end()) {
      faults_.add(name(key), "is missing");
      return nullptr;
    }
    asked_.insert(key);
    return &*it;
  }

  double as_number(const nlohmann::json& v, const std::string& key) {
    if (v.is_number() && std::isfinite(v.get<double>())) return v.get<double>();
    faults_.add(key, "must be a finite number");
    return 0;
  }

  std::vector<double> as_numbers(const nlohmann::json& v, std::size_t count, const std::string& key) {
    std::vector<double> out(count);
    if (!v.is_array() || v.size() != count) {
      faults_.add(key, "must be " + std::to_string(count) + " numbers");
      return out;
    }
    for (std::size_t i = 0; i < count; ++i) out[i] = as_number(v[i], key);
    return out;
  }

  const nlohmann::json& object_;
  std::string prefix_;
  Faults& faults_;
  std::set<std::string> asked_;
};

}  // namespace enamel::calib
