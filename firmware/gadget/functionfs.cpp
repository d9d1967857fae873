#include "firmware/gadget/functionfs.hpp"

#include <endian.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "firmware/gadget/descriptors.hpp"

namespace enamel::fw {
namespace {

/// A data stage lasts milliseconds; hosts give up after five seconds.
constexpr std::chrono::milliseconds kDataStage{4000};
/// From the first transfer that fails to the event that says why.
constexpr std::chrono::milliseconds kDisconnect{10};

bool write_whole(int fd, const std::vector<std::byte>& bytes) noexcept {
  return ::write(fd, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
}

/// The host gave up, a signal came, or another setup packet took this one's place: nothing to report.
bool passing(int error) noexcept {
  return error == EINTR || error == EAGAIN || error == EIDRM || error == EL2HLT || error == ESRCH;
}

std::optional<PortEventKind> kind_of(std::uint8_t type) noexcept {
  switch (type) {
    case FUNCTIONFS_BIND:
      return PortEventKind::kBind;
    case FUNCTIONFS_UNBIND:
      return PortEventKind::kUnbind;
    case FUNCTIONFS_ENABLE:
      return PortEventKind::kEnable;
    case FUNCTIONFS_DISABLE:
      return PortEventKind::kDisable;
    case FUNCTIONFS_SETUP:
      return PortEventKind::kSetup;
    case FUNCTIONFS_SUSPEND:
      return PortEventKind::kSuspend;
    case FUNCTIONFS_RESUME:
      return PortEventKind::kResume;
    default:
      return std::nullopt;
  }
}

}  // namespace

Result<std::unique_ptr<FunctionFs>> FunctionFs::open(const std::string& mount, Clock& clock, const DfuConfig& config) {
  const std::string path = mount + "/ep0";
  const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0 && errno == ENOENT) return fail(ErrorCode::kFileNotFound, path + ": no FunctionFS is mounted there");
  if (fd < 0) return fail(ErrorCode::kGadget, path + ": " + std::strerror(errno));
  std::unique_ptr<FunctionFs> port(new FunctionFs(fd, clock));
  ENAMEL_TRY(port->describe(config));
  return port;
}

FunctionFs::~FunctionFs() { ::close(ep0_); }

Result<void> FunctionFs::describe(const DfuConfig& config) {
  functional_ = write_whole(ep0_, function_descriptors(config, Functional::kWith));
  if (!functional_ && (errno != EINVAL || !write_whole(ep0_, function_descriptors(config, Functional::kWithout)))) {
    return fail(ErrorCode::kGadget, std::string("descriptors: ") + std::strerror(errno));
  }
  if (!write_whole(ep0_, function_strings())) {
    return fail(ErrorCode::kGadget, std::string("strings: ") + std::strerror(errno));
  }
  return {};
}

Result<std::optional<PortEvent>> FunctionFs::next(std::chrono::milliseconds deadline) {
  if (unsettled_) settle();
  pollfd waiting{ep0_, POLLIN, 0};
  if (::poll(&waiting, 1, static_cast<int>(deadline.count())) <= 0) return std::nullopt;
  // One event a read: a setup packet must be answered before the next event is taken.
  usb_functionfs_event event{};
  const ssize_t n = ::read(ep0_, &event, sizeof event);
  if (n < 0 && passing(errno)) return std::nullopt;
  if (n != static_cast<ssize_t>(sizeof event)) {
    return fail(ErrorCode::kGadget, std::string("events: ") + (n < 0 ? std::strerror(errno) : "cut short"));
  }
  const std::optional<PortEventKind> kind = kind_of(event.type);
  if (!kind) return std::nullopt;
  PortEvent out;
  out.kind = *kind;
  if (*kind == PortEventKind::kSetup) {
    const usb_ctrlrequest& s = event.u.setup;
    out.setup = {s.bRequestType, s.bRequest, le16toh(s.wValue), le16toh(s.wIndex), le16toh(s.wLength)};
    setup_ = out.setup;
  }
  return std::optional(out);
}

std::size_t FunctionFs::receive(std::span<std::byte> data) {
  timer_.arm(kDataStage);
  const ssize_t n = answered(::read(ep0_, data.data(), data.size()), data.size());
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

bool FunctionFs::send(std::span<const std::byte> data) {
  timer_.arm(kDataStage);
  return answered(::write(ep0_, data.data(), data.size()), data.size()) == static_cast<ssize_t>(data.size());
}

bool FunctionFs::acknowledge() {
  std::byte nothing{};
  timer_.arm(kDataStage);
  return answered(::read(ep0_, &nothing, 0), 0) == 0;
}

ssize_t FunctionFs::answered(ssize_t n, std::size_t wanted) noexcept {
  timer_.disarm();
  unsettled_ = n != static_cast<ssize_t>(wanted);
  return n;
}

void FunctionFs::settle() noexcept {
  // A data stage that the kernel could not begin (ESHUTDOWN while the cable goes) or that a signal broke off leaves its
  // setup packet pending, and the next read would be that data stage again: bytes of the host taken for an event. A
  // stall ends it; where the function was disabled meanwhile, the kernel has ended it and refuses the stall.
  clock_.sleep_for(kDisconnect);
  stall(setup_);
  unsettled_ = false;
}

void FunctionFs::stall(const SetupPacket& setup) {
  // FunctionFS stalls a transfer that is answered in the wrong direction; both calls then fail with EL2HLT.
  std::byte nothing{};
  const bool in = (setup.request_type & 0x80U) != 0;
  static_cast<void>((in ? ::read(ep0_, &nothing, 0) : ::write(ep0_, &nothing, 0)) < 0);
}

}  // namespace enamel::fw
