#include "tools/sign/sign_log.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "protocol/base/file.hpp"
#include "protocol/image/version_text.hpp"

namespace enamel::sign {
Result<std::optional<SignedVersion>> newest_in_log(const std::string& path) {
  const Result<std::string> text = read_file(path);
  if (!text) {
    if (text.error().code == ErrorCode::kFileNotFound) return std::nullopt;
    return tl::unexpected(text.error());
  }
  std::optional<SignedVersion> newest;
  std::istringstream lines(*text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const nlohmann::json j = nlohmann::json::parse(line, nullptr, false);
    const bool usable = j.is_object() && j.contains("version") && j["version"].is_string() &&
                        j.contains("security_counter") && j["security_counter"].is_number_unsigned();
    const std::optional<image::ImageVersion> version =
        usable ? image::parse_version(j["version"].get<std::string>()) : std::nullopt;
    if (!version) return fail(ErrorCode::kConfigSyntax, path + ", line " + std::to_string(number));
    if (!newest || *version > newest->version) newest = SignedVersion{*version, j["security_counter"]};
  }
  return newest;
}

Result<void> append_to_log(const std::string& path, const SignedVersion& entry, const std::string& image_sha256) {
  std::ofstream out(path, std::ios::app);
  out << nlohmann::json({{"version", image::to_text(entry.version)},
                         {"security_counter", entry.security_counter},
                         {"sha256", image_sha256}})
             .dump()
      << '\n';
  out.flush();
  if (!out) return fail(ErrorCode::kFileWrite, path);
  return {};
}

Result<void> check_newer(const SignedVersion& next, const std::optional<SignedVersion>& before,
                         const std::string& where) {
  if (!before) return {};
  if (next.version <= before->version) {
    return fail(ErrorCode::kUsage, "version " + image::to_text(next.version) + " is not newer than " +
                                       image::to_text(before->version) + " in " + where);
  }
  if (next.security_counter < before->security_counter) {
    return fail(ErrorCode::kUsage, "security counter " + std::to_string(next.security_counter) + " is lower than " +
                                       std::to_string(before->security_counter) + " in " + where);
  }
  return {};
}

}  // namespace enamel::sign
