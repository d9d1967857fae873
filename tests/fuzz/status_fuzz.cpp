// Any bytes where a probe's status block or GETSTATUS answer is expected: the host takes a block only when it is
// exactly what a probe would have sent, and never believes a length.
#include <algorithm>
#include <array>
#include <cstdint>

#include "host/update/dfu_client.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/image/version_text.hpp"
#include "tests/fuzz/byte_source.hpp"
#include "tests/fuzz/demand.hpp"

namespace {

using namespace enamel;
using test::demand;

/// A probe that answers everything with the same bytes, or fails.
class AnyAnswer final : public update::ProbeLink {
 public:
  AnyAnswer(std::span<const std::byte> answer, std::optional<update::LinkFault> fault)
      : answer_(answer), fault_(fault) {}
  update::Linked<void> out(const update::ControlRequest&, std::span<const std::byte>,
                           std::chrono::milliseconds) override {
    if (fault_) return tl::unexpected(*fault_);
    return {};
  }
  update::Linked<std::vector<std::byte>> in(const update::ControlRequest&, std::uint16_t length,
                                            std::chrono::milliseconds) override {
    if (fault_) return tl::unexpected(*fault_);
    const auto part = answer_.first(std::min<std::size_t>(length, answer_.size()));
    return std::vector<std::byte>(part.begin(), part.end());
  }
  update::Linked<std::vector<std::byte>> out_then_in(const update::ControlRequest&, std::span<const std::byte>,
                                                     const update::ControlRequest& second, std::uint16_t length,
                                                     std::chrono::milliseconds timeout) override {
    return in(second, length, timeout);
  }

 private:
  std::span<const std::byte> answer_;
  std::optional<update::LinkFault> fault_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  test::ByteSource in(data, size);
  const std::uint8_t faults = in.byte();
  const std::span<const std::byte> bytes = in.rest();
  const auto decoded = image::decode_status(bytes);
  if (decoded) {
    demand(bytes.size() == image::kStatusSize, "a block has one length");
    const image::StatusBytes again = image::encode(*decoded);
    demand(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()), "decoding loses nothing");
    demand(decoded->active <= 1, "there are two slots");
    for (const image::ImageVersion& v : decoded->version) {
      demand(image::parse_version(image::to_text(v)) == v, "versions have a text");
    }
    static_cast<void>(image::describe_refusal(decoded->last_error));
  }
  AnyAnswer link(bytes, faults < 5 ? std::optional(static_cast<update::LinkFault>(faults)) : std::nullopt);
  SteadyClock clock;
  update::DfuClient client(link, clock);
  const auto block = client.read_status_block();
  const auto first = bytes.first(std::min(bytes.size(), image::kStatusSize));
  demand(block.has_value() == (faults >= 5 && image::decode_status(first).has_value()), "the client believes no more");
  const auto answer = client.get_status();
  demand(answer.has_value() == (faults >= 5 && bytes.size() >= 6), "six bytes are an answer");
  demand(client.settle().has_value() == answer.has_value(), "settling ends");
  return 0;
}
