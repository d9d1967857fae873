#include "tools/sign/inspect.hpp"

#include <nlohmann/json.hpp>

#include "protocol/image/version_text.hpp"

namespace enamel::sign {

using image::Checked;
using image::Manifest;
using image::Refusal;
using image::refuse;

nlohmann::json describe(const Manifest& m) {
  nlohmann::json j = {{"version", to_text(m.version)},
                      {"security_counter", m.security_counter},
                      {"hardware", {m.hw_rev_min, m.hw_rev_max}},
                      {"payload_bytes", m.payload_len},
                      {"chunks", m.chunk_count},
                      {"manifest_bytes", m.manifest_len},
                      {"manifest_sha256", to_hex(sha256(m.bytes))},
                      {"build_time_unix_s", m.build_time_unix_s},
                      {"development", (m.flags & image::image_flags::kDevelopment) != 0},
                      {"factory_only", (m.flags & image::image_flags::kFactoryOnly) != 0},
                      {"components", nlohmann::json::array()},
                      {"signed_by", nlohmann::json::array()}};
  for (std::size_t i = 0; i < m.signature_count; ++i) j["signed_by"].push_back(to_hex(m.signer(i)));
  if (m.min_bootloader) j["min_bootloader"] = to_text(*m.min_bootloader);
  if (m.protocol) j["protocol"] = {m.protocol->lowest, m.protocol->highest};
  image::for_each_tlv(m, [&](std::uint16_t type, std::span<const std::byte> value) {
    const std::string text(reinterpret_cast<const char*>(value.data()), value.size());
    if (type == image::tlv::kNotes) j["notes"] = text;
    if (type == image::tlv::kGitCommit) {
      j["git_commit"] = to_hex({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
    }
    if (const auto c = image::parse_component(value); type == image::tlv::kComponent && c) {
      j["components"].push_back(
          {{"kind", c->kind}, {"offset", c->offset}, {"bytes", c->length}, {"sha256", to_hex(c->sha256)}});
    }
  });
  return j;
}

}  // namespace enamel::sign
