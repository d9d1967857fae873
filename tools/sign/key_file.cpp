#include "tools/sign/key_file.hpp"

#include <fcntl.h>
#include <sodium/core.h>
#include <sodium/crypto_sign.h>
#include <sodium/utils.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/sha256.hpp"

namespace enamel::sign {
namespace {

using Secret = image::SecretKey;

constexpr const char* kFormat = "enamel-key/1";

/// Creates a file that must not be there yet; whole or not at all.
Result<void> create_file(const std::string& path, const std::string& text, mode_t mode) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (fd < 0) return fail(ErrorCode::kFileWrite, path + ": " + std::strerror(errno));
  const bool whole = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(fd) == 0;
  const bool closed = ::close(fd) == 0;
  if (whole && closed) return {};
  ::unlink(path.c_str());
  return fail(ErrorCode::kFileWrite, path);
}

template <std::size_t N>
bool from_hex(const std::string& hex, std::array<unsigned char, N>& out) {
  std::size_t length = 0;
  return sodium_hex2bin(out.data(), out.size(), hex.data(), hex.size(), nullptr, &length, nullptr) == 0 && length == N;
}

struct KeyText {
  std::string kind;
  std::string key;
  bool development = false;
};

Result<KeyText> read_key_text(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  const nlohmann::json j = nlohmann::json::parse(text, nullptr, false);
  const bool usable = j.is_object() && j.value("format", nlohmann::json()) == kFormat && j.contains("kind") &&
                      j["kind"].is_string() && j.contains("key") && j["key"].is_string() && j.contains("development") &&
                      j["development"].is_boolean();
  if (!usable) return fail(ErrorCode::kConfigValue, path + " is no key file of this tool; make one with keygen");
  return KeyText{j["kind"], j["key"], j["development"]};
}

Result<void> check_private(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return fail(ErrorCode::kFileRead, path);
  if ((info.st_mode & 077U) == 0) return {};
  return fail(ErrorCode::kConfigValue, path + " can be read by others: chmod 600 " + path);
}

}  // namespace

Result<image::TrustedKey> make_key(const std::string& path, bool development) {
  if (sodium_init() < 0) return fail(ErrorCode::kInternal, "libsodium has no source of randomness");
  image::TrustedKey key;
  key.development = development;
  Secret secret{};
  crypto_sign_keypair(key.key.data(), secret.data());
  nlohmann::json j = {{"format", kFormat},
                      {"kind", "public"},
                      {"development", development},
                      {"id", to_hex(image::key_id(key.key))},
                      {"key", to_hex(key.key)}};
  const std::string public_text = json_text(j, 1) + "\n";
  j["kind"] = "secret";
  j["key"] = to_hex(secret);
  ENAMEL_TRY(create_file(path, json_text(j, 1) + "\n", S_IRUSR | S_IWUSR));
  sodium_memzero(secret.data(), secret.size());
  if (const auto written = create_file(path + ".pub", public_text, S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH); !written) {
    ::unlink(path.c_str());
    return tl::unexpected(written.error());
  }
  return key;
}

Result<KeyPair> read_secret_key(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const KeyText text, read_key_text(path));
  Secret secret{};
  if (text.kind != "secret" || !from_hex(text.key, secret)) {
    return fail(ErrorCode::kConfigValue, path + " holds no secret key");
  }
  ENAMEL_TRY(check_private(path));
  return KeyPair{image::make_signer(secret), text.development};
}

Result<image::TrustedKey> read_public_key(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const KeyText text, read_key_text(path));
  image::TrustedKey key;
  key.development = text.development;
  Secret secret{};
  if (text.kind == "public" && from_hex(text.key, key.key)) return key;
  if (text.kind == "secret" && from_hex(text.key, secret)) {
    crypto_sign_ed25519_sk_to_pk(key.key.data(), secret.data());
    return key;
  }
  return fail(ErrorCode::kConfigValue, path + " holds no key");
}

}  // namespace enamel::sign
