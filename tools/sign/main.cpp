// enamel-sign: makes keys, signs firmware images, looks into them. Not shipped to the field.
#include <array>
#include <cstdio>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"
#include "protocol/base/stdout_check.hpp"
#include "protocol/base/subcommands.hpp"
#include "protocol/image/image_file.hpp"
#include "tools/sign/inspect.hpp"
#include "tools/sign/key_file.hpp"
#include "tools/sign/package_image.hpp"
#include "tools/sign/sign_image.hpp"

namespace {

using enamel::Error;
using enamel::Result;
namespace sign = enamel::sign;
namespace image = enamel::image;

constexpr int kUsage = 2;
using Run = std::function<Result<int>()>;

Run add_keygen(CLI::App& app) {
  auto out = std::make_shared<std::string>();
  auto development = std::make_shared<bool>(false);
  app.add_option("--out", *out, "secret key file; the public one gets .pub")->required();
  app.add_flag("--development", *development, "good for development units only");
  return [=]() -> Result<int> {
    ENAMEL_TRY_ASSIGN(const image::TrustedKey key, sign::make_key(*out, *development));
    std::printf("%s\n", enamel::to_hex(image::key_id(key.key)).c_str());
    return 0;
  };
}

Run add_sign(CLI::App& app) {
  auto o = std::make_shared<sign::SignRequest>();
  app.add_option("--key", o->keys, "secret key; twice for two signatures")->required()->expected(1, 2);
  app.add_option("--payload", o->payload, "the application image");
  app.add_option("--component", o->components, "KIND:FILE, instead of --payload; kinds in docs/firmware-image.md");
  app.add_option("--version", o->version, "MAJOR.MINOR.REVISION[+BUILD]")->required();
  app.add_option("--counter", o->security_counter, "anti-rollback counter")->required();
  app.add_option("--hardware", o->hardware, "lowest[:highest] hardware revision")->required();
  app.add_flag("--factory-only", o->factory_only,
               "for units that are still in the factory; probes in the field refuse it");
  app.add_option("--min-bootloader", o->min_bootloader, "MAJOR.MINOR.REVISION[+BUILD]");
  app.add_option("--notes", o->notes, "text for people");
  app.add_option("--build-time", o->build_time_unix_s, "UTC, s since 1970; fixed for repeatable builds");
  app.add_option("--after", o->after, "the release before this one; default: the log beside the key");
  app.add_option("--out", o->out, "image (*.enfw)")->required();
  return [o]() -> Result<int> {
    ENAMEL_TRY_ASSIGN(const std::string sha, sign::sign_image(*o));
    std::printf("%s  %s\n", sha.c_str(), o->out.c_str());
    return 0;
  };
}

int refused(image::Refusal why) {
  const image::RefusalText text = image::describe_refusal(static_cast<std::uint32_t>(why));
  std::fprintf(stderr, "error %d: %.*s\n  likely cause: %.*s\n  what to do: %.*s\n", static_cast<int>(why),
               static_cast<int>(text.what.size()), text.what.data(), static_cast<int>(text.cause.size()),
               text.cause.data(), static_cast<int>(text.remedy.size()), text.remedy.data());
  return image::exit_code(why);
}

Run add_inspect(CLI::App& app) {
  auto file = std::make_shared<std::string>();
  auto keys = std::make_shared<std::vector<std::string>>();
  app.add_option("FILE", *file, "image (*.enfw)")->required();
  app.add_option("--key", *keys, "public keys that its signatures must be by");
  return [=]() -> Result<int> {
    std::vector<image::TrustedKey> trusted;
    for (const std::string& path : *keys) {
      ENAMEL_TRY_ASSIGN(const image::TrustedKey key, sign::read_public_key(path));
      trusted.push_back(key);
    }
    ENAMEL_TRY_ASSIGN(const std::string content, enamel::read_file(*file));
    const auto manifest = image::check_image_file(std::as_bytes(std::span(content)), trusted);
    if (!manifest) return refused(manifest.error());
    nlohmann::json j = sign::describe(*manifest);
    j["signatures"] = trusted.empty() ? "not checked: no --key" : "good";
    std::printf("%s\n", enamel::json_text(j, 1).c_str());
    return 0;
  };
}

Run add_package(CLI::App& app) {
  auto file = std::make_shared<std::string>();
  auto out = std::make_shared<std::string>();
  auto metainfo = std::make_shared<std::string>();
  app.add_option("IMAGE", *file, "image (*.enfw)")->required();
  app.add_option("--out", *out, "cabinet (*.cab) for fwupd")->required();
  app.add_option("--metainfo", *metainfo, "write the metainfo there as well");
  return [=]() -> Result<int> {
    ENAMEL_TRY_ASSIGN(const std::string content, enamel::read_file(*file));
    const auto manifest = image::check_image_file(std::as_bytes(std::span(content)), {});
    if (!manifest) return refused(manifest.error());
    const std::string text = sign::make_metainfo(*manifest);
    if (!metainfo->empty()) ENAMEL_TRY(enamel::write_file(*metainfo, text));
    ENAMEL_TRY(sign::write_cabinet(*out, content, text));
    std::printf("%s  %s\n", sign::fwupd_guid().c_str(), out->c_str());
    return 0;
  };
}

constexpr std::array<enamel::Subcommand<Run>, 4> kCommands{{
    {"keygen", "make a key pair", add_keygen},
    {"sign", "put an image together and sign it", add_sign},
    {"inspect", "print and check an image (JSON)", add_inspect},
    {"package", "wrap an image for fwupd", add_package},
}};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Keys and signatures of firmware images.", "enamel-sign");
  const auto command = enamel::parse_subcommand<Run>(app, kCommands, argc, argv, kUsage);
  if (!command) return enamel::with_stdout_written(command.error());
  const Result<int> done = (*command)();
  if (done) return enamel::with_stdout_written(*done);
  std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return kUsage;
}
