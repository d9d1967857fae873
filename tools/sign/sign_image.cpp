#include "tools/sign/sign_image.hpp"

#include <charconv>
#include <optional>
#include <span>

#include "protocol/base/file.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/image/image_file.hpp"
#include "protocol/image/version_text.hpp"
#include "tools/sign/key_file.hpp"
#include "tools/sign/sign_log.hpp"

namespace enamel::sign {
namespace {

constexpr std::uint8_t kApplication = 1;
constexpr std::uint8_t kHighestKind = 5;

struct Payload {
  std::string bytes;
  std::vector<image::Component> parts;
};

Result<void> append(Payload& payload, std::uint8_t kind, const std::string& path) {
  ENAMEL_TRY_ASSIGN(const std::string bytes, read_file(path));
  payload.parts.push_back({kind, 0, payload.bytes.size(), bytes.size(), {}});
  payload.bytes += bytes;
  return {};
}

Result<Payload> gather(const SignRequest& request) {
  if (request.payload.empty() == request.components.empty()) {
    return fail(ErrorCode::kUsage, "give --payload or --component, one of the two");
  }
  Payload payload;
  if (!request.payload.empty()) ENAMEL_TRY(append(payload, kApplication, request.payload));
  for (const std::string& text : request.components) {
    const bool shaped = text.size() > 2 && text[1] == ':' && text[0] >= '1' && text[0] <= '0' + kHighestKind;
    if (!shaped) return fail(ErrorCode::kUsage, "--component " + text + ": KIND:FILE with KIND from 1 to 5");
    ENAMEL_TRY(append(payload, static_cast<std::uint8_t>(text[0] - '0'), text.substr(2)));
  }
  return payload;
}

Result<image::ImageVersion> version_of(const std::string& text, const char* option) {
  const std::optional<image::ImageVersion> version = image::parse_version(text);
  if (!version) return fail(ErrorCode::kUsage, std::string(option) + " " + text + ": MAJOR.MINOR.REVISION[+BUILD]");
  return *version;
}

Result<void> set_hardware(const std::string& text, image::ImageDescription& d) {
  const char* const end = text.data() + text.size();
  auto read = std::from_chars(text.data(), end, d.hw_rev_min);
  d.hw_rev_max = d.hw_rev_min;
  if (read.ec == std::errc() && read.ptr != end && *read.ptr == ':')
    read = std::from_chars(read.ptr + 1, end, d.hw_rev_max);
  if (read.ec != std::errc() || read.ptr != end)
    return fail(ErrorCode::kUsage, "--hardware " + text + ": LOWEST[:HIGHEST]");
  return {};
}

Result<image::ImageDescription> describe_image(const SignRequest& request, const Payload& payload, bool development) {
  image::ImageDescription d;
  ENAMEL_TRY_ASSIGN(d.version, version_of(request.version, "--version"));
  if (!request.min_bootloader.empty()) {
    ENAMEL_TRY_ASSIGN(d.min_bootloader, version_of(request.min_bootloader, "--min-bootloader"));
  }
  ENAMEL_TRY(set_hardware(request.hardware, d));
  d.security_counter = request.security_counter;
  if (development) d.flags |= image::image_flags::kDevelopment;
  if (request.factory_only) d.flags |= image::image_flags::kFactoryOnly;
  d.build_time_unix_s = request.build_time_unix_s;
  d.components = payload.parts;
  d.notes = request.notes;
  return d;
}

Result<std::optional<SignedVersion>> release_before(const SignRequest& request, const std::string& log) {
  if (request.after.empty()) return newest_in_log(log);
  ENAMEL_TRY_ASSIGN(const std::string bytes, read_file(request.after));
  const auto manifest = image::open_image(std::as_bytes(std::span(bytes)));
  if (!manifest) return fail(ErrorCode::kUsage, "--after " + request.after + " is no firmware image");
  return SignedVersion{manifest->version, manifest->security_counter};
}

}  // namespace

Result<std::string> sign_image(const SignRequest& request) {
  std::vector<image::Signer> signers;
  bool development = false;
  for (const std::string& path : request.keys) {
    ENAMEL_TRY_ASSIGN(const KeyPair key, read_secret_key(path));
    signers.push_back(key.signer);
    development = development || key.development;
  }
  ENAMEL_TRY_ASSIGN(const Payload payload, gather(request));
  ENAMEL_TRY_ASSIGN(const image::ImageDescription description, describe_image(request, payload, development));
  const std::string log = request.keys.front() + ".log";
  ENAMEL_TRY_ASSIGN(const std::optional<SignedVersion> before, release_before(request, log));
  const SignedVersion next{description.version, description.security_counter};
  ENAMEL_TRY(check_newer(next, before, request.after.empty() ? log : request.after));

  ENAMEL_TRY_ASSIGN(const std::vector<std::byte> image,
                    image::build_image(description, std::as_bytes(std::span(payload.bytes)), signers));
  const std::string sha = sha256_hex(image);
  ENAMEL_TRY(write_file(request.out, {reinterpret_cast<const char*>(image.data()), image.size()}));
  ENAMEL_TRY(append_to_log(log, next, sha));
  return sha;
}

}  // namespace enamel::sign
