#include "tools/twin/app/render_sink.hpp"

#include <filesystem>
#include <span>
#include <utility>

#include "host/record/exchange_folder.hpp"
#include "protocol/capture/capture.hpp"

namespace enamel::twin {
namespace {

proto::ByteView view(const std::string& bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

class FolderSink final : public RenderSink {
 public:
  explicit FolderSink(host::ExchangeWriter writer) : writer_(std::move(writer)) {}
  Result<void> burst(const proto::Burst& b) override { return writer_.write(b); }
  Result<void> file(const std::string& name, const std::string& bytes) override {
    return writer_.write_file(name, view(bytes));
  }
  Result<void> finish() override { return writer_.finish(); }

 private:
  host::ExchangeWriter writer_;
};

class CaptureSink final : public RenderSink {
 public:
  explicit CaptureSink(capture::CaptureWriter writer) : writer_(std::move(writer)) {}
  Result<void> burst(const proto::Burst& b) override {
    return writer_.write_burst(b, static_cast<std::int64_t>(b.t_publish_ns));
  }
  Result<void> file(const std::string& name, const std::string& bytes) override {
    return writer_.attach(name, media_type(name), view(bytes));
  }
  Result<void> finish() override { return writer_.finish(); }

 private:
  static std::string media_type(const std::string& name) {
    const std::string ext = std::filesystem::path(name).extension().string();
    if (ext == ".csv") return "text/csv";
    if (ext == ".json") return "application/json";
    if (ext == ".png") return "image/png";
    return "application/octet-stream";
  }
  capture::CaptureWriter writer_;
};

}  // namespace

Result<std::unique_ptr<RenderSink>> open_sink(const std::string& path, const std::string& rig_text) {
  if (std::filesystem::path(path).extension() == ".mcap") {
    capture::CaptureHeader header;
    header.rig_text = rig_text;
    header.program = "enamel-twin 0.1.0";
    header.metadata = {{"light", "SIMULATED"}};
    ENAMEL_TRY_ASSIGN(capture::CaptureWriter writer, capture::CaptureWriter::create(path, header));
    return std::unique_ptr<RenderSink>(std::make_unique<CaptureSink>(std::move(writer)));
  }
  ENAMEL_TRY_ASSIGN(host::ExchangeWriter writer, host::ExchangeWriter::create(path, rig_text));
  return std::unique_ptr<RenderSink>(std::make_unique<FolderSink>(std::move(writer)));
}

}  // namespace enamel::twin
