// Absolute fringe order: the cheapest labelling of all segments with one of the shifts that the depth range allows
// them, under the code's evidence. Neighbouring segments of a surface prefer the same shift but may part at a price, so
// that a jump of a whole 2 pi, which no phase difference shows, is found by the code. A segment whose second-best
// labelling is nearly as cheap stays undecided: it is known relatively only and is rejected, never guessed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "pipeline/decode/unwrap/cells.hpp"
#include "pipeline/decode/unwrap/code_evidence.hpp"
#include "pipeline/decode/unwrap/order_messages.hpp"

namespace enamel::pipeline {

/// A part of a row's columns and who is lit by it.
struct LitColumn {
  Cost most = 0, next = 0;    ///< how sure the surest segment is, and the surest of all others
  std::int32_t segment = -1;  ///< the surest; -1: none
};

/// All costs are negative log probabilities.
struct OrderConfig {
  /// chosen: by judgement, as round odds, and kept by what rows of teeth and steps showed
  /// (docs/notes/decode-attempts.md, orders).
  float outlier_cost = 4.6F;      ///< 1 % of the segments lie (edges, glints): their code may be anything
  float unseen_jump_cost = 6.9F;  ///< a 2 pi jump inside a linked surface: one in a thousand neighbours
  float kink_jump_cost = 2.3F;    ///< at a step in the phase: it may be that step, or that and 2 pi; one in ten
  float shade_jump_cost = 2.3F;   ///< at a step of the modulation: texture, or a surface at another depth; one in ten
  float fold_cost = 2.3F;         ///< projector columns come in the other order beyond a gap: only behind thin things
  /// A dark gap whose ends could lie on one ray of light, and do not. chosen: on teeth and steps, where 95 % and more,
  /// and two thirds to all of such gaps are contacts (docs/notes/decode-attempts.md, orders).
  float missed_contact_cost = 3.0F;
  /// chosen: by judgement. Columns that light another segment of the row: one in a thousand, by blur.
  float lit_twice_cost = 6.9F;
  /// A segment that is less sure of its columns keeps them from no other: ten to one. chosen: on steps and on frames
  /// left over, which less would let pass (docs/notes/decode-attempts.md, orders).
  float least_claim = 2.3F;
  /// chosen: by judgement.
  float decided_margin = 4.6F;  ///< second-best must be this much dearer: 1 % risk
  float beyond_range_cost = 1;  ///< a segment and order: surfaces run on beyond the range, and must not be folded back
  float row_memory = 0.85F;     ///< weight of the rows before in the running mean: about 7 rows
  float inherit_cost = 2.3F;  ///< an undecided segment takes its surroundings' shift unless its code is 10 : 1 against
  int min_region_px = 64;     ///< smaller regions of one shift are specks
};

struct SegmentOrder {
  std::int32_t shift = 0;
  bool decided = false;
  bool inherited = false;  ///< decided by continuity with decided segments or by the range, not by its own code
  bool disowned = false;   ///< undecided: the code of its zone contradicts the shift of what it borders on, `shift`
  bool speck = false;
  Stance code = Stance::kSilent;  ///< of judge_orders: what its own code says of `shift`
};

struct OrderResult {
  std::vector<SegmentOrder> segments;  ///< parallel to the list of segments
  double agreeing_px = 0;       ///< pixels of decided or disowned segments whose code is that of the labelling …
  double contradicting_px = 0;  ///< … and of those whose is not
  std::size_t seams = 0;        ///< smooth borders between neighbouring cells of a row whose codes both speak …
  std::size_t torn_seams = 0;   ///< … where the labelling jumps by whole fringes

  struct Work {
    std::vector<OrderCosts> unary, row, right, up, down;
    std::vector<Cost> margin;  ///< by how much any other shift is dearer; 0 where none is possible
    std::vector<LitColumn> lit;
    std::vector<std::int32_t> base;  ///< shift of each segment's state 0
    std::vector<std::int32_t> parent, size;
    std::vector<std::int32_t> open;  ///< undecided segments
    /// Two linked segments, at least one of them undecided, and how many columns they share if their rows differ.
    struct Link {
      std::int32_t segment, other, shared_px;
    };
    std::vector<Link> links;
    /// Undecided segments of one base that hang together.
    struct Zone {
      std::array<std::int64_t, kOrderStates> costs{};     ///< what the code of all its segments says, summed
      std::array<std::int32_t, kOrderStates> votes_px{};  ///< of segments that have but this one within the depth range
      std::int32_t base = 0;                              ///< shift of state 0
      std::int32_t around = 0;                            ///< shift of the decided segments beside it
      std::uint32_t beside = 0;                           ///< states of all of these, a bit each
      std::int32_t offer = 0;                             ///< shift that its segments may take
      std::int32_t px = 0;
    };
    std::vector<Zone> zones;
    /// A component of the flood: the shifts that the depth range allows its segments.
    struct Part {
      std::int32_t low = std::numeric_limits<std::int32_t>::max(), last_low = std::numeric_limits<std::int32_t>::min();
      std::int32_t high = std::numeric_limits<std::int32_t>::min();
      std::int32_t widest = 0;                ///< number of shifts of a segment
      std::size_t first_slot = 0, slots = 0;  ///< in window_px and window_base; none: all segments share low - kBeyond
    };
    std::vector<Part> parts;
    std::vector<std::int32_t> window_px, window_base;  ///< by lowest shift, of the parts that need several bases
  } work;
};

/// Min-sum messages along rows and across their gaps (exact), running means between rows, columns that light one place
/// only, then continuity. Fixed order, deterministic. Fills `segments` and the counts of seams.
void find_orders(const std::vector<Segment>& segments, std::int32_t components, const CodeEvidence& evidence,
                 const OrderConfig& config, OrderResult& out);

/// Fills the counts of pixels whose code agrees with the labelling and of those whose contradicts it.
void judge_orders(const std::vector<Segment>& segments, const CodeEvidence& evidence, OrderResult& out);

}  // namespace enamel::pipeline
