#include "calib/model/json_object.hpp"

#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace enamel::calib {
namespace {

/// Watches a parser for keys that stand twice in one object.
class TwiceWritten {
 public:
  using Event = nlohmann::json::parse_event_t;

  bool operator()(int /*depth*/, Event event, const nlohmann::json& parsed) {
    if (event == Event::object_start) seen_.emplace_back();
    if (event == Event::object_end) seen_.pop_back();
    if (event != Event::key) return true;
    const auto& key = parsed.get_ref<const std::string&>();
    if (!seen_.back().insert(key).second && key_.empty()) key_ = key;
    return true;
  }

  /// The first such key; empty: none.
  [[nodiscard]] const std::string& key() const noexcept { return key_; }

 private:
  std::vector<std::set<std::string>> seen_;  ///< of each object that is open
  std::string key_;
};

}  // namespace

Result<nlohmann::json> parse_json_object(std::string_view text, ErrorCode code) {
  TwiceWritten twice;
  auto json = nlohmann::json::parse(text, std::ref(twice), /*allow_exceptions=*/false);
  if (json.is_discarded()) return fail(code, "not valid JSON (NaN and infinity are no JSON numbers)");
  if (!twice.key().empty())
    return fail(code, "key '" + twice.key() + "' is written twice: nobody can tell which one holds");
  if (!json.is_object()) return fail(code, "the file must hold one object");
  return json;
}

}  // namespace enamel::calib
