// Every row of the DFU 1.1 state table, written down a second time as text, against the code.
#include "firmware/update/dfu_table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace enamel::fw {
namespace {

// What happens: the state that follows, "!" when the request stalls. "a/b": a while the condition named in the header
// of the column holds (busy, not complete, full block), b otherwise.
constexpr const char* kRows = R"(
 state DETACH  DNLOAD  END     UPLOAD  STATUS  CLEAR   STATE   ABORT
 0     1       0!      0!      0!      0       0!      0       0!
 1     0!      0!      0!      0!      1       0!      1       0!
 2     10!     3       10!     9/2     2       10!     2       2
 3     10!     10!     10!     10!     4/5     10!     3       10!
 4     10!     10!     10!     10!     4       10!     10!     10!
 5     10!     3       10!/6   10!     5       10!     5       2
 6     10!     10!     10!     10!     7/2     10!     6       10!
 7     10!     10!     10!     10!     7       10!     10!     10!
 8     8!      8!      8!      8!      8!      8!      8!      8!
 9     10!     10!     10!     9/2     9       10!     9       2
 10    10!     10!     10!     10!     10      2       10      10!
)";

const std::array<SetupPacket, 8> kRequests = {{{0x21, 0, 1000, 0, 0},
                                               {0x21, 1, 0, 0, 4096},
                                               {0x21, 1, 7, 0, 0},
                                               {0xA1, 2, 0, 0, 4096},
                                               {0xA1, 3, 0, 0, 6},
                                               {0x21, 4, 0, 0, 0},
                                               {0xA1, 5, 0, 0, 1},
                                               {0x21, 6, 0, 0, 0}}};

struct Expected {
  int state = 0;
  bool stall = false;
};

Expected parse(const std::string& cell, bool first) {
  const std::size_t slash = cell.find('/');
  const std::string text = slash == std::string::npos ? cell : first ? cell.substr(0, slash) : cell.substr(slash + 1);
  return {std::stoi(text), text.back() == '!'};
}

std::vector<std::vector<std::string>> rows() {
  std::vector<std::vector<std::string>> out;
  std::istringstream text(kRows);
  for (std::string line; std::getline(text, line);) {
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; cells >> cell;) row.push_back(cell);
    if (!row.empty() && row[0] != "state") out.push_back(row);
  }
  return out;
}

TEST(DfuTable, every_row_is_the_standards) {
  ASSERT_EQ(rows().size(), image::kDfuStates);
  const DfuConfig config;
  for (const std::vector<std::string>& row : rows()) {
    const DfuPosition at{static_cast<DfuState>(std::stoi(row[0])), DfuStatus::kOk};
    for (std::size_t column = 0; column < kRequests.size(); ++column) {
      for (const bool first : {true, false}) {
        const DfuConditions now{.busy = first, .complete = !first, .short_block = !first};
        const DfuStep step = on_request(at, config, kRequests[column], now);
        const Expected expected = parse(row[column + 1], first);
        EXPECT_EQ(static_cast<int>(step.next.state), expected.state) << "state " << row[0] << ", column " << column;
        EXPECT_EQ(step.action == DfuAction::kStall, expected.stall) << "state " << row[0] << ", column " << column;
      }
    }
  }
}

TEST(DfuTable, conditions_of_the_interface) {
  const DfuConditions now;
  DfuConfig config;
  config.can_download = false;
  config.can_upload = false;
  EXPECT_EQ(on_request({}, config, kRequests[1], now).next.state, DfuState::kError);
  EXPECT_EQ(on_request({}, config, kRequests[3], now).next.state, DfuState::kError);
  config.manifestation_tolerant = false;
  EXPECT_EQ(on_poll_timeout({DfuState::kManifest, DfuStatus::kOk}, config).state, DfuState::kManifestWaitReset);
  EXPECT_EQ(on_poll_timeout({DfuState::kManifest, DfuStatus::kOk}, {}).state, DfuState::kManifestSync);
  EXPECT_EQ(on_poll_timeout({DfuState::kDownloadBusy, DfuStatus::kOk}, {}).state, DfuState::kDownloadSync);
  EXPECT_EQ(on_poll_timeout({DfuState::kUploadIdle, DfuStatus::kOk}, {}).state, DfuState::kUploadIdle);
}

TEST(DfuTable, incomplete_image_is_called_so) {
  const DfuStep step = on_request({DfuState::kDownloadIdle, DfuStatus::kOk}, {}, kRequests[2], {});
  EXPECT_EQ(step.next, (DfuPosition{DfuState::kError, DfuStatus::kErrNotDone}));
}

TEST(DfuTable, an_error_stays_readable_until_cleared) {
  const DfuPosition at = on_failure(DfuStatus::kErrVerify);
  EXPECT_EQ(on_request(at, {}, kRequests[4], {}).next, at);
  EXPECT_EQ(on_request(at, {}, kRequests[1], {}).next, at);
  EXPECT_EQ(on_request(at, {}, kRequests[5], {}).next, DfuPosition{});
}

TEST(DfuTable, run_time_mode_detaches_and_returns) {
  DfuConfig config;
  config.runtime = true;
  const DfuPosition detached = on_request({DfuState::kAppIdle, DfuStatus::kOk}, config, kRequests[0], {}).next;
  EXPECT_EQ(detached.state, DfuState::kAppDetach);
  EXPECT_EQ(on_bus_reset(detached, config, true).state, DfuState::kIdle);
  EXPECT_EQ(on_detach_timeout(detached).state, DfuState::kAppIdle);
  EXPECT_EQ(on_bus_reset({DfuState::kIdle, DfuStatus::kOk}, config, true).state, DfuState::kAppIdle);
  EXPECT_EQ(on_bus_reset({DfuState::kIdle, DfuStatus::kOk}, config, false),
            (DfuPosition{DfuState::kError, DfuStatus::kErrFirmware}));
  EXPECT_EQ(on_bus_reset(detached, {}, true).state, DfuState::kIdle) << "the running firmware rests in dfuIDLE";
}

TEST(DfuTable, unknown_requests_stall_as_unexpected_ones) {
  for (const SetupPacket& setup : {SetupPacket{0x21, 77, 0, 0, 0}, SetupPacket{0xA1, 1, 0, 0, 64},
                                   SetupPacket{0x21, 3, 0, 0, 6}, SetupPacket{0x00, 9, 1, 0, 0}}) {
    const DfuStep step = on_request({DfuState::kDownloadIdle, DfuStatus::kOk}, {}, setup, {});
    EXPECT_EQ(step.action, DfuAction::kStall);
    EXPECT_EQ(step.next.state, DfuState::kError);
    EXPECT_EQ(on_request({DfuState::kAppIdle, DfuStatus::kOk}, {}, setup, {}).next.state, DfuState::kAppIdle);
  }
}

}  // namespace
}  // namespace enamel::fw
