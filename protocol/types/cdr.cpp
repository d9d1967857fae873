#include "protocol/types/cdr.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

#include "protocol/base/bytes.hpp"
#include "protocol/types/cdr_fields.hpp"

namespace enamel::proto {
namespace {

constexpr std::size_t kHeader = 4;  // encapsulation: 2 bytes kind, 2 bytes options; alignment counts from behind it
constexpr std::uint8_t kPlainXcdr1 = 0x01;
constexpr std::uint8_t kDelimitedXcdr2 = 0x09;

class Encoder {
 public:
  Encoder(bool is_final, std::size_t size_hint) : max_align_(is_final ? 8U : 4U) {
    out_.reserve(size_hint);
    out_ = {0, is_final ? kPlainXcdr1 : kDelimitedXcdr2, 0, 0};
  }

  template <class... V>
  void values(const V&... v) {
    (value(v), ...);
  }
  template <class Wire, class E>
  void enumerator(E e, std::uint32_t max) {
    if (static_cast<std::int64_t>(e) > static_cast<std::int64_t>(max)) note("enumerator out of range");
    value(static_cast<Wire>(e));
  }
  void text(const std::string& s, std::size_t bound) {
    if (s.size() > bound) note("text longer than " + std::to_string(bound) + " bytes");
    if (s.find('\0') != std::string::npos) note("text holds a zero byte");
    value(static_cast<std::uint32_t>(s.size() + 1));
    out_.insert(out_.end(), s.begin(), s.end());
    out_.push_back(0);
  }
  void angle(double deg) {
    if (std::abs(deg) > kMaxAxisAngle_deg) note("angle beyond the travel of any axis");
    value(deg);
  }
  void octets(const Bytes& b, std::size_t bound) {
    if (b.size() > std::min<std::size_t>(bound, 0xFFFFFFFFU)) note("sequence longer than its bound");
    value(static_cast<std::uint32_t>(b.size()));
    out_.insert(out_.end(), b.begin(), b.end());
  }
  // Only of @final types, so without a length header of their own.
  template <class M>
  void structs(const std::vector<M>& items, std::size_t bound) {
    if (items.size() > bound) note("sequence longer than " + std::to_string(bound));
    value(static_cast<std::uint32_t>(items.size()));
    for (const M& m : items) detail::visit(*this, m);
  }
  void patch_length() {
    const auto n = static_cast<std::uint32_t>(out_.size() - 2 * kHeader);
    std::memcpy(out_.data() + kHeader, &n, sizeof n);
  }
  // The stream ends on a multiple of 4; the options say how many bytes were added.
  [[nodiscard]] Result<Bytes> finish() {
    if (!problem_.empty()) return fail(ErrorCode::kMessageInvalid, std::move(problem_));
    const std::size_t padding = (4 - out_.size() % 4) % 4;
    out_.insert(out_.end(), padding, std::uint8_t{0});
    out_[3] = static_cast<std::uint8_t>(padding);
    return std::move(out_);
  }

  template <WireScalar V>
  void value(V v) {
    const std::size_t align = std::min(sizeof(V), max_align_);
    out_.insert(out_.end(), (align - (out_.size() - kHeader) % align) % align, std::uint8_t{0});
    std::array<std::uint8_t, sizeof(V)> raw;
    std::memcpy(raw.data(), &v, sizeof(V));
    out_.insert(out_.end(), raw.begin(), raw.end());
  }
  template <class V, std::size_t N>
  void value(const std::array<V, N>& a) {
    for (const V& v : a) value(v);
  }

 private:
  void note(std::string what) {
    if (problem_.empty()) problem_ = std::move(what);
  }

  Bytes out_;
  std::size_t max_align_;
  std::string problem_;
};

class Decoder {
 public:
  Decoder(ByteView body, std::size_t max_align) : in_(std::as_bytes(body)), max_align_(max_align) {}

  template <class... V>
  void values(V&... v) {
    (value(v), ...);
  }
  template <class Wire, class E>
  void enumerator(E& e, std::uint32_t max) {
    Wire raw{};
    value(raw);
    if (static_cast<std::int64_t>(raw) > static_cast<std::int64_t>(max)) in_.invalidate();
    if (in_.ok()) e = static_cast<E>(raw);
  }
  void text(std::string& s, std::size_t bound) {
    std::uint32_t n = 0;
    value(n);
    if (n == 0 || n - 1 > bound) in_.invalidate();
    const std::string_view raw = in_.take_text(n);
    if (!in_.ok() || raw.find('\0') != n - 1) {
      in_.invalidate();
      return;
    }
    s.assign(raw.substr(0, n - 1));
  }
  void angle(double& deg) {
    value(deg);
    if (std::abs(deg) > kMaxAxisAngle_deg) in_.invalidate();
  }
  void octets(Bytes& b, std::size_t bound) {
    std::uint32_t n = 0;
    value(n);
    if (n > bound) in_.invalidate();
    const auto raw = in_.take(n);
    if (!in_.ok()) return;
    b.resize(raw.size());
    if (!raw.empty()) std::memcpy(b.data(), raw.data(), raw.size());
  }
  template <class M>
  void structs(std::vector<M>& items, std::size_t bound) {
    std::uint32_t n = 0;
    value(n);
    if (n > bound) in_.invalidate();
    if (!in_.ok()) return;
    items.resize(n);
    for (M& m : items) detail::visit(*this, m);
  }
  template <WireScalar V>
  void value(V& v) {
    in_.align(std::min(sizeof(V), max_align_));
    v = in_.get<V>();
  }
  template <class V, std::size_t N>
  void value(std::array<V, N>& a) {
    for (V& v : a) value(v);
  }
  [[nodiscard]] bool ok() const noexcept { return in_.ok(); }
  [[nodiscard]] std::size_t remaining() const noexcept { return in_.remaining(); }

 private:
  ByteReader in_;
  std::size_t max_align_;
};

template <class T>
std::size_t size_hint(const T& value) {
  if constexpr (std::same_as<T, Burst>) return value.payload.size() + value.meta.size() * sizeof(FrameMeta) + 256;
  return 512;
}

Result<ByteView> body_of(ByteView cdr, bool is_final) {
  if (cdr.size() < kHeader) return fail(ErrorCode::kMessageInvalid, "shorter than its header");
  const std::uint8_t kind = is_final ? kPlainXcdr1 : kDelimitedXcdr2;
  if (cdr[0] != 0 || cdr[1] != kind || cdr[2] != 0 || cdr[3] > 3) {
    return fail(ErrorCode::kMessageInvalid, "encapsulation is not the type's");
  }
  const std::size_t padding = cdr[3];
  const ByteView body = cdr.subspan(kHeader);
  if (body.size() < padding) return fail(ErrorCode::kMessageInvalid, "shorter than its padding");
  return body.first(body.size() - padding);
}

}  // namespace

template <class T>
Result<Bytes> to_cdr(const T& value) {
  Encoder out(detail::kFinal<T>, size_hint(value));
  if constexpr (!detail::kFinal<T>) out.values(std::uint32_t{0});
  detail::visit(out, value);
  if constexpr (!detail::kFinal<T>) out.patch_length();
  return out.finish();
}

template <class T>
Result<T> from_cdr(ByteView cdr) {
  ENAMEL_TRY_ASSIGN(ByteView body, body_of(cdr, detail::kFinal<T>));
  if constexpr (!detail::kFinal<T>) {
    std::uint32_t length = 0;
    Decoder head(body, 4);
    head.values(length);
    // The length header is 4 bytes, so alignment to at most 4 is the same counted from behind it.
    if (!head.ok() || length != head.remaining()) return fail(ErrorCode::kMessageInvalid, "length header is wrong");
    body = body.subspan(sizeof length);
  }
  Decoder in(body, detail::kFinal<T> ? 8U : 4U);
  T value;
  detail::visit(in, value);
  if (!in.ok()) return fail(ErrorCode::kMessageInvalid, "a member is cut short or out of range");
  if (detail::kFinal<T> && in.remaining() != 0) return fail(ErrorCode::kMessageInvalid, "bytes behind the last member");
  return value;
}

#define ENAMEL_CDR_TYPE(T)                    \
  template Result<Bytes> to_cdr<T>(const T&); \
  template Result<T> from_cdr<T>(ByteView cdr);
ENAMEL_CDR_TYPE(Burst)
ENAMEL_CDR_TYPE(DeviceInfo)
ENAMEL_CDR_TYPE(Status)
ENAMEL_CDR_TYPE(Command)
ENAMEL_CDR_TYPE(CommandReply)
ENAMEL_CDR_TYPE(Event)
ENAMEL_CDR_TYPE(TimeSyncReq)
ENAMEL_CDR_TYPE(TimeSyncRep)
ENAMEL_CDR_TYPE(AxesReading)
ENAMEL_CDR_TYPE(ShedNote)
#undef ENAMEL_CDR_TYPE

}  // namespace enamel::proto
