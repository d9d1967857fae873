// Any bytes as the model that a crash left (the first byte chooses whether they get the format's first line and the
// sum that belongs to them): what is let in holds, and is written as the same bytes.
#include <cstdint>
#include <span>
#include <string>

#include "host/session/model_checkpoint.hpp"
#include "protocol/base/crc32.hpp"
#include "tests/fuzz/demand.hpp"

using namespace enamel;
using test::demand;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 2 == 1) {
    bytes.insert(0, host::kCheckpointMagic);
    const std::uint32_t sum = crc32(std::as_bytes(std::span(bytes)));
    bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  }
  const auto checkpoint = host::parse_checkpoint(bytes);
  if (!checkpoint) return 0;
  for (const auto& block : checkpoint->model->blocks) {
    demand(block->normals.size() == block->vertices.size(), "a normal a vertex");
    demand(block->quality.size() == block->vertices.size(), "a quality a vertex");
    for (const auto& corners : block->triangles)
      for (const std::uint32_t corner : corners) demand(corner < block->vertices.size(), "corners are vertices");
  }
  demand(host::checkpoint_bytes(*checkpoint) == bytes, "what is read is written as it was");
  return 0;
}
