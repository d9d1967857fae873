#include "tools/twin/app/render_sink.hpp"

#include <filesystem>
#include <map>
#include <span>
#include <utility>

#include "host/record/exchange_folder.hpp"
#include "protocol/capture/capture.hpp"
#include "protocol/types/axes_table.hpp"

namespace enamel::twin {
namespace {

constexpr const char* kAxesFile = "axes.csv";

proto::ByteView view(const std::string& bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

class FolderSink final : public RenderSink {
 public:
  explicit FolderSink(host::ExchangeWriter writer) : writer_(std::move(writer)) {}
  Result<void> axes(const std::string& table, int) override { return file(kAxesFile, table); }
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
  // As host::import_folder of a rendered folder: messages on the channel, the table for its digits.
  Result<void> axes(const std::string& table, int bursts_a_stop) override {
    ENAMEL_TRY_ASSIGN(const auto readings, proto::parse_burst_axes(table, kAxesFile));
    for (const proto::AxesReading& reading : readings) {
      proto::AxesReading& kept = readings_[reading.burst_index];
      kept = reading;
      kept.stop = static_cast<std::uint32_t>(reading.burst_index / static_cast<std::uint64_t>(bursts_a_stop));
    }
    return file(kAxesFile, table);
  }
  Result<void> burst(const proto::Burst& b) override {
    const auto log_ns = static_cast<std::int64_t>(b.t_publish_ns);
    if (const auto at = readings_.find(b.burst_index); at != readings_.end()) {
      proto::AxesReading reading = at->second;
      reading.probe_id = b.probe_id;
      reading.session_id = b.session_id;
      ENAMEL_TRY(writer_.write_axes(reading, log_ns));
    }
    return writer_.write_burst(b, log_ns);
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
  std::map<std::uint64_t, proto::AxesReading> readings_;
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
