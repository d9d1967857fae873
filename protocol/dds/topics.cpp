#include "protocol/dds/topics.hpp"

#include "protocol/dds/endpoint.hpp"
#include "protocol/dds/wire.hpp"

namespace enamel::dds {

template <class T>
struct Writer<T>::Impl {
  std::unique_ptr<WriterEnd> end;
};

template <class T>
Writer<T>::Writer(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
template <class T>
Writer<T>::Writer(Writer&&) noexcept = default;
template <class T>
Writer<T>& Writer<T>::operator=(Writer&&) noexcept = default;
template <class T>
Writer<T>::~Writer() = default;

template <class T>
Result<Writer<T>> Writer<T>::create(const Participant& participant) {
  ENAMEL_TRY_ASSIGN(auto end, WriterEnd::create(participant, kQos<T>, Wire<T>::descriptor()));
  return Writer(std::make_unique<Impl>(Impl{std::move(end)}));
}

template <class T>
Result<void> Writer<T>::write(const T& value) {
  typename Wire<T>::Type wire{};
  ENAMEL_TRY(Wire<T>::fill(wire, value));
  return impl_->end->write(&wire);
}

template <class T>
PeerStatus Writer<T>::peers() const {
  return impl_->end->peers();
}

template <class T>
bool Writer<T>::wait_acknowledged(Nanoseconds timeout) {
  return impl_->end->wait_acknowledged(timeout);
}

template <class T>
struct Reader<T>::Impl {
  std::unique_ptr<ReaderEnd> end;
};

template <class T>
Reader<T>::Reader(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
template <class T>
Reader<T>::Reader(Reader&&) noexcept = default;
template <class T>
Reader<T>& Reader<T>::operator=(Reader&&) noexcept = default;
template <class T>
Reader<T>::~Reader() = default;

template <class T>
Result<Reader<T>> Reader<T>::create(const Participant& participant) {
  ENAMEL_TRY_ASSIGN(auto end, ReaderEnd::create(participant, kQos<T>, Wire<T>::descriptor()));
  return Reader(std::make_unique<Impl>(Impl{std::move(end)}));
}

template <class T>
Result<std::vector<Received<T>>> Reader<T>::take(int max) {
  ENAMEL_TRY_ASSIGN(std::vector<RawSample> raw, impl_->end->take(max));
  std::vector<Received<T>> out;
  out.reserve(raw.size());
  for (RawSample& sample : raw) {
    Received<T> received;
    received.source_ns = sample.source_ns;
    if (auto value = proto::from_cdr<T>(sample.cdr)) {
      received.value = std::move(*value);
      received.valid = true;
    }
    received.cdr = std::move(sample.cdr);
    out.push_back(std::move(received));
  }
  return out;
}

template <class T>
Wake Reader<T>::wait(Nanoseconds timeout) {
  return impl_->end->wait(timeout);
}

template <class T>
void Reader<T>::wake() {
  impl_->end->wake();
}

template <class T>
PeerStatus Reader<T>::peers() const {
  return impl_->end->peers();
}

#define ENAMEL_TOPIC(T)            \
  template class Writer<proto::T>; \
  template class Reader<proto::T>;
ENAMEL_TOPIC(Burst)
ENAMEL_TOPIC(DeviceInfo)
ENAMEL_TOPIC(Status)
ENAMEL_TOPIC(Command)
ENAMEL_TOPIC(CommandReply)
ENAMEL_TOPIC(Event)
ENAMEL_TOPIC(TimeSyncReq)
ENAMEL_TOPIC(TimeSyncRep)
ENAMEL_TOPIC(AxesReading)
#undef ENAMEL_TOPIC

}  // namespace enamel::dds
