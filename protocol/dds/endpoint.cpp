#include "protocol/dds/endpoint.hpp"

#include <dds/ddsi/ddsi_serdata.h>

#include <algorithm>
#include <array>

namespace enamel::dds {
namespace {

using QosPtr = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

QosPtr make_qos(const TopicQos& row, bool for_writer) {
  QosPtr qos(dds_create_qos(), &dds_delete_qos);
  dds_qset_reliability(qos.get(), row.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_MSECS(row.max_blocking_ms));
  dds_qset_durability(qos.get(), row.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), row.history == 0 ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST, row.history);
  if (row.transient_local) {
    const auto kind = row.history == 0 ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST;
    dds_qset_durability_service(qos.get(), 0, kind, std::max(row.history, 1), DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  if (for_writer) {
    dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, DDS_MSECS(kLivelinessLeaseMs));
    if (row.lifespan_ms > 0) dds_qset_lifespan(qos.get(), DDS_MSECS(row.lifespan_ms));
    // A writer that closes has nothing more to say about its instance; disposing would only make empty samples.
    dds_qset_writer_data_lifecycle(qos.get(), false);
  } else if (row.reader_max_samples > 0) {
    dds_qset_resource_limits(qos.get(), row.reader_max_samples, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

Result<dds_entity_t> make_topic(dds_entity_t participant, const TopicQos& row, const dds_topic_descriptor_t& type) {
  const dds_entity_t topic = dds_create_topic(participant, &type, std::string(row.topic).c_str(), nullptr, nullptr);
  if (topic < 0) return dds_fail(topic, "topic " + std::string(row.topic));
  return topic;
}

}  // namespace

WriterEnd::WriterEnd(std::shared_ptr<Participant::Impl> participant, const TopicQos& row, dds_entity_t topic,
                     dds_entity_t writer)
    : participant_(std::move(participant)), row_(row), topic_(topic), writer_(writer) {}

Result<std::unique_ptr<WriterEnd>> WriterEnd::create(const Participant& participant, const TopicQos& row,
                                                     const dds_topic_descriptor_t& type) {
  ENAMEL_TRY_ASSIGN(const dds_entity_t topic, make_topic(participant.impl()->entity, row, type));
  const dds_entity_t writer = dds_create_writer(participant.impl()->entity, topic, make_qos(row, true).get(), nullptr);
  if (writer < 0) {
    dds_delete(topic);
    return dds_fail(writer, "writer of " + std::string(row.topic));
  }
  return std::unique_ptr<WriterEnd>(new WriterEnd(participant.impl(), row, topic, writer));
}

WriterEnd::~WriterEnd() {
  dds_delete(writer_);
  dds_delete(topic_);
}

Result<void> WriterEnd::write(const void* sample) {
  const dds_return_t rc = dds_write(writer_, sample);
  if (rc != DDS_RETCODE_OK) return dds_fail(rc, "write to " + std::string(row_.topic));
  return {};
}

PeerStatus WriterEnd::peers() const {
  dds_publication_matched_status_t matched{};
  PeerStatus status;
  if (dds_get_publication_matched_status(writer_, &matched) != DDS_RETCODE_OK) return status;
  status.matched = static_cast<int>(matched.current_count);
  status.alive = status.matched;
  status.ever_matched = matched.total_count;
  return status;
}

bool WriterEnd::wait_acknowledged(Nanoseconds timeout) {
  return dds_wait_for_acks(writer_, timeout.count()) == DDS_RETCODE_OK;
}

Result<std::unique_ptr<ReaderEnd>> ReaderEnd::create(const Participant& participant, const TopicQos& row,
                                                     const dds_topic_descriptor_t& type) {
  std::unique_ptr<ReaderEnd> end(new ReaderEnd(participant.impl(), row));
  ENAMEL_TRY(end->open(type));
  return end;
}

Result<void> ReaderEnd::open(const dds_topic_descriptor_t& type) {
  const dds_entity_t owner = participant_->entity;
  const std::string what = "reader of " + std::string(row_.topic);
  ENAMEL_TRY_ASSIGN(topic_, make_topic(owner, row_, type));
  reader_ = dds_create_reader(owner, topic_, make_qos(row_, false).get(), nullptr);
  if (reader_ < 0) return dds_fail(reader_, what);
  data_ = dds_create_readcondition(reader_, DDS_ANY_STATE);
  if (data_ < 0) return dds_fail(data_, what);
  guard_ = dds_create_guardcondition(owner);
  if (guard_ < 0) return dds_fail(guard_, what);
  waitset_ = dds_create_waitset(owner);
  if (waitset_ < 0) return dds_fail(waitset_, what);
  for (const dds_entity_t condition : {data_, guard_}) {
    const dds_return_t rc = dds_waitset_attach(waitset_, condition, condition);
    if (rc != DDS_RETCODE_OK) return dds_fail(rc, what);
  }
  return {};
}

ReaderEnd::~ReaderEnd() {
  for (const dds_entity_t entity : {waitset_, guard_, data_, reader_, topic_}) {
    if (entity > 0) dds_delete(entity);
  }
}

Result<std::vector<RawSample>> ReaderEnd::take(int max) {
  constexpr int kMaxTake = 64;
  std::array<ddsi_serdata*, kMaxTake> data{};
  std::array<dds_sample_info_t, kMaxTake> info{};
  const int limit = std::clamp(max, 1, kMaxTake);
  const dds_return_t n =
      dds_takecdr(reader_, data.data(), static_cast<std::uint32_t>(limit), info.data(), DDS_ANY_STATE);
  if (n < 0) return dds_fail(n, "take from " + std::string(row_.topic));
  std::vector<RawSample> out;
  out.reserve(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    if (info[i].valid_data) {
      const std::uint32_t size = ddsi_serdata_size(data[i]);
      ddsrt_iovec_t bytes{};
      ddsi_serdata* held = ddsi_serdata_to_ser_ref(data[i], 0, size, &bytes);
      const auto* begin = static_cast<const std::uint8_t*>(bytes.iov_base);
      out.push_back({proto::Bytes(begin, begin + bytes.iov_len), info[i].source_timestamp});
      ddsi_serdata_to_ser_unref(held, &bytes);
    }
    ddsi_serdata_unref(data[i]);
  }
  return out;
}

Wake ReaderEnd::wait(Nanoseconds timeout) {
  std::array<dds_attach_t, 2> woken{};
  const dds_return_t n = dds_waitset_wait(waitset_, woken.data(), woken.size(), timeout.count());
  bool by_guard = false;
  for (int i = 0; i < std::min<int>(n, static_cast<int>(woken.size())); ++i) {
    if (woken[static_cast<std::size_t>(i)] == data_) return Wake::kData;
    by_guard = true;
  }
  if (!by_guard) return Wake::kTimeout;
  bool was_set = false;
  dds_take_guardcondition(guard_, &was_set);
  return Wake::kWoken;
}

void ReaderEnd::wake() { dds_set_guardcondition(guard_, true); }

PeerStatus ReaderEnd::peers() const {
  dds_subscription_matched_status_t matched{};
  dds_liveliness_changed_status_t liveliness{};
  PeerStatus status;
  if (dds_get_subscription_matched_status(reader_, &matched) != DDS_RETCODE_OK) return status;
  status.matched = static_cast<int>(matched.current_count);
  status.ever_matched = matched.total_count;
  if (dds_get_liveliness_changed_status(reader_, &liveliness) == DDS_RETCODE_OK) {
    status.alive = std::min(status.matched, static_cast<int>(liveliness.alive_count));
  }
  return status;
}

}  // namespace enamel::dds
