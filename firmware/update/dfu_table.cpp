#include "firmware/update/dfu_table.hpp"

#include <array>
#include <optional>

namespace enamel::fw {
namespace {

using enum DfuState;
using Action = DfuAction;

/// Columns of the table: the seven requests, DNLOAD split by its length.
enum class Column : std::uint8_t {
  kDetach,
  kDownload,
  kDownloadEnd,
  kUpload,
  kGetStatus,
  kClearStatus,
  kGetState,
  kAbort,
};
constexpr std::size_t kColumns = 8;

constexpr DfuStep go(DfuState next, Action action) noexcept { return {{next, DfuStatus::kOk}, action}; }
constexpr DfuStep stall(DfuState next) noexcept { return go(next, Action::kStall); }
constexpr DfuStep kUnexpected = {{kError, DfuStatus::kErrStalledPacket}, Action::kStall};

using Row = std::array<DfuStep, kColumns>;

/// Table A.1 of the standard with what does not depend on conditions; `refine` does the rest. GETSTATUS in dfuDNBUSY
/// and dfuMANIFEST is answered where the standard stalls, because hosts poll there.
constexpr std::array<Row, image::kDfuStates> kTable = {{
    // DETACH, DNLOAD, DNLOAD of length 0, UPLOAD, GETSTATUS, CLRSTATUS, GETSTATE, ABORT
    {go(kAppDetach, Action::kDetach), stall(kAppIdle), stall(kAppIdle), stall(kAppIdle),
     go(kAppIdle, Action::kReplyStatus), stall(kAppIdle), go(kAppIdle, Action::kReplyState), stall(kAppIdle)},
    {stall(kAppIdle), stall(kAppIdle), stall(kAppIdle), stall(kAppIdle), go(kAppDetach, Action::kReplyStatus),
     stall(kAppIdle), go(kAppDetach, Action::kReplyState), stall(kAppIdle)},
    {kUnexpected, go(kDownloadSync, Action::kTakeBlock), kUnexpected, go(kUploadIdle, Action::kSendBlock),
     go(kIdle, Action::kReplyStatus), kUnexpected, go(kIdle, Action::kReplyState), go(kIdle, Action::kAbort)},
    {kUnexpected, kUnexpected, kUnexpected, kUnexpected, go(kDownloadIdle, Action::kReplyStatus), kUnexpected,
     go(kDownloadSync, Action::kReplyState), kUnexpected},
    {kUnexpected, kUnexpected, kUnexpected, kUnexpected, go(kDownloadBusy, Action::kReplyStatus), kUnexpected,
     kUnexpected, kUnexpected},
    {kUnexpected, go(kDownloadSync, Action::kTakeBlock), go(kManifestSync, Action::kFinish), kUnexpected,
     go(kDownloadIdle, Action::kReplyStatus), kUnexpected, go(kDownloadIdle, Action::kReplyState),
     go(kIdle, Action::kAbort)},
    {kUnexpected, kUnexpected, kUnexpected, kUnexpected, go(kManifest, Action::kStartTimeout), kUnexpected,
     go(kManifestSync, Action::kReplyState), kUnexpected},
    {kUnexpected, kUnexpected, kUnexpected, kUnexpected, go(kManifest, Action::kReplyStatus), kUnexpected, kUnexpected,
     kUnexpected},
    {stall(kManifestWaitReset), stall(kManifestWaitReset), stall(kManifestWaitReset), stall(kManifestWaitReset),
     stall(kManifestWaitReset), stall(kManifestWaitReset), stall(kManifestWaitReset), stall(kManifestWaitReset)},
    {kUnexpected, kUnexpected, kUnexpected, go(kUploadIdle, Action::kSendBlock), go(kUploadIdle, Action::kReplyStatus),
     kUnexpected, go(kUploadIdle, Action::kReplyState), go(kIdle, Action::kAbort)},
    {stall(kError), stall(kError), stall(kError), stall(kError), go(kError, Action::kReplyStatus),
     go(kIdle, Action::kAbort), go(kError, Action::kReplyState), stall(kError)},
}};

std::optional<Column> column_of(const SetupPacket& setup) noexcept {
  const bool out = setup.request_type == image::request_type::kClassOut,
             in = setup.request_type == image::request_type::kClassIn;
  switch (static_cast<DfuRequest>(setup.request)) {
    case DfuRequest::kDetach:
      return out ? std::optional(Column::kDetach) : std::nullopt;
    case DfuRequest::kDownload:
      if (!out) return std::nullopt;
      return setup.length > 0 ? Column::kDownload : Column::kDownloadEnd;
    case DfuRequest::kUpload:
      return in ? std::optional(Column::kUpload) : std::nullopt;
    case DfuRequest::kGetStatus:
      return in ? std::optional(Column::kGetStatus) : std::nullopt;
    case DfuRequest::kClearStatus:
      return out ? std::optional(Column::kClearStatus) : std::nullopt;
    case DfuRequest::kGetState:
      return in ? std::optional(Column::kGetState) : std::nullopt;
    case DfuRequest::kAbort:
      return out ? std::optional(Column::kAbort) : std::nullopt;
  }
  return std::nullopt;
}

/// An unknown request is one that no column allows: as DETACH outside run-time mode.
DfuStep unknown_request(DfuPosition at) noexcept {
  return at.state == kAppIdle ? stall(kAppIdle) : kTable[static_cast<std::size_t>(at.state)][0];
}

/// Conditions of the table's cells.
DfuStep refine(DfuStep step, DfuPosition at, Column column, const DfuConfig& config,
               const DfuConditions& now) noexcept {
  switch (at.state) {
    case kIdle:
      if (column == Column::kDownload && !config.can_download) return kUnexpected;
      if (column == Column::kUpload && !config.can_upload) return kUnexpected;
      break;
    case kDownloadSync:
      if (column == Column::kGetStatus && now.busy) return go(kDownloadBusy, Action::kStartTimeout);
      break;
    case kDownloadIdle:
      if (column == Column::kDownloadEnd && !now.complete) {
        return {{kError, DfuStatus::kErrNotDone}, Action::kStall};
      }
      break;
    case kManifestSync:
      if (column == Column::kGetStatus && !now.busy && config.manifestation_tolerant) {
        return go(kIdle, Action::kReplyStatus);
      }
      break;
    default:
      break;
  }
  if (step.action == Action::kSendBlock && now.short_block) step.next.state = kIdle;
  return step;
}

}  // namespace

DfuStep on_request(DfuPosition at, const DfuConfig& config, const SetupPacket& setup,
                   const DfuConditions& conditions) noexcept {
  const std::optional<Column> column = column_of(setup);
  DfuStep step = column ? refine(kTable[static_cast<std::size_t>(at.state)][static_cast<std::size_t>(*column)], at,
                                 *column, config, conditions)
                        : unknown_request(at);
  // What went wrong stays readable until CLRSTATUS.
  if (at.state == kError && step.next.state == kError) step.next.status = at.status;
  return step;
}

DfuPosition on_bus_reset(DfuPosition at, const DfuConfig& config, bool valid_firmware) noexcept {
  if (!config.runtime) return {};
  if (at.state == kAppDetach) return {kIdle, DfuStatus::kOk};
  if (!valid_firmware) return {kError, DfuStatus::kErrFirmware};
  return {kAppIdle, DfuStatus::kOk};
}

DfuPosition on_poll_timeout(DfuPosition at, const DfuConfig& config) noexcept {
  if (at.state == kDownloadBusy) return {kDownloadSync, DfuStatus::kOk};
  if (at.state == kManifest) {
    return {config.manifestation_tolerant ? kManifestSync : kManifestWaitReset, DfuStatus::kOk};
  }
  return at;
}

DfuPosition on_detach_timeout(DfuPosition at) noexcept {
  return at.state == kAppDetach ? DfuPosition{kAppIdle, DfuStatus::kOk} : at;
}

}  // namespace enamel::fw
