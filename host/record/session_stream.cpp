#include "host/record/session_stream.hpp"

#include <algorithm>
#include <filesystem>

namespace enamel::host {
namespace {

namespace fs = std::filesystem;

std::string part_path(const std::string& folder, int number) {
  const std::string name = number == 1 ? "capture.mcap" : "capture-" + std::to_string(number) + ".mcap";
  return (fs::path(folder) / name).string();
}

capture::CaptureInfo added_up(const std::vector<std::unique_ptr<BurstStream>>& parts) {
  capture::CaptureInfo sum = parts.front()->info();
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const capture::CaptureInfo& part = parts[i]->info();
    sum.bursts += part.bursts;
    sum.shed += part.shed;
    sum.statuses += part.statuses;
    sum.events += part.events;
    sum.device_infos += part.device_infos;
    sum.axes += part.axes;
    sum.last_log_ns = std::max(sum.last_log_ns, part.last_log_ns);
    sum.truncated = sum.truncated || part.truncated;
    sum.file_bytes += part.file_bytes;
    sum.problems.insert(sum.problems.end(), part.problems.begin(), part.problems.end());
  }
  return sum;
}

class SessionStream final : public BurstStream {
 public:
  explicit SessionStream(std::vector<std::unique_ptr<BurstStream>> parts)
      : parts_(std::move(parts)), info_(added_up(parts_)) {}
  [[nodiscard]] const capture::CaptureInfo& info() const noexcept override { return info_; }
  [[nodiscard]] const std::string& rig_text() const noexcept override { return parts_.front()->rig_text(); }
  [[nodiscard]] Result<std::optional<capture::Record>> next() override {
    for (; at_ < parts_.size(); ++at_) {
      auto record = parts_[at_]->next();
      if (!record || *record) return record;
    }
    return std::optional<capture::Record>{};
  }
  [[nodiscard]] std::uint64_t bursts_lost() const noexcept override {
    std::uint64_t sum = 0;
    for (const auto& part : parts_) sum += part->bursts_lost();
    return sum;
  }
  void rewind() noexcept override {
    for (const auto& part : parts_) part->rewind();
    at_ = 0;
  }
  [[nodiscard]] Result<proto::Burst> burst_with_id(BurstId id) override {
    for (std::size_t i = 0; i + 1 < parts_.size(); ++i) {
      if (auto burst = parts_[i]->burst_with_id(id)) return burst;
    }
    return parts_.back()->burst_with_id(id);
  }
  [[nodiscard]] Result<proto::Bytes> attachment(const std::string& name) override {
    return parts_.front()->attachment(name);
  }

 private:
  std::vector<std::unique_ptr<BurstStream>> parts_;
  capture::CaptureInfo info_;
  std::size_t at_ = 0;
};

}  // namespace

std::vector<std::string> session_parts(const std::string& folder) {
  std::vector<std::string> out;
  std::error_code ec;
  for (int n = 1; fs::is_regular_file(part_path(folder, n), ec); ++n) out.push_back(part_path(folder, n));
  return out;
}

std::string next_part(const std::string& folder) {
  return part_path(folder, static_cast<int>(session_parts(folder).size()) + 1);
}

Result<std::unique_ptr<BurstStream>> open_parts(const std::vector<std::string>& paths) {
  std::vector<std::unique_ptr<BurstStream>> parts;
  for (const std::string& path : paths) {
    auto part = open_bursts(path);
    // The program was killed before anything was whole in it: nothing of it is missing.
    if (!part && part.error().code == ErrorCode::kCaptureInvalid && parts.size() + 1 == paths.size() && !parts.empty())
      break;
    if (!part) return tl::unexpected<Error>(std::move(part).error());
    if (!parts.empty() && (*part)->rig_text() != parts.front()->rig_text()) {
      return fail(ErrorCode::kRigForeign, path + ": its probe is calibrated otherwise than that of " + paths.front());
    }
    parts.push_back(std::move(*part));
  }
  if (parts.empty()) return fail(ErrorCode::kEmptyInput, "no recording");
  if (parts.size() == 1) return std::move(parts.front());
  return std::unique_ptr<BurstStream>(std::make_unique<SessionStream>(std::move(parts)));
}

}  // namespace enamel::host
