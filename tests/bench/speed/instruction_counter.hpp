// Instructions that a thread has executed in user mode, by the processor's own counter: what load beside it does not
// change, as it changes times.
#pragma once

#include <cstdint>
#include <string>

namespace enamel::bench {

/// Counts the thread that opens it. Move-free: lives where it was made.
class InstructionCounter {
 public:
  InstructionCounter() = default;
  ~InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  /// False where the kernel gives none; problem() says why.
  bool open() noexcept;
  [[nodiscard]] bool opened() const noexcept { return fd_ >= 0; }
  /// Since open(); 0 where not opened.
  [[nodiscard]] std::uint64_t value() noexcept;
  /// The counter was shared with other users for a while: values are too low.
  [[nodiscard]] bool shared() const noexcept { return shared_; }
  [[nodiscard]] std::string problem() const;

 private:
  int fd_ = -1;
  int errno_ = 0;
  bool shared_ = false;
};

}  // namespace enamel::bench
