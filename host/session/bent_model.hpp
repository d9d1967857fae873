// The model as the map bends it, for the screen: blocks are moved, not fused anew.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>

#include "pipeline/register/map/map_bend.hpp"
#include "pipeline/types/preview.hpp"

namespace enamel::host {

/// Remembers what it has shown: a block is moved again only where that would be seen. One thread at a time.
class BentModel {
 public:
  void bend_by(std::shared_ptr<const pipeline::MapBend> bend) { bend_ = std::move(bend); }
  /// What is shown of a burst, with the model, the probe and the place to return to where the map has them. A segment
  /// apart stays as it is.
  [[nodiscard]] std::shared_ptr<const BurstPreview> operator()(std::shared_ptr<const BurstPreview> shown);

 private:
  struct Bent {
    std::shared_ptr<const BlockMesh> source, shown;
    Vec3f shift = Vec3f::Zero();  ///< of one of its vertices, as shown; mm
  };
  [[nodiscard]] std::shared_ptr<const ModelSnapshot> bent(const std::shared_ptr<const ModelSnapshot>& model);

  std::shared_ptr<const pipeline::MapBend> bend_;
  std::map<std::array<std::int32_t, 3>, Bent> blocks_;
};

}  // namespace enamel::host
