// A recording that something happened to: bits flipped, parts overwritten, taken out, put in twice, cut off, or any
// bytes at all. It opens or is refused; reading ends; no record comes out that was not written; what is missing is
// counted as far as the file still tells how much there was.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/capture/capture.hpp"
#include "tests/fuzz/byte_source.hpp"
#include "tests/fuzz/demand.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace {

using namespace enamel;
using test::demand;

constexpr std::uint64_t kBursts = 4;

/// A file without a name.
class MemoryFile {
 public:
  MemoryFile() : fd_(::memfd_create("recording", MFD_CLOEXEC)) { demand(fd_ >= 0, "there is a file in memory"); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(fd_); }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }
  void put(const std::vector<std::uint8_t>& bytes) const {
    demand(::pwrite(fd_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()), "it can be written");
    demand(::ftruncate(fd_, static_cast<off_t>(bytes.size())) == 0, "it can be cut");
  }
  [[nodiscard]] std::vector<std::uint8_t> take() const {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(::lseek(fd_, 0, SEEK_END)));
    demand(::pread(fd_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()), "it can be read");
    return bytes;
  }

 private:
  int fd_;
};

struct Original {
  std::vector<std::uint8_t> bytes;
  std::vector<capture::Record> records;
};

Original make(bool compress) {
  const MemoryFile file;
  const capture::CaptureHeader header{"{\"format\": \"rig/1\"}\n", "fuzz", {{"seed", "1"}}};
  auto out = capture::CaptureWriter::create(file.path(), header, {.compress = compress});
  demand(out.has_value(), "a recording can be made");
  Original original;
  test::Random random(7);
  std::int64_t t = 1000;
  for (std::uint64_t i = 0; i < kBursts; ++i) {
    proto::Status status;
    test::randomize(random, status);
    demand(out->write_status(status, ++t).has_value(), "a status is written");
    original.records.push_back({t, status});
    proto::AxesReading reading;
    test::randomize(random, reading);
    if (i > 0) {
      demand(out->write_axes(reading, ++t).has_value(), "a reading is written");
      original.records.push_back({t, reading});
    }
    const proto::Burst burst = test::camera_burst(i, 8, 6);
    demand(out->write_burst(burst, ++t).has_value(), "a burst is written");
    original.records.push_back({t, burst});
  }
  demand(out->attach("notes.txt", "text/plain", proto::Bytes(40, 'n')).has_value(), "a file is attached");
  demand(out->finish().has_value(), "it is finished");
  original.bytes = file.take();
  return original;
}

/// Returns whether the file was changed in no more than one bit.
bool edit(test::ByteSource& in, std::vector<std::uint8_t>& bytes) {
  const std::size_t edits = 1 + in.below(4);
  bool one_bit = edits == 1;
  for (std::size_t i = 0; i < edits && !bytes.empty(); ++i) {
    const std::size_t at = in.below(bytes.size());
    const std::size_t length = std::min(in.below(300) + 1, bytes.size() - at);
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    const std::size_t kind = in.below(6);
    one_bit = one_bit && kind == 0;
    if (kind == 0) *begin = static_cast<std::uint8_t>(*begin ^ (1U << in.below(8)));
    if (kind == 1) std::generate(begin, end, [&] { return in.byte(); });
    if (kind == 2) std::fill(begin, end, std::uint8_t{0});
    if (kind == 3) bytes.erase(begin, end);
    if (kind == 4) {
      const std::vector<std::uint8_t> again(begin, end);
      bytes.insert(begin, again.begin(), again.end());
    }
    if (kind == 5) bytes.erase(begin, bytes.end());
  }
  return one_bit;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::array<Original, 2> kOriginals{make(false), make(true)};
  static const MemoryFile kFile;
  test::ByteSource in(data, size);
  const Original& original = kOriginals[in.below(2)];
  std::vector<std::uint8_t> bytes = original.bytes;
  bool one_bit = false;
  const bool any_bytes = in.one_in(8);
  if (any_bytes) {
    const auto rest = in.rest();
    bytes.resize(rest.size());
    std::transform(rest.begin(), rest.end(), bytes.begin(),
                   [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
  } else {
    one_bit = edit(in, bytes);
  }
  kFile.put(bytes);
  auto reader = capture::CaptureReader::open(kFile.path());
  demand(reader || !one_bit, "one wrong bit hides no recording");
  if (!reader) return 0;
  std::uint64_t bursts = 0;
  for (std::size_t steps = 0;; ++steps) {
    demand(steps <= bytes.size(), "reading ends");
    const auto record = reader->next();
    if (!record) continue;
    if (!*record) break;
    if (std::holds_alternative<proto::Burst>((*record)->value)) ++bursts;
    if (any_bytes) continue;
    demand(std::find(original.records.begin(), original.records.end(), **record) != original.records.end(),
           "nothing comes out that was not written");
  }
  if (one_bit) {
    demand(bursts + reader->bursts_lost() == kBursts, "what is missing is counted");
    demand(bursts + 1 >= kBursts, "one wrong bit costs one chunk");
  }
  static_cast<void>(reader->attachment("notes.txt"));
  static_cast<void>(reader->burst(0));
  return 0;
}
