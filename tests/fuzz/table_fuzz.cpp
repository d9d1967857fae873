// Any bytes as a table (the first byte chooses poses, bursts, stages or angles): rewritten once, it stays as it is;
// what is let in holds; no more rows come out than lines went in.
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "host/mesh_files/poses_csv.hpp"
#include "host/record/exchange_folder.hpp"
#include "host/report/stage_trace.hpp"
#include "protocol/base/plain_text.hpp"
#include "protocol/types/axes_table.hpp"
#include "protocol/types/cdr.hpp"
#include "tests/fuzz/demand.hpp"

namespace {

using namespace enamel;
using test::demand;

void demand_poses(std::string_view bytes) {
  const auto rows = host::parse_poses_csv(bytes);
  if (!rows) return;
  demand(rows->size() <= bytes.size(), "a row is a line");
  for (const host::PoseRow& row : *rows) {
    demand(row.T_model_cam.matrix().allFinite(), "poses are finite");
    demand(std::abs(row.T_model_cam.linear().determinant() - 1) < 1e-9, "a rotation is one");
  }
  const auto back = host::parse_poses_csv(host::poses_csv_text(*rows));
  demand(back && back->size() == rows->size(), "what is written is read");
}

void demand_bursts(const std::string& bytes) {
  const auto rows = host::parse_bursts_csv(bytes, "bursts.csv");
  if (!rows) return;
  for (std::size_t i = 0; i < rows->size(); ++i) {
    const host::ExchangeRow& row = (*rows)[i];
    demand(i == 0 || row.burst_id > (*rows)[i - 1].burst_id, "ids ascend");
    for (std::size_t k = 1; k < 4; ++k) demand(row.t_ns[k] > row.t_ns[k - 1], "times ascend");
    demand(std::isfinite(row.temp_c), "temperatures are finite");
  }
}

void demand_stages(const std::string& bytes) {
  const auto trace = host::StageTrace::from_csv(bytes, "stages.csv");
  if (!trace) return;
  demand(trace->rows().size() <= bytes.size(), "a row is a line");
}

void demand_axes(const std::string& bytes) {
  const auto readings = proto::parse_burst_axes(bytes, "axes.csv");
  if (!readings) return;
  demand(readings->size() <= bytes.size(), "a row is a line");
  for (const proto::AxesReading& reading : *readings) {
    demand(reading.is_whole(), "both axes stand somewhere");
    demand(proto::to_cdr(reading).has_value(), "a row is a message");
  }
  const auto back = proto::parse_burst_axes(proto::axes_table_text(*readings), "again");
  demand(back && *back == *readings, "what is written is read");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const std::string plain = plain_table(bytes);
  demand(plain.size() <= bytes.size() + 1, "rewriting adds the last line's end at most");
  switch (data[0] % 4) {
    case 0:
      demand_poses(bytes);
      break;
    case 1:
      demand_bursts(bytes);
      break;
    case 2:
      demand_stages(bytes);
      break;
    default:
      demand_axes(bytes);
  }
  return 0;
}
