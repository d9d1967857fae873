#include "firmware/device/linux/libcamera/libcamera_source.hpp"

#include <libcamera/libcamera.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>

#include "firmware/device/linux/libcamera/compat.hpp"
#include "firmware/device/linux/libcamera/runtime.hpp"

namespace enamel::fw {
namespace {

namespace lc = libcamera;

constexpr std::size_t kModesTold = 12;

struct RawFormat {
  const char* name;
  lc::PixelFormat format;
  PixelFormat pixels;
  int bit_depth;
};

const std::array<RawFormat, 3>& raw_formats() {
  static const std::array<RawFormat, 3> formats{{{"R8", lc::formats::R8, PixelFormat::kRaw8, 8},
                                                 {"R10", lc::formats::R10, PixelFormat::kRaw16, 10},
                                                 {"R10_CSI2P", lc::formats::R10_CSI2P, PixelFormat::kRaw10Packed, 10}}};
  return formats;
}

Result<const RawFormat*> raw_format(const std::string& name) {
  for (const RawFormat& f : raw_formats()) {
    if (name == f.name) return &f;
  }
  return fail(ErrorCode::kConfigValue, "camera format '" + name + "': R8, R10 or R10_CSI2P; colour carries no phase");
}

Error refused(const std::string& what, int error) {
  return {ErrorCode::kCamera, "camera: " + what + ": " + std::strerror(error < 0 ? -error : error)};
}

std::string some_of(const std::vector<std::string>& modes) {
  std::string text;
  for (std::size_t i = 0; i < std::min(modes.size(), kModesTold); ++i) text += (i == 0 ? "" : ", ") + modes[i];
  if (modes.size() > kModesTold) text += ", …";
  return text.empty() ? "nothing" : text;
}

/// A buffer's memory, mapped from its file's begin: planes may share one file.
class Mapping {
 public:
  Mapping() = default;
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  Mapping(Mapping&& other) noexcept : bytes_(std::exchange(other.bytes_, {})), offset_(other.offset_) {}
  Mapping& operator=(Mapping&&) = delete;
  ~Mapping() {
    if (!bytes_.empty()) ::munmap(bytes_.data(), bytes_.size());
  }
  [[nodiscard]] static Result<Mapping> of(const lc::FrameBuffer::Plane& plane) {
    const std::size_t size = std::size_t{plane.offset} + plane.length;
    void* at = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
    if (at == MAP_FAILED) return tl::unexpected(refused("a buffer cannot be mapped", errno));
    Mapping mapping;
    mapping.bytes_ = {static_cast<std::uint8_t*>(at), size};
    mapping.offset_ = plane.offset;
    return mapping;
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return bytes_.subspan(offset_); }

 private:
  std::span<std::uint8_t> bytes_;
  std::size_t offset_ = 0;
};

}  // namespace

/// In order of dependence: requests, buffers and configuration go before the camera, the camera before its manager.
struct LibcameraSource::Parts {
  std::shared_ptr<CameraRuntime> runtime;
  std::shared_ptr<lc::Camera> camera;
  std::unique_ptr<lc::CameraConfiguration> config;
  std::unique_ptr<lc::FrameBufferAllocator> allocator;
  std::vector<Mapping> memory;
  std::vector<std::unique_ptr<lc::Request>> requests;
  StreamFormat format;
  std::vector<std::string> missing;
  bool acquired = false;
  bool running = false;
  std::atomic<CompletionSink*> sink{nullptr};  ///< read on libcamera's thread

  ~Parts() {
    if (camera && running) camera->stop();
    if (camera) {
      camera->requestCompleted.disconnect(this);
      camera->disconnected.disconnect(this);
    }
    requests.clear();
    memory.clear();
    allocator.reset();
    if (camera && acquired) camera->release();
  }

  [[nodiscard]] bool has(const lc::ControlId& id) const {
    return camera->controls().find(id.id()) != camera->controls().end();
  }
  [[nodiscard]] Result<void> configure(const StreamWish& wish);
  [[nodiscard]] Result<void> allocate();
  void look_for_controls();
  void fill(lc::ControlList& list, const CameraControls& controls) const;
  void on_completed(lc::Request* request);
  void on_disconnected() {
    if (CompletionSink* const hears = sink) hears->disconnected();
  }
};

Result<void> LibcameraSource::Parts::configure(const StreamWish& wish) {
  ENAMEL_TRY_ASSIGN(const RawFormat* const raw, raw_format(wish.format));
  config = camera->generateConfiguration({lc::StreamRole::Raw});
  if (!config || config->empty()) config = camera->generateConfiguration({lc::StreamRole::Viewfinder});
  if (!config || config->empty()) return fail(ErrorCode::kCamera, "camera " + camera->id() + " offers no stream");
  lc::StreamConfiguration& stream = config->at(0);
  const std::string offered = some_of(modes_of(stream));
  const lc::Size size(static_cast<unsigned>(wish.width), static_cast<unsigned>(wish.height));
  stream.pixelFormat = raw->format;
  stream.size = size;
  stream.bufferCount = static_cast<unsigned>(wish.buffers);
  // Adjusted: other rows, other depth, a scaler in between. Fewer or more buffers are no other picture.
  if (config->validate() == lc::CameraConfiguration::Invalid || stream.pixelFormat != raw->format ||
      stream.size != size) {
    return fail(ErrorCode::kCamera, "camera " + camera->id() + " has no " + wish.format + " of " + size.toString() +
                                        "; it offers " + offered);
  }
  if (const int error = camera->configure(config.get()); error != 0) {
    return tl::unexpected(refused(camera->id() + " cannot be configured", error));
  }
  format = {wish.width, wish.height, raw->bit_depth, raw->pixels, stream.stride};
  return {};
}

Result<void> LibcameraSource::Parts::allocate() {
  lc::Stream* const stream = config->at(0).stream();
  allocator = std::make_unique<lc::FrameBufferAllocator>(camera);
  if (const int count = allocator->allocate(stream); count < 0) {
    return tl::unexpected(refused("no memory for its buffers", count));
  }
  for (const auto& buffer : allocator->buffers(stream)) {
    auto request = camera->createRequest(memory.size());
    if (!request || buffer->planes().size() != 1 || request->addBuffer(stream, buffer.get()) != 0) {
      return fail(ErrorCode::kCamera, "camera: a request for its buffers cannot be made");
    }
    ENAMEL_TRY_ASSIGN(auto mapped, Mapping::of(buffer->planes()[0]));
    memory.push_back(std::move(mapped));
    requests.push_back(std::move(request));
  }
  return {};
}

void LibcameraSource::Parts::look_for_controls() {
  for (const lc::ControlId* id : std::initializer_list<const lc::ControlId*>{
           &lc::controls::ExposureTime, &lc::controls::AnalogueGain, &lc::controls::FrameDurationLimits}) {
    if (!has(*id)) missing.push_back(id->name());
  }
}

void LibcameraSource::Parts::fill(lc::ControlList& list, const CameraControls& controls) const {
  const std::int64_t period_us = controls.frame_period.count() / 1000;
  if (has(lc::controls::AeEnable)) list.set(lc::controls::AeEnable, false);
  // Limits that are equal fix the rate; set with the exposure, which they would clip.
  if (has(lc::controls::FrameDurationLimits)) {
    const std::array<std::int64_t, 2> limits{period_us, period_us};
    list.set(lc::controls::FrameDurationLimits, lc::Span<const std::int64_t, 2>(limits));
  }
  if (has(lc::controls::ExposureTime)) {
    list.set(lc::controls::ExposureTime, static_cast<std::int32_t>(controls.exposure_us));
  }
  if (has(lc::controls::AnalogueGain)) {
    list.set(lc::controls::AnalogueGain, static_cast<float>(controls.analogue_gain_q8) / 256.0F);
  }
}

/// On libcamera's thread.
void LibcameraSource::Parts::on_completed(lc::Request* request) {
  CompletionSink* const hears = sink;
  if (hears == nullptr) return;
  Completion done;
  done.slot = static_cast<int>(request->cookie());
  if (request->status() == lc::Request::RequestCancelled || request->buffers().empty()) {
    done.status = FrameStatus::kCancelled;
    return hears->completed(done);
  }
  const lc::FrameMetadata& frame = request->buffers().begin()->second->metadata();
  const lc::ControlList& metadata = request->metadata();
  done.status = compat::frame_status(frame);
  done.sequence = frame.sequence;
  const auto stamp = metadata.get(lc::controls::SensorTimestamp);
  done.stamp_ns = stamp ? *stamp : static_cast<std::int64_t>(frame.timestamp);
  if (const auto us = metadata.get(lc::controls::ExposureTime)) done.exposure_us = static_cast<std::uint32_t>(*us);
  if (const auto gain = metadata.get(lc::controls::AnalogueGain)) {
    done.analogue_gain_q8 = static_cast<std::uint32_t>(std::lround(*gain * 256.0F));
  }
  hears->completed(done);
}

LibcameraSource::LibcameraSource(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
LibcameraSource::~LibcameraSource() = default;

Result<std::shared_ptr<LibcameraSource>> LibcameraSource::open(const StreamWish& wish) {
  if (wish.width < 1 || wish.height < 1 || wish.buffers < 1 || wish.buffers > 64) {
    return fail(ErrorCode::kConfigValue, "camera: size " + std::to_string(wish.width) + "x" +
                                             std::to_string(wish.height) + ", " + std::to_string(wish.buffers) +
                                             " buffers");
  }
  ENAMEL_TRY(raw_format(wish.format));
  auto parts = std::make_unique<Parts>();
  ENAMEL_TRY_ASSIGN(parts->runtime, CameraRuntime::get());
  ENAMEL_TRY_ASSIGN(parts->camera, parts->runtime->find(wish.camera));
  if (const int error = parts->camera->acquire(); error != 0) {
    return tl::unexpected(refused(parts->camera->id() + " is not free: another program has it", error));
  }
  parts->acquired = true;
  ENAMEL_TRY(parts->configure(wish));
  ENAMEL_TRY(parts->allocate());
  parts->look_for_controls();
  parts->camera->requestCompleted.connect(parts.get(), &Parts::on_completed);
  parts->camera->disconnected.connect(parts.get(), &Parts::on_disconnected);
  return std::shared_ptr<LibcameraSource>(new LibcameraSource(std::move(parts)));
}

const StreamFormat& LibcameraSource::format() const { return parts_->format; }
int LibcameraSource::slots() const { return static_cast<int>(parts_->requests.size()); }
const std::vector<std::string>& LibcameraSource::missing_controls() const { return parts_->missing; }
std::span<const std::uint8_t> LibcameraSource::memory(int slot) const {
  return parts_->memory[static_cast<std::size_t>(slot)].bytes();
}

Result<void> LibcameraSource::start(const CameraControls& controls, CompletionSink& sink) {
  parts_->sink = &sink;
  lc::ControlList list(parts_->camera->controls());
  parts_->fill(list, controls);
  if (const int error = parts_->camera->start(&list); error != 0) {
    return tl::unexpected(refused(parts_->camera->id() + " does not start", error));
  }
  parts_->running = true;
  return {};
}

void LibcameraSource::stop() noexcept {
  if (std::exchange(parts_->running, false)) parts_->camera->stop();
}

Result<void> LibcameraSource::queue(int slot, const std::optional<CameraControls>& change) {
  lc::Request& request = *parts_->requests[static_cast<std::size_t>(slot)];
  request.reuse(lc::Request::ReuseBuffers);
  if (change) parts_->fill(request.controls(), *change);
  if (const int error = parts_->camera->queueRequest(&request); error != 0) {
    return tl::unexpected(refused("a request is refused", error));
  }
  return {};
}

}  // namespace enamel::fw
