// The last replies: a command that arrives again gets its first answer and is not executed again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <utility>

#include "protocol/types/device.hpp"

namespace enamel::fw {

class ReplyCache {
 public:
  static constexpr std::size_t kCapacity = 64;

  [[nodiscard]] const proto::CommandReply* find(std::uint32_t client_id, std::uint64_t cmd_id) const noexcept {
    const auto at = std::find_if(replies_.begin(), replies_.end(), [&](const proto::CommandReply& r) {
      return r.client_id == client_id && r.cmd_id == cmd_id;
    });
    return at == replies_.end() ? nullptr : &*at;
  }
  void add(proto::CommandReply reply) {
    replies_.push_back(std::move(reply));
    if (replies_.size() > kCapacity) replies_.pop_front();
  }

 private:
  std::deque<proto::CommandReply> replies_;
};

}  // namespace enamel::fw
