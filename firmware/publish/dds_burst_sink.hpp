// Bursts over DDS.
#pragma once

#include <utility>

#include "firmware/publish/publisher.hpp"
#include "protocol/dds/participant.hpp"
#include "protocol/dds/topics.hpp"

namespace enamel::fw {

class DdsBurstSink final : public BurstSink {
 public:
  /// Errors: kDds.
  [[nodiscard]] static Result<DdsBurstSink> create(const dds::Participant& participant) {
    ENAMEL_TRY_ASSIGN(auto writer, dds::Writer<proto::Burst>::create(participant));
    return DdsBurstSink(std::move(writer));
  }
  [[nodiscard]] Result<void> write(const proto::Burst& burst) override { return writer_.write(burst); }
  /// True when every burst written has reached every host.
  [[nodiscard]] bool wait_acknowledged(Nanoseconds timeout) { return writer_.wait_acknowledged(timeout); }

 private:
  explicit DdsBurstSink(dds::Writer<proto::Burst> writer) : writer_(std::move(writer)) {}
  dds::Writer<proto::Burst> writer_;
};

}  // namespace enamel::fw
