#include "firmware/updater/key_list.hpp"

#include <sodium/utils.h>

#include <nlohmann/json.hpp>

#include "protocol/base/file.hpp"

namespace enamel::fw {
namespace {

Result<image::TrustedKey> read_public_key(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  const nlohmann::json j = nlohmann::json::parse(text, nullptr, false);
  const auto holds = [&](const char* name, nlohmann::json::value_t type) {
    return j.contains(name) && j[name].type() == type;
  };
  using enum nlohmann::json::value_t;
  image::TrustedKey key;
  if (j.is_object() && j.value("format", nlohmann::json()) == "enamel-key/1" &&
      j.value("kind", nlohmann::json()) == "public" && holds("key", string) && holds("development", boolean)) {
    const std::string hex = j["key"];
    std::size_t length = 0;
    key.development = j["development"];
    if (sodium_hex2bin(key.key.data(), key.key.size(), hex.data(), hex.size(), nullptr, &length, nullptr) == 0 &&
        length == key.key.size() && hex.size() == 2 * length) {
      return key;
    }
  }
  return fail(ErrorCode::kConfigValue, path + " is no public key; take the .pub file of enamel-sign keygen");
}

}  // namespace

Result<std::vector<image::TrustedKey>> read_public_keys(const std::vector<std::string>& paths) {
  std::vector<image::TrustedKey> keys;
  for (const std::string& path : paths) {
    ENAMEL_TRY_ASSIGN(const image::TrustedKey key, read_public_key(path));
    keys.push_back(key);
  }
  return keys;
}

}  // namespace enamel::fw
