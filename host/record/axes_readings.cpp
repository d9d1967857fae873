#include "host/record/axes_readings.hpp"

#include "host/record/axes_gather.hpp"
#include "host/record/exchange_names.hpp"
#include "protocol/types/axes_table.hpp"

namespace enamel::host {

Result<std::vector<proto::AxesReading>> axes_of(BurstStream& stream) {
  AxesGather gather(stream);
  stream.rewind();
  for (;;) {
    const auto record = stream.next();
    if (!record) {
      if (record.error().code == ErrorCode::kFileRead) return tl::unexpected<Error>(record.error());
      continue;
    }
    if (!*record) break;
    gather.take(**record);
  }
  stream.rewind();
  if (auto wrong = gather.contradiction()) return tl::unexpected<Error>(std::move(*wrong));
  if (auto wrong = gather.missing()) return tl::unexpected<Error>(std::move(*wrong));
  return gather.readings();
}

std::uint64_t count_axes(BurstStream& stream) {
  if (stream.info().axes > 0) return stream.info().axes;
  const auto bytes = stream.attachment(kAxesFile);
  if (!bytes) return 0;
  const auto rows = proto::parse_burst_axes(std::string(bytes->begin(), bytes->end()), kAxesFile);
  return rows ? rows->size() : 0;
}

}  // namespace enamel::host
