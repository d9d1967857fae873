// Any bytes as a message off the wire (the first byte chooses the type): what is let in is written back to the same
// value, and a burst that is called consistent has its frames inside its payload.
#include <array>
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

constexpr std::array kTypes{demand_round_trip<proto::Burst>,        demand_round_trip<proto::ShedNote>,
                            demand_round_trip<proto::Status>,       demand_round_trip<proto::Event>,
                            demand_round_trip<proto::DeviceInfo>,   demand_round_trip<proto::Command>,
                            demand_round_trip<proto::CommandReply>, demand_round_trip<proto::TimeSyncReq>,
                            demand_round_trip<proto::TimeSyncRep>,  demand_round_trip<proto::AxesReading>};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) kTypes[data[0] % kTypes.size()](proto::ByteView(data + 1, size - 1));
  return 0;
}
