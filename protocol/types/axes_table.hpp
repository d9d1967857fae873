// The table axes.csv: angles of the desktop scanner's axes by burst (exchange folders) or by pose (calibration
// folders). Pure functions, thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/types/axes.hpp"

namespace enamel::proto {

enum class AxesKey : std::uint8_t { kBurst /* burst_id */, kPose /* pose */ };

struct AxesRow {
  std::string key;                     ///< as written; a whole number for kBurst
  std::array<double, 4> angles_deg{};  ///< rot_cmd, swing_cmd, rot_read, swing_read; NaN: none
  int line = 0;                        ///< 1-based
};

/// Rows in file order, keys unique; an empty field or `nan` is no angle. A table that a spreadsheet saved will do
/// (protocol/base/plain_text.hpp). Errors: kExchangeInvalid or kCalibrationFolder by the key, with file, line, field
/// and what is wrong: another header, another number of fields, no number, an angle beyond kMaxAxisAngle_deg, an axis
/// with neither a command nor a reading, a key that stands twice, an empty table.
[[nodiscard]] Result<std::vector<AxesRow>> parse_axes_table(std::string_view text, const std::string& path,
                                                            AxesKey key);

/// The same by burst; probe, session and stop stay 0, which the table does not tell. Errors: as above.
[[nodiscard]] Result<std::vector<AxesReading>> parse_burst_axes(std::string_view text, const std::string& path);

/// Numbers the stops of readings in the order of their bursts, from 0: another one wherever the commanded angle of an
/// axis (read, where none was commanded) is not within 0.01 degrees of that of the reading in front.
void number_stops(std::vector<AxesReading>& readings);

/// The table by burst, in the order given; digits that read back to the same numbers.
[[nodiscard]] std::string axes_table_text(const std::vector<AxesReading>& readings);

}  // namespace enamel::proto
