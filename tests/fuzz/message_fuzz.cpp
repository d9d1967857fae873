// Any bytes as a message off the wire (the first byte chooses the type): what is let in is written back to the same
// value, and a burst that is called consistent has its frames inside its payload.
#include <cstdint>

#include "protocol/types/burst.hpp"
#include "protocol/types/cdr.hpp"
#include "protocol/types/device.hpp"
#include "tests/fuzz/demand.hpp"

namespace {

using namespace enamel;
using test::demand;

template <class T>
void demand_round_trip(proto::ByteView bytes) {
  const auto value = proto::from_cdr<T>(bytes);
  if (!value) return;
  const auto again = proto::to_cdr(*value);
  if (!again) return;  // beyond a bound that only the writer keeps
  const auto back = proto::from_cdr<T>(*again);
  demand(back.has_value(), "what is written is read");
  const auto twice = proto::to_cdr(*back);
  demand(twice && *twice == *again, "and stays as it is");
  if constexpr (std::is_same_v<T, proto::Burst>) {
    if (!proto::is_consistent(*value)) return;
    for (int k = 0; k < proto::kFramesPerBurst; ++k) {
      const auto frame = proto::frame_bytes(*value, k);
      demand(frame.size() <= value->payload.size(), "a frame is a part of the payload");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const proto::ByteView bytes(data + 1, size - 1);
  switch (data[0] % 9) {
    case 0:
      demand_round_trip<proto::Burst>(bytes);
      break;
    case 1:
      demand_round_trip<proto::ShedNote>(bytes);
      break;
    case 2:
      demand_round_trip<proto::Status>(bytes);
      break;
    case 3:
      demand_round_trip<proto::Event>(bytes);
      break;
    case 4:
      demand_round_trip<proto::DeviceInfo>(bytes);
      break;
    case 5:
      demand_round_trip<proto::Command>(bytes);
      break;
    case 6:
      demand_round_trip<proto::CommandReply>(bytes);
      break;
    case 7:
      demand_round_trip<proto::TimeSyncReq>(bytes);
      break;
    default:
      demand_round_trip<proto::TimeSyncRep>(bytes);
      break;
  }
  return 0;
}
