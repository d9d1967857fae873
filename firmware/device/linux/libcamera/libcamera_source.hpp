// A stream of a real camera through libcamera.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/device/linux/camera/request_source.hpp"

namespace enamel::fw {

struct StreamWish {
  std::string camera = "any";  ///< id or model
  std::string format = "R8";   ///< R8, R10, R10_CSI2P
  int width = 640;
  int height = 400;
  int buffers = 8;  ///< at most 64
};

class LibcameraSource final : public RequestSource {
 public:
  /// Acquires the camera. Exactly what is wished, or an error that says what is offered. Errors: kCamera; kConfigValue
  /// for a wish that names no raw format.
  [[nodiscard]] static Result<std::shared_ptr<LibcameraSource>> open(const StreamWish& wish);
  ~LibcameraSource() override;
  LibcameraSource(const LibcameraSource&) = delete;
  LibcameraSource& operator=(const LibcameraSource&) = delete;

  [[nodiscard]] const StreamFormat& format() const override;
  [[nodiscard]] int slots() const override;
  [[nodiscard]] std::span<const std::uint8_t> memory(int slot) const override;
  [[nodiscard]] Result<void> start(const CameraControls& controls, CompletionSink& sink) override;
  void stop() noexcept override;
  [[nodiscard]] Result<void> queue(int slot, const std::optional<CameraControls>& change) override;

  /// Names of the controls among exposure, gain, frame duration and auto-exposure that this camera's driver does not
  /// have: what they do stays as it is.
  [[nodiscard]] const std::vector<std::string>& missing_controls() const;

 private:
  struct Parts;
  explicit LibcameraSource(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace enamel::fw
