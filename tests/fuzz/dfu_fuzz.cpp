// Any sequence of setup packets with any data, restarts, power cuts and lost boot blocks in between: the probe boots at
// every moment, writes nothing that it must not (fuzz_probe.hpp), and afterwards takes a good image.
#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware/boot/transitions.hpp"
#include "tests/fuzz/demand.hpp"
#include "tests/fuzz/fuzz_images.hpp"
#include "tests/fuzz/fuzz_probe.hpp"

namespace {

using namespace enamel;
using namespace enamel::fw;
using image::DfuRequest;
using test::Bytes;
using test::demand;
using test::FuzzProbe;

constexpr std::uint8_t kOut = image::request_type::kClassOut, kIn = image::request_type::kClassIn;

struct World {
  test::KeyRing keys;
  image::Signer stranger = test::make_signer(99);
  std::array<Bytes, 6> images = {
      test::as_sent(test::make_image({2, 0, 0, 0}, 5, image::kChunkSize + 10, {&keys.signer(0), 1})),
      test::as_sent(test::make_image({3, 0, 0, 0}, 6, 300, {&keys.signer(1), 1})),
      test::as_sent(test::make_image({0, 5, 0, 0}, 5, 300, {&keys.signer(0), 1})),
      test::as_sent(test::make_image({2, 0, 0, 0}, 1, 300, {&keys.signer(0), 1})),
      test::as_sent(test::make_image({4, 0, 0, 0}, 6, 300, {&stranger, 1})),
      test::as_sent(test::make_image({5, 0, 0, 0}, 6, 300, {})),
  };
  Bytes last = test::as_sent(test::make_image({9, 0, 0, 0}, 9, 500, {&keys.signer(0), 1}));
  FlashModel factory{flash_map::kSize};
  std::set<Sha256Digest> trusted;

  World() {
    const Bytes first = test::as_sent(test::make_image({1, 0, 0, 0}, 5, 400, {&keys.signer(0), 1}));
    const auto receiver = std::make_unique<ImageReceiver>(
        boot_regions(factory), UpdateIdentity{test::test_hardware(), keys.trust(), 1, std::nullopt});
    receiver->restart(false);
    ControlStore store(boot_regions(factory).control);
    const bool installed = receiver->take(first).has_value() && receiver->finish().has_value() &&
                           store.store_twice(confirm(*store.load(), 0));
    demand(installed, "the factory's firmware is accepted");
    for (const Bytes* good : {&images[0], &images[1], &images[2], &images[3], &last}) {
      trusted.insert(sha256(image::parse_manifest(*good)->bytes));
    }
  }
};

const World& world() {
  static const World instance;
  return instance;
}

SetupPacket setup_of(std::uint8_t type, DfuRequest request, std::uint16_t value, std::size_t length) {
  return {type, static_cast<std::uint8_t>(request), value, 0, static_cast<std::uint16_t>(length)};
}

/// A host that mostly does what hosts do, as far as the input lets it.
class Host {
 public:
  Host(FuzzProbe& probe, test::ByteSource& in) : probe_(&probe), in_(&in) {}

  void step() {
    switch (in_->byte() % 16) {
      case 0:
        image_ = &world().images[in_->below(world().images.size())];
        at_ = 0;
        break;
      case 1:
      case 2:
        return send(1 + in_->below(24), in_->one_in(8));
      case 3:
        return anything();
      case 4:
        return vendor();
      case 5:
        return ask_status();
      case 6:
        return simple();
      case 7:
        return probe_->device().bus_reset();
      case 8:
        return restart(in_->one_in(4));
      case 9:
        return probe_->cut(in_->below(300), in_->below(513), in_->byte());
      case 10:
        static_cast<void>(probe_->device().confirm_running(in_->one_in(2)));
        static_cast<void>(probe_->device().raise_counter_now());
        break;
      case 11:
        probe_->is_scanning = in_->one_in(2);
        probe_->has_power = in_->one_in(2);
        probe_->healthy = in_->one_in(2);
        break;
      case 12:
        probe_->lose_control(in_->below(2), in_->byte());
        return restart(false);
      case 13:
        return probe_->device().detach_timed_out();
      default:
        return whole_download(*image_);
    }
  }

  /// The rest of a host's way: out of whatever state, a good image, a restart; the probe runs it.
  void succeed_at_last() {
    probe_->is_scanning = false;
    probe_->has_power = probe_->healthy = true;
    restart(in_->one_in(4));
    // What runs on trial confirms itself first.
    static_cast<void>(probe_->device().confirm_running(false));
    if (probe_->recovery()) {
      demand(!control(setup_of(kOut, DfuRequest::kDetach, 1000, 0), {}).stall, "recovery detaches");
      probe_->device().bus_reset();
    }
    demand(probe_->device().position().state == DfuState::kIdle, "the probe rests in dfuIDLE");
    whole_download(world().last);
    demand(probe_->device().position().state == DfuState::kIdle, "a good image is accepted");
    restart(false);
    demand(probe_->block().slot[*probe_->running()].version.major == 9, "the new image runs");
  }

 private:
  ControlReply control(const SetupPacket& setup, std::span<const std::byte> data) {
    return probe_->control(setup, data);
  }

  void restart(bool recovery) {
    probe_->boot(recovery);
    at_ = 0;
  }

  void ask_status() {
    static_cast<void>(control(setup_of(kIn, DfuRequest::kGetStatus, 0, 6), {}));
    probe_->device().work();
  }

  /// The next blocks of the image; `damaged`: one byte wrong.
  void send(std::size_t blocks, bool damaged) {
    for (; blocks > 0 && at_ < image_->size(); --blocks) {
      const std::size_t n = std::min<std::size_t>(image::kDfuTransferSize, image_->size() - at_);
      Bytes block(image_->begin() + static_cast<std::ptrdiff_t>(at_),
                  image_->begin() + static_cast<std::ptrdiff_t>(at_ + n));
      if (damaged) block[in_->below(n)] ^= static_cast<std::byte>(1U + in_->byte() % 255U);
      const auto number = static_cast<std::uint16_t>(at_ / image::kDfuTransferSize);
      static_cast<void>(control(setup_of(kOut, DfuRequest::kDownload, number, n), block));
      ask_status();
      at_ += n;
    }
  }

  void whole_download(const Bytes& image) {
    image_ = &image;
    at_ = 0;
    send(image.size(), false);
    static_cast<void>(control(setup_of(kOut, DfuRequest::kDownload, 0, 0), {}));
    ask_status();
    while (probe_->device().work_pending()) ask_status();
    ask_status();
  }

  /// Requests without data, in or out of order.
  void simple() {
    const std::array<SetupPacket, 5> kinds = {
        setup_of(kOut, DfuRequest::kClearStatus, 0, 0), setup_of(kOut, DfuRequest::kAbort, 0, 0),
        setup_of(kOut, DfuRequest::kDownload, in_->byte(), 0), setup_of(kIn, DfuRequest::kUpload, 0, in_->byte()),
        setup_of(kOut, DfuRequest::kDetach, in_->byte(), 0)};
    static_cast<void>(control(kinds[in_->below(kinds.size())], {}));
  }

  void anything() {
    SetupPacket setup{in_->byte(), in_->byte(), in_->number<std::uint16_t>(), in_->byte(), 0};
    setup.length = static_cast<std::uint16_t>(in_->one_in(4) ? in_->number<std::uint16_t>() : in_->byte());
    Bytes data((setup.request_type & 0x80U) != 0 || in_->one_in(8) ? 0 : setup.length);
    for (std::byte& b : data) b = static_cast<std::byte>(in_->byte());
    static_cast<void>(control(setup, data));
  }

  void vendor() {
    const std::uint8_t request = in_->byte() % 8;
    const bool status = request == 7, reset = request == static_cast<int>(image::VendorRequest::kFactoryReset);
    image::Serial serial = FuzzProbe::kSerial;
    if (in_->one_in(4)) serial[in_->below(serial.size())] ^= in_->byte();
    const auto data = std::as_bytes(std::span(serial)).first(reset ? serial.size() : 0);
    SetupPacket setup{image::request_type::kVendorOut, request, in_->byte(), 0,
                      static_cast<std::uint16_t>(data.size())};
    if (status) {
      setup = {image::request_type::kVendorIn, static_cast<std::uint8_t>(image::VendorRequest::kStatus), 0, 0, 4096};
    }
    const ControlReply reply = control(setup, data);
    demand(!status || image::decode_status(reply.data).has_value(), "a status block can be read");
  }

  FuzzProbe* probe_;
  test::ByteSource* in_;
  const Bytes* image_ = world().images.data();
  std::size_t at_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  test::ByteSource in(data, size);
  FuzzProbe probe(world().factory, world().keys, world().trusted);
  Host host(probe, in);
  for (int steps = 0; steps < 24 && !in.empty(); ++steps) {
    host.step();
    probe.demand_bootable();
  }
  host.succeed_at_last();
  return 0;
}
