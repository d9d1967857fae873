#include "calib/model/json_seal.hpp"

#include <nlohmann/json.hpp>
#include <span>

#include "protocol/base/json_text.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::calib {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& json) { return json_text(json, 1) + "\n"; }

std::string hash_of(Json json) {
  json["sha256"] = "";
  const std::string text = text_of(json);
  return sha256_hex(std::as_bytes(std::span<const char>(text)));
}

}  // namespace

std::string sealed_text(Json json) {
  json["sha256"] = hash_of(json);
  return text_of(json);
}

bool is_sealed(const Json& json) {
  if (!json.is_object() || !json.contains("sha256")) return false;
  return json["sha256"].is_string() && json["sha256"].get<std::string>() == hash_of(json);
}

}  // namespace enamel::calib
