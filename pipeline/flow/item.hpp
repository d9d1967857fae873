// What travels on an edge: one burst's value, or the reason why it has none.
#pragma once

#include <memory>
#include <utility>

#include "protocol/base/ids.hpp"
#include "protocol/base/pool.hpp"
#include "protocol/base/time.hpp"

namespace enamel::flow {

/// What every item says whatever its payload.
struct ItemHead {
  BurstId id{};
  DeviceTime captured{};
  const char* rejected = nullptr;  ///< reason (a string of static storage, e.g. "low_modulation"), null = accepted
  bool degraded = false;           ///< some stage on the way worked with its fallback

  [[nodiscard]] bool ok() const noexcept { return rejected == nullptr; }
};

/// A value shared by all readers and immutable once emitted, or a tombstone (value null, `rejected` set).
template <class T>
struct Item : ItemHead {
  std::shared_ptr<const T> value;

  [[nodiscard]] const T& operator*() const noexcept { return *value; }
  [[nodiscard]] const T* operator->() const noexcept { return value.get(); }
};

template <class T>
[[nodiscard]] Item<T> make_item(const ItemHead& head, std::shared_ptr<const T> value) {
  Item<T> item;
  static_cast<ItemHead&>(item) = head;
  item.value = std::move(value);
  return item;
}
/// Moves `value` to the heap and shares it under `head`'s burst.
template <class T>
[[nodiscard]] Item<T> make_item(const ItemHead& head, T value) {
  return make_item<T>(head, std::make_shared<const T>(std::move(value)));
}
/// The tombstone of `head`'s burst. An earlier reason is kept: the first one is the cause.
template <class T>
[[nodiscard]] Item<T> make_rejected(const ItemHead& head, const char* reason) {
  Item<T> item = make_item<T>(head, std::shared_ptr<const T>());
  if (item.rejected == nullptr) item.rejected = reason;
  return item;
}

/// A pooled object as payload: its buffers go back to the pool with the last reader.
template <class T>
[[nodiscard]] std::shared_ptr<const T> share(Ref<const T> ref) {
  const T* object = ref.get();
  return {object, [kept = std::move(ref)](const T*) mutable { kept = {}; }};
}

}  // namespace enamel::flow
