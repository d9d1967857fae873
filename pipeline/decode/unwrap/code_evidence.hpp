// What the code says about a segment's absolute order: the one thing in which pattern modes differ for the labelling.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace enamel::pipeline {

enum class Stance : std::uint8_t { kSilent, kAgrees, kContradicts };

/// Measured once a burst for all segments of a SegmentList, whose indices it is asked by.
class CodeEvidence {
 public:
  CodeEvidence() = default;
  virtual ~CodeEvidence() = default;
  CodeEvidence(const CodeEvidence&) = delete;
  CodeEvidence& operator=(const CodeEvidence&) = delete;

  /// Absolute half-fringe cells of the projector's frame are 0 … cells() - 1.
  [[nodiscard]] virtual int cells() const = 0;

  /// Orders after which the code is the same again; 0: it never is.
  [[nodiscard]] virtual int repeats_after() const = 0;

  /// Negative log probability of what was seen if the segment lay in absolute cell first_cell, first_cell + 2, … (all
  /// within the frame), each capped by that of a segment whose code lies. A segment that says nothing costs nothing.
  virtual void costs(std::size_t segment, std::int32_t first_cell, std::span<float> out) const = 0;

  /// Whether the segment's code is that of the absolute cell; kSilent when it is too faint to be asked.
  [[nodiscard]] virtual Stance stance(std::size_t segment, std::int32_t cell) const = 0;
};

}  // namespace enamel::pipeline
