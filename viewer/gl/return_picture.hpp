// The model in small with the place to return to, shown while a segment apart from it is scanned. Needs the current
// OpenGL context of its owner.
#pragma once

#include <memory>
#include <optional>

#include "pipeline/types/preview.hpp"
#include "protocol/base/result.hpp"
#include "viewer/gl/scene_renderer.hpp"

namespace enamel::view {

class ReturnPicture {
 public:
  struct Style {
    int width_px = 0;
    DisplayToggles toggles;
    ProbeField field;
    float scale = 1;
  };
  /// Drawn when the model or the size is another than last time; nothing without `frame.whole`. Errors: kDisplay.
  [[nodiscard]] Result<void> update(const PreviewFrame& frame, const Style& style);
  /// The picture, or null.
  [[nodiscard]] const RenderTarget* get() const noexcept { return drawn_ ? &*out_ : nullptr; }

 private:
  std::unique_ptr<SceneRenderer> scene_;
  std::optional<RenderTarget> out_;
  std::shared_ptr<const ModelSnapshot> drawn_;
};

}  // namespace enamel::view
