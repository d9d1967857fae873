// The map while the scan still goes on: what the bursts so far say of where their keyframes are. Nothing of it is fed
// back to tracking or to the model; it shows where the finished model will be.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "pipeline/register/map/map_bend.hpp"
#include "pipeline/register/map/refine_map.hpp"

namespace enamel::pipeline {

/// As refine_map, for the poses of the keyframes alone: no bow, no artefact. With MapInput::memo only what is new is
/// measured. `node`: of a burst by its index in input.bursts, as MapNodeMaker makes them of input.load and
/// input.texture, which are not called here. nullopt: stopped, or fewer than two keyframes.
[[nodiscard]] std::optional<std::vector<KeyframeMove>> follow_map(
    const MapInput& input, const std::function<std::shared_ptr<const MapNode>(std::size_t burst)>& node,
    const calib::Rig& rig, const IcpConfig& icp, const MapConfig& config, const std::stop_token& stop);

}  // namespace enamel::pipeline
