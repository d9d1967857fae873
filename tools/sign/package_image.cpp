#include "tools/sign/package_image.hpp"

#include <fmt/format.h>
#include <libgcab.h>

#include <array>
#include <cstdint>
#include <memory>

#include "protocol/base/file.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/image/dfu.hpp"
#include "protocol/image/version_text.hpp"

namespace enamel::sign {
namespace {

constexpr const char* kImageName = "firmware.enfw";
constexpr const char* kMetainfoName = "firmware.metainfo.xml";

/// RFC 4122, appendix C: the namespace of domain names.
constexpr std::array<std::uint8_t, 16> kDnsNamespace = {0x6b, 0xa7, 0xb8, 0x10, 0x9d, 0xad, 0x11, 0xd1,
                                                        0x80, 0xb4, 0x00, 0xc0, 0x4f, 0xd4, 0x30, 0xc8};

struct Unref {
  void operator()(void* object) const noexcept { g_object_unref(object); }
};
template <class T>
using Object = std::unique_ptr<T, Unref>;

std::string uuid5(const std::string& name) {
  const std::unique_ptr<GChecksum, decltype(&g_checksum_free)> sum(g_checksum_new(G_CHECKSUM_SHA1), g_checksum_free);
  g_checksum_update(sum.get(), kDnsNamespace.data(), kDnsNamespace.size());
  g_checksum_update(sum.get(), reinterpret_cast<const guchar*>(name.data()), static_cast<gssize>(name.size()));
  std::array<std::uint8_t, 20> sha1{};
  gsize length = sha1.size();
  g_checksum_get_digest(sum.get(), sha1.data(), &length);
  sha1[6] = static_cast<std::uint8_t>((sha1[6] & 0x0FU) | 0x50U);  // version 5
  sha1[8] = static_cast<std::uint8_t>((sha1[8] & 0x3FU) | 0x80U);  // variant of RFC 4122
  const std::string hex = to_hex(std::span(sha1).first(16));
  return hex.substr(0, 8) + "-" + hex.substr(8, 4) + "-" + hex.substr(12, 4) + "-" + hex.substr(16, 4) + "-" +
         hex.substr(20);
}

Result<void> add(GCabFolder* folder, const char* name, const std::string& content, GDateTime* date) {
  GBytes* const bytes = g_bytes_new(content.data(), content.size());
  const Object<GCabFile> file(gcab_file_new_with_bytes(name, bytes));
  g_bytes_unref(bytes);
  gcab_file_set_date_time(file.get(), date);
  if (gcab_folder_add_file(folder, file.get(), FALSE, nullptr, nullptr) != FALSE) return {};
  return fail(ErrorCode::kFileWrite, std::string("cabinet entry ") + name);
}

}  // namespace

std::string fwupd_guid() {
  return uuid5(fmt::format("USB\\VID_{:04X}&PID_{:04X}", image::kUsbVendor, image::kUsbProduct));
}

std::string make_metainfo(const image::Manifest& m) {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<component type="firmware">
  <id>org.enamel.probe.firmware</id>
  <name>enamel probe</name>
  <summary>Firmware of the enamel intraoral probe</summary>
  <description><p>For hardware revisions {} to {}. Interrupted at any point, the old firmware boots.</p></description>
  <provides>
    <firmware type="flashed">{}</firmware>
  </provides>
  <metadata_license>CC0-1.0</metadata_license>
  <project_license>Apache-2.0</project_license>
  <releases>
    <release urgency="medium" version="{}.{}" timestamp="{}" install_duration="60">
      <checksum filename="{}" target="content"/>
      <description><p>Firmware {}, security counter {}.</p></description>
    </release>
  </releases>
  <custom>
    <value key="LVFS::VersionFormat">pair</value>
    <value key="LVFS::UpdateProtocol">org.usb.dfu</value>
  </custom>
</component>
)",
                     m.hw_rev_min, m.hw_rev_max, fwupd_guid(), m.version.major, m.version.minor, m.build_time_unix_s,
                     kImageName, image::to_text(m.version), m.security_counter);
}

Result<void> write_cabinet(const std::string& path, const std::string& file, const std::string& metainfo) {
  const Object<GCabFolder> folder(gcab_folder_new(GCAB_COMPRESSION_NONE));
  // A fixed date: the same image gives the same cabinet. 1980 is the first year that the format can say.
  const std::unique_ptr<GDateTime, decltype(&g_date_time_unref)> date(g_date_time_new_utc(1980, 1, 1, 0, 0, 0),
                                                                      g_date_time_unref);
  ENAMEL_TRY(add(folder.get(), kImageName, file, date.get()));
  ENAMEL_TRY(add(folder.get(), kMetainfoName, metainfo, date.get()));
  const Object<GCabCabinet> cabinet(gcab_cabinet_new());
  const Object<GOutputStream> stream(g_memory_output_stream_new_resizable());
  const bool made = gcab_cabinet_add_folder(cabinet.get(), folder.get(), nullptr) != FALSE &&
                    gcab_cabinet_write_simple(cabinet.get(), stream.get(), nullptr, nullptr, nullptr, nullptr) != FALSE;
  if (!made) return fail(ErrorCode::kFileWrite, path + ": the cabinet cannot be put together");
  auto* const memory = G_MEMORY_OUTPUT_STREAM(stream.get());
  return write_file(path, {static_cast<const char*>(g_memory_output_stream_get_data(memory)),
                           g_memory_output_stream_get_data_size(memory)});
}

}  // namespace enamel::sign
