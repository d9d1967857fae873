// decode_folder FOLDER OUT BURST…: decodes bursts of an exchange folder and writes the maps of each to OUT/BURST.
// A tool of the tests: reads PNG frames directly so that decoding can be scored without any other part of the system.
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "calib/model/pattern.hpp"
#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/decode/decode_maps.hpp"
#include "tests/unit/decode/folder_burst.hpp"

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: %s FOLDER OUT BURST...\n", argv[0]);
    return 1;
  }
  const std::string folder = argv[1], out = argv[2];
  const auto rig = enamel::calib::load_rig(folder + "/rig.json");
  if (!rig) {
    std::fprintf(stderr, "%s\n", rig.error().message().c_str());
    return enamel::exit_code(rig.error().code);
  }
  const auto decoder = enamel::pipeline::BurstDecoder::make(*rig);
  if (!decoder) {
    std::fprintf(stderr, "%s\n", decoder.error().message().c_str());
    return enamel::exit_code(decoder.error().code);
  }
  for (int k = 3; k < argc; ++k) {
    const int id = std::atoi(argv[k]);
    const auto frames = enamel::test::load_folder_burst(folder, id);
    if (!frames) {
      std::fprintf(stderr, "burst %d: frames missing\n", id);
      return 2;
    }
    const auto decoded = decoder->decode(frames->view());
    const enamel::pipeline::DecodeReport report{static_cast<std::uint64_t>(id),
                                                enamel::calib::mode_name(rig->patterns),
                                                decoder->figures(decoded.diagnostics),
                                                {}};
    const auto written = enamel::pipeline::write_decode_maps(decoded, report, out + "/" + std::to_string(id));
    if (!written) {
      std::fprintf(stderr, "%s\n", written.error().message().c_str());
      return enamel::exit_code(written.error().code);
    }
    std::printf("%s", enamel::pipeline::decode_json(decoded, report).c_str());
  }
  return 0;
}
