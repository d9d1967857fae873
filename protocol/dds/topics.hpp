// Typed ends of the topics. T is one of proto::{Burst, DeviceInfo, Status, Command, CommandReply, Event, TimeSyncReq,
// TimeSyncRep, AxesReading}; each type has exactly one topic, its quality of service is in qos.hpp.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/base/time.hpp"
#include "protocol/dds/participant.hpp"
#include "protocol/types/cdr.hpp"

namespace enamel::dds {

/// Who is at the other end now. A killed peer leaves within about 2 s (lease), one that closes properly at once.
struct PeerStatus {
  int matched = 0;                 ///< peers discovered and compatible
  int alive = 0;                   ///< of these, those whose liveliness holds; readers only, writers repeat `matched`
  std::uint64_t ever_matched = 0;  ///< counts arrivals: a restart shows although matched is back to 1
};

/// Thread-safe. Not for a capture thread: a reliable write waits while the link is slower than the data.
template <class T>
class Writer {
 public:
  [[nodiscard]] static Result<Writer> create(const Participant& participant);
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;
  ~Writer();

  /// Sends one sample. Errors: kMessageInvalid (bound exceeded, nothing sent); kDds (not sent: after the topic's
  /// max_blocking the peer had still not made room; or the transport failed).
  [[nodiscard]] Result<void> write(const T& value);
  [[nodiscard]] PeerStatus peers() const;
  /// True when all that was written has been acknowledged by all matched reliable readers.
  [[nodiscard]] bool wait_acknowledged(Nanoseconds timeout);

 private:
  struct Impl;
  explicit Writer(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

template <class T>
struct Received {
  T value;
  proto::Bytes cdr;            ///< as it was on the wire, with encapsulation header; what a recording stores
  std::int64_t source_ns = 0;  ///< writer's wall clock; for diagnosis only
  bool valid = false;          ///< false: the bytes could not be decoded, `value` is empty and `cdr` kept
};

enum class Wake { kData, kWoken, kTimeout };

/// take() and wait() from one thread; wake() and peers() from any.
template <class T>
class Reader {
 public:
  [[nodiscard]] static Result<Reader> create(const Participant& participant);
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  /// Takes what has arrived, oldest first, at most `max`; empty when nothing is there. Errors: kDds.
  [[nodiscard]] Result<std::vector<Received<T>>> take(int max = 16);
  /// Waits for data, a wake() or the timeout; kData wins over kWoken. A wake() before the wait ends the next wait.
  /// kData also when a peer left: take() is then empty.
  [[nodiscard]] Wake wait(Nanoseconds timeout);
  void wake();
  [[nodiscard]] PeerStatus peers() const;

 private:
  struct Impl;
  explicit Reader(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace enamel::dds
