#include <array>
#include <cstring>
#include <numbers>
#include <opencv2/core.hpp>
#include <utility>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/stages/burst_view.hpp"
#include "tests/bench/speed/peers.hpp"

namespace enamel::bench {

Result<std::vector<PlacedPatch>> placed_patches(const Recording& recording, const std::vector<host::PlacedPose>& poses,
                                                std::size_t most) {
  ENAMEL_TRY_ASSIGN(const auto decoder, pipeline::BurstDecoder::make(recording.rig));
  std::vector<PlacedPatch> out;
  pipeline::DecodeWorkspace workspace;
  for (std::size_t i = poses.size() / 2; i < poses.size() && out.size() < most; ++i) {
    for (const host::Accepted& burst : recording.bursts) {
      if (burst.id != poses[i].id) continue;
      pipeline::DecodedBurst decoded;
      decoder.decode(stage::view_of(*burst.burst), workspace, decoded);
      if (decoded.accepted()) out.push_back({std::move(decoded.patch), poses[i].T_model_cam});
    }
  }
  return out;
}

PeerCost phase_by_opencv(const proto::Burst& burst, int repeats) {
  std::array<cv::Mat, 4> frames;
  for (int k = 0; k < 4; ++k) {
    const auto bytes = proto::frame_bytes(burst, k);
    // OpenCV takes no const memory; the frames are only read.
    frames[static_cast<std::size_t>(k)] =
        cv::Mat(burst.height, burst.width, CV_8U, const_cast<std::uint8_t*>(bytes.data()));
  }
  cv::Mat cosine, sine, modulation, phase;
  return least_of(repeats, 1, [&] {
    cv::subtract(frames[0], frames[2], cosine, cv::noArray(), CV_32F);
    cv::subtract(frames[3], frames[1], sine, cv::noArray(), CV_32F);
    cv::cartToPolar(cosine, sine, modulation, phase);
  });
}

PeerCost copy_maps(const proto::Burst& burst, int repeats) {
  const std::size_t bytes = std::size_t{12} * burst.width * burst.height;
  std::vector<std::uint8_t> from(bytes, 1), to(bytes);
  return least_of(repeats, 1, [&] {
    std::memcpy(to.data(), from.data(), bytes);
    from[0] = static_cast<std::uint8_t>(to[bytes - 1] + 1);  // the next copy is not the same one
  });
}

}  // namespace enamel::bench
