// A stream that holds bursts and nothing beside them. Derive, write next() and rewind().
#pragma once

#include <string>

#include "host/record/burst_stream.hpp"

namespace enamel::test {

class BareStream : public host::BurstStream {
 public:
  [[nodiscard]] const capture::CaptureInfo& info() const noexcept override { return info_; }
  [[nodiscard]] const std::string& rig_text() const noexcept override { return no_rig_; }
  [[nodiscard]] std::uint64_t bursts_lost() const noexcept override { return 0; }
  [[nodiscard]] Result<proto::Burst> burst_with_id(BurstId /*id*/) override { return fail(ErrorCode::kInternal, ""); }
  [[nodiscard]] Result<proto::Bytes> attachment(const std::string& name) override {
    return fail(ErrorCode::kFileNotFound, name);
  }

 protected:
  capture::CaptureInfo info_;

 private:
  std::string no_rig_;
};

}  // namespace enamel::test
