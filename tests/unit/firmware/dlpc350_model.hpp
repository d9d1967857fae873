// A MODEL of a DLPC350 on its USB port, by TI's table of commands: answers what the real one would, validates its table
// by the guide's rules, and refuses to run what it has not validated.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <vector>

#include "firmware/device/linux/dlpc350/hid_port.hpp"

namespace enamel::fw::test {

class Dlpc350Model final : public HidPort {
 public:
  using Bytes = std::vector<std::uint8_t>;
  enum class Fault : std::uint8_t { kNone, kNack, kSilence, kWrongSequence, kShort };

  [[nodiscard]] Result<void> write(const HidReport& report) override {
    if (is_unplugged()) return fail(ErrorCode::kProjector, "unplugged");
    pending_.insert(pending_.end(), report.begin(), report.end());
    const std::size_t size = 4U + pending_[2] + 256U * pending_[3];
    if (pending_.size() < size) return {};
    const bool is_padded = std::all_of(pending_.begin() + static_cast<std::ptrdiff_t>(size), pending_.end(),
                                       [](std::uint8_t b) { return b == 0; });
    if (!is_padded) ++unpadded;
    pending_.resize(size);
    if (static_cast<int>(messages.size()) == spoiled_message) pending_[spoiled_byte % size] ^= 1U;
    messages.push_back(pending_);
    handle(std::exchange(pending_, {}));
    return {};
  }

  [[nodiscard]] Result<std::size_t> read(HidReport& report, Nanoseconds limit) override {
    if (is_unplugged()) return fail(ErrorCode::kProjector, "unplugged");
    if (answers_.empty()) {
      waited += limit;
      return std::size_t{0};
    }
    const Bytes answer = answers_.front();
    answers_.pop_front();
    std::copy(answer.begin(), answer.end(), report.begin());
    return answer.size();
  }

  /// Reports that nobody asked for, as an answer that comes too late.
  void say(const Bytes& report) { answers_.push_back(report); }

  std::vector<Bytes> messages;  ///< with header, without padding
  std::map<unsigned, Bytes> registers{{0x1A05, {0}}, {0x1A1B, {0}}, {0x0B01, {0x68, 0x87, 0x82}}};
  Bytes table, images;
  std::uint8_t leds = 8, hardware = 1, system = 1, main = 0;
  bool runs = true;  ///< it comes up with a sequence of its own
  int unpadded = 0;
  int polls_until_mode = 2, polls_until_valid = 2, polls_until_running = 2;
  bool polarity_stuck = false, keeps_current = true;
  std::uint8_t also_invalid = 0;  ///< bits that the validation says besides
  Bytes version{5, 1, 7, 8, 0, 0, 0, 4, 0, 0, 0, 3, 0, 0, 0, 2};
  Nanoseconds waited{0};
  int spoiled_message = -1;  ///< one bit of it is another
  std::size_t spoiled_byte = 0;
  std::function<void(std::uint8_t)> on_leds;
  std::function<Fault(int)> faults;                       ///< by number of the message
  int unplugged_after = std::numeric_limits<int>::max();  ///< messages; the last one's answer is lost, too

 private:
  [[nodiscard]] bool is_unplugged() const { return static_cast<int>(messages.size()) >= unplugged_after; }

  void handle(const Bytes& message) {
    const Fault now = faults ? faults(static_cast<int>(messages.size()) - 1) : Fault::kNone;
    const unsigned command = message[4] + 256U * message[5];
    const Bytes payload(message.begin() + 6, message.end());
    Bytes data;
    if (now != Fault::kNack) {
      if ((message[0] & 0x80U) != 0) {
        data = answer_of(command);
      } else {
        take(command, payload);
      }
    }
    if (now == Fault::kSilence) return;
    const auto sequence = static_cast<std::uint8_t>(message[1] + (now == Fault::kWrongSequence ? 1 : 0));
    Bytes answer{static_cast<std::uint8_t>((message[0] & 0xC0U) | (now == Fault::kNack ? 0x20U : 0U)), sequence,
                 static_cast<std::uint8_t>(data.size() & 0xFFU), static_cast<std::uint8_t>(data.size() >> 8U)};
    answer.insert(answer.end(), data.begin(), data.end());
    if (now == Fault::kShort) {
      answers_.emplace_back(answer.begin(), answer.begin() + 3);
      return;
    }
    answer.resize((answer.size() + 63) / 64 * 64);
    for (auto at = answer.begin(); at != answer.end(); at += 64) answers_.emplace_back(at, at + 64);
  }

  [[nodiscard]] Bytes answer_of(unsigned command) {
    switch (command) {
      case 0x0205:
        return version;
      case 0x0B01:
        return keeps_current ? registers[command] : Bytes{0, 0, 0};
      case 0x1A05:
        return {static_cast<std::uint8_t>(polarity_stuck ? 1 : registers[command][0])};
      case 0x1A0A:
        return {hardware};
      case 0x1A0B:
        return {system};
      case 0x1A0C:
        return {static_cast<std::uint8_t>(main | (runs && polls_until_running-- <= 0 ? 2U : 0U))};
      case 0x1A1A:
        if (polls_until_valid-- > 0) return {0x80};
        is_valid_ = invalid() == 0;
        return {invalid()};
      case 0x1A1B:
        return {polls_until_mode-- > 0 ? std::uint8_t{0} : registers[command][0]};
      case 0x1A34:
        return table;
      default:
        return {0};
    }
  }

  void take(unsigned command, const Bytes& payload) {
    switch (command) {
      case 0x1A07:
        leds = payload[0];
        if (on_leds) on_leds(leds);
        return;
      case 0x1A1A:
        return;
      case 0x1A24:
        runs = payload[0] == 2 && is_valid_ && registers[0x1A1B] == Bytes{1};
        if (payload[0] == 2 && !runs) hardware |= 0x80U;
        return;
      case 0x1A34:
        if (registers[0x1A33] == Bytes{1}) images = payload;
        if (registers[0x1A33] == Bytes{2}) table = payload;
        is_valid_ = false;
        return;
      default:
        // What a sequence consists of is not changed under it.
        if (command != 0x0B01 && command != 0x1A05) is_valid_ = false;
        registers[command] = payload;
    }
  }

  [[nodiscard]] std::uint32_t word(unsigned command, std::size_t at) {
    const Bytes& b = registers[command];
    std::uint32_t v = 0;
    for (std::size_t i = 0; i < 4 && at + i < b.size(); ++i) v |= std::uint32_t{b[at + i]} << (8 * i);
    return v;
  }

  [[nodiscard]] std::uint8_t invalid() {
    unsigned bits = also_invalid;
    const std::uint32_t exposure = word(0x1A29, 0), period = word(0x1A29, 4);
    if (exposure < 8333 || period < exposure) bits |= 1U;
    if (table.size() != 12 || images.size() != 2 || registers[0x1A31] != Bytes{3, 1, 3, 1}) bits |= 2U;
    for (std::size_t i = 0; i + 2 < table.size(); i += 3) {
      if ((table[i] >> 2U) > 2 || (table[i + 1] & 0xFU) != 8) bits |= 2U;
      if ((table[i + 2] & 2U) == 0) bits |= 8U;
    }
    if (period != exposure && period - exposure < 230) bits |= 16U;
    return static_cast<std::uint8_t>(bits);
  }

  Bytes pending_;
  std::deque<Bytes> answers_;
  bool is_valid_ = false;
};

}  // namespace enamel::fw::test
