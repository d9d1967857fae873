// Takes frames of the guest's SIMULATED camera through libcamera and the probe's own back end, and compares each byte.
// usage: camera_check FRAMES; exit code 0: all of them were what the camera sent.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "firmware/device/linux/camera/request_camera.hpp"
#include "firmware/device/linux/libcamera/libcamera_source.hpp"
#include "tests/guest/camera/frame_content.hpp"

namespace {

using namespace enamel;
using namespace enamel::fw;

int report(const Error& error) {
  std::fprintf(stderr, "%s\n", error.message().c_str());
  return 1;
}

struct Seen {
  int good = 0;
  int other = 0;
  int gaps = 0;
};

bool is_as_sent(const CameraFrame& frame) {
  const auto pixels = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  if (!frame.pixels.holds(static_cast<std::size_t>(frame.width), frame.height)) return false;
  std::vector<std::uint8_t> sent(pixels), got;
  for (int y = 0; y < frame.height; ++y) {
    const auto row = frame.pixels.row(static_cast<std::size_t>(frame.width), y);
    got.insert(got.end(), row.begin(), row.end());
  }
  guest::fill_frame(guest::counter_of(got), sent);
  return got == sent;
}

Result<Seen> take(RequestCamera& camera, int frames) {
  Seen seen;
  ENAMEL_TRY(camera.start());
  std::uint32_t last = 0;
  for (int i = 0; i < frames; ++i) {
    ENAMEL_TRY_ASSIGN(const CameraFrame frame, camera.next_frame());
    if (frame.status == FrameStatus::kError || !is_as_sent(frame)) {
      ++seen.other;
      continue;
    }
    const std::uint32_t counter = guest::counter_of(frame.pixels.bytes());
    if (seen.good > 0 && counter != last + 1) ++seen.gaps;
    last = counter;
    ++seen.good;
  }
  camera.stop();
  return seen;
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 60;
  StreamWish wish;
  wish.height = 480;
  auto source = LibcameraSource::open(wish);
  if (!source) return report(source.error());
  std::printf("stride %zu, %d buffers; without", (*source)->format().stride, (*source)->slots());
  for (const auto& name : (*source)->missing_controls()) std::printf(" %s", name.c_str());
  std::printf("\n");
  SteadyClock clock;
  RequestCameraConfig config;
  config.controls.frame_period = Nanoseconds{33'333'333};
  config.controls.exposure_us = 30'000;
  auto camera = RequestCamera::create(*source, clock, config);
  if (!camera) return report(camera.error());
  // Twice: a stream that was stopped must start again.
  for (int round = 0; round < 2; ++round) {
    const auto seen = take(**camera, frames);
    if (!seen) return report(seen.error());
    std::printf("round %d: %d frames as sent, %d others, %d gaps, %llu restarts\n", round, seen->good, seen->other,
                seen->gaps, static_cast<unsigned long long>((*camera)->counts().restarts));
    if (seen->good != frames) return 1;
  }
  return 0;
}
