#include "protocol/image/refusal.hpp"

namespace enamel::image {
namespace {

struct Entry {
  std::uint32_t number;
  int exit;
  RefusalText text;
};

constexpr Entry kEntries[] = {
#define ENAMEL_REFUSAL(name, number, status, exit, what, cause, remedy) {number, exit, {#name, what, cause, remedy}},
#include "protocol/image/refusals.def"
#undef ENAMEL_REFUSAL
};

const Entry* find(std::uint32_t number) noexcept {
  for (const Entry& e : kEntries) {
    if (e.number == number) return &e;
  }
  return nullptr;
}

}  // namespace

RefusalText describe_refusal(std::uint32_t number) noexcept {
  const Entry* entry = find(number);
  return entry != nullptr ? entry->text : RefusalText{};
}

int exit_code(Refusal why) noexcept {
  constexpr int kTransfer = 8;
  const Entry* entry = find(static_cast<std::uint32_t>(why));
  return entry != nullptr ? entry->exit : kTransfer;
}

}  // namespace enamel::image
