// Untyped Cyclone writer and reader with the QoS of a table row. Private to this folder.
#pragma once

#include <dds/dds.h>

#include <memory>

#include "protocol/dds/participant_impl.hpp"
#include "protocol/dds/qos.hpp"
#include "protocol/dds/topics.hpp"

namespace enamel::dds {

class WriterEnd {
 public:
  [[nodiscard]] static Result<std::unique_ptr<WriterEnd>> create(const Participant& participant, const TopicQos& row,
                                                                 const dds_topic_descriptor_t& type);
  WriterEnd(const WriterEnd&) = delete;
  WriterEnd& operator=(const WriterEnd&) = delete;
  ~WriterEnd();

  [[nodiscard]] Result<void> write(const void* sample);
  [[nodiscard]] PeerStatus peers() const;
  [[nodiscard]] bool wait_acknowledged(Nanoseconds timeout);

 private:
  WriterEnd(std::shared_ptr<Participant::Impl> participant, const TopicQos& row, dds_entity_t topic,
            dds_entity_t writer);
  std::shared_ptr<Participant::Impl> participant_;
  const TopicQos& row_;
  dds_entity_t topic_;
  dds_entity_t writer_;
};

struct RawSample {
  proto::Bytes cdr;
  std::int64_t source_ns = 0;
};

class ReaderEnd {
 public:
  [[nodiscard]] static Result<std::unique_ptr<ReaderEnd>> create(const Participant& participant, const TopicQos& row,
                                                                 const dds_topic_descriptor_t& type);
  ReaderEnd(const ReaderEnd&) = delete;
  ReaderEnd& operator=(const ReaderEnd&) = delete;
  ~ReaderEnd();

  [[nodiscard]] Result<std::vector<RawSample>> take(int max);
  [[nodiscard]] Wake wait(Nanoseconds timeout);
  void wake();
  [[nodiscard]] PeerStatus peers() const;

 private:
  ReaderEnd(std::shared_ptr<Participant::Impl> participant, const TopicQos& row) noexcept
      : participant_(std::move(participant)), row_(row) {}
  [[nodiscard]] Result<void> open(const dds_topic_descriptor_t& type);
  std::shared_ptr<Participant::Impl> participant_;
  const TopicQos& row_;
  dds_entity_t topic_ = 0, reader_ = 0, data_ = 0, guard_ = 0, waitset_ = 0;
};

}  // namespace enamel::dds
