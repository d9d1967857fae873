#pragma once
#include <optional>

#include "host/desktop/desktop_model.hpp"
#include "host/motion/axes.hpp"
namespace enamel::host {
class StopChooser {
 public:
  virtual ~StopChooser() = default;
  virtual std::optional<motion::AxesAngles> next(const DesktopModel&) = 0;
  [[nodiscard]] virtual std::size_t planned() const = 0;
};
inline Result<std::unique_ptr<StopChooser>> make_plan(const std::string&, const motion::AxesLimits&) {
  struct Fixed final : StopChooser {
    std::size_t n = 0;
    std::optional<motion::AxesAngles> next(const DesktopModel&) override {
      if (n == 24) return std::nullopt;
      const std::size_t k = n++;
      return motion::AxesAngles{15.0 * static_cast<double>(k), 0.0};
    }
    [[nodiscard]] std::size_t planned() const override { return 24; }
  };
  return std::unique_ptr<StopChooser>(std::make_unique<Fixed>());
}
}  // namespace enamel::host
