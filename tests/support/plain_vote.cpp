// plain_steps.hpp: fringe numbers. Each segment is unwrapped but for one number of fringes; the code frame votes for
// it in windows within the segment, so that a wrong join of two surfaces spoils the vote beside it and not everywhere.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>

#include "tests/support/plain_steps.hpp"

namespace enamel::test::plain {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kHalfU = 21, kHalfV = 8;  ///< windows of 43 x 17 px: more than a fringe and a half wide
constexpr double kMinAcross = 30;       ///< pixels of the segment in the window's own row: a fringe must be in it
constexpr double kMinVoters = 150;      ///< pixels of the segment in the window
constexpr double kMinScore = 0.55, kMinLead = 0.2;
constexpr double kClearScore = 0.75, kClearLead = 0.3;  ///< of a segment as a whole
constexpr double kInRange = 0.9;                        ///< of a segment's pixels, within the depth range
constexpr double kUnanimous = 0.995;                    ///< of its windows, for the same number as the whole
constexpr std::size_t kMinCells = 5;                    ///< half fringes that a segment must be wide to vote as one
constexpr double kOutOfRange = -2;                      ///< below any score

/// A segment cut out of the image: maps of its bounding box, 0 outside the segment.
struct Cutout {
  Pixels image, box;  ///< its pixels in the image and here
  Map<double> inside;
  Map<double> phase_rad, code_dn, wave_dn;
  Map<int> first, last;  ///< fringes that may be added within the depth range
};

Cutout cut_out(const Pixels& members, const Fringes& fringes, const Segments& segments, const FringeSpan& span) {
  const auto width = static_cast<std::size_t>(fringes.phase_rad.width());
  const std::size_t v0 = members.front() / width, v1 = members.back() / width;  // members are in order
  std::size_t u0 = width, u1 = 0;
  for (const std::size_t i : members) u0 = std::min(u0, i % width), u1 = std::max(u1, i % width);
  const int w = static_cast<int>(u1 - u0) + 1, h = static_cast<int>(v1 - v0) + 1;
  const Map<double> zero(w, h);
  Cutout out{members, {}, zero, zero, zero, zero, Map<int>(w, h), Map<int>(w, h)};
  out.box.reserve(members.size());
  for (const std::size_t i : members) {
    const std::size_t at = zero.index(static_cast<int>(i % width - u0), static_cast<int>(i / width - v0));
    out.box.push_back(at);
    out.inside[at] = 1;
    out.phase_rad[at] = segments.phase_rad[i];
    out.code_dn[at] = fringes.code_dn[i];
    out.wave_dn[at] = fringes.wave_dn[i];
    const double fringe = segments.phase_rad[i] / (2 * kPi);
    out.first[at] = static_cast<int>(std::ceil(span.low[i] - fringe));
    out.last[at] = static_cast<int>(std::floor(span.high[i] - fringe));
  }
  return out;
}

/// What the code frame shows about its mean where the absolute phase is this.
double coded(const calib::PatternValues& pattern, double phase_rad, double wave_dn) {
  if (pattern.mode == calib::PatternMode::kMicro) return wave_dn * std::cos(phase_rad * (1 + 1 / pattern.code_ratio));
  const int cells = static_cast<int>(pattern.polarity_code.size());
  const int cell = (static_cast<int>(std::floor(phase_rad / kPi)) + pattern.first_cell) % cells;
  return wave_dn * pattern.polarity_code[static_cast<std::size_t>(cell < 0 ? cell + cells : cell)];
}

/// Agreement of the code frame with what it should show: 1 where it does, 0 where it has nothing to do with it.
struct Whole {
  double score;
  int number;
};

struct Votes {
  Map<double> best, second;
  Map<int> number;           ///< of the best
  std::vector<Whole> whole;  ///< the whole segment's, best first
};

void vote_for(int k, const calib::PatternValues& pattern, const Cutout& c, Votes& votes) {
  Map<double> agreement(c.inside.width(), c.inside.height()), power = agreement;
  double agreed = 0, total = 0, in_range = 0;
  const auto allowed = [&](std::size_t i) { return k >= c.first[i] && k <= c.last[i]; };
  for (const std::size_t i : c.box) {
    const double expected = coded(pattern, c.phase_rad[i] + 2 * kPi * k, c.wave_dn[i]);
    agreed += agreement[i] = c.code_dn[i] * expected;
    total += power[i] = expected * expected;
    in_range += allowed(i) ? 1 : 0;
  }
  const bool near_all = in_range > kInRange * static_cast<double>(c.box.size());
  votes.whole.push_back({near_all ? agreed / std::max(total, 1e-9) : kOutOfRange, k});
  agreement = window_sums(agreement, kHalfU, kHalfV);
  power = window_sums(power, kHalfU, kHalfV);
  for (const std::size_t i : c.box) {
    if (!allowed(i)) continue;
    const double score = agreement[i] / std::max(power[i], 1e-9);
    votes.second[i] = std::max(votes.second[i], std::min(score, votes.best[i]));
    if (score > votes.best[i]) votes.best[i] = score, votes.number[i] = k;
  }
}

Votes vote(const calib::PatternValues& pattern, const Cutout& c) {
  const int w = c.inside.width(), h = c.inside.height();
  Votes out{Map<double>(w, h, kOutOfRange), Map<double>(w, h, kOutOfRange), Map<int>(w, h), {}};
  int first = std::numeric_limits<int>::max(), last = std::numeric_limits<int>::min();
  for (const std::size_t i : c.box) first = std::min(first, c.first[i]), last = std::max(last, c.last[i]);
  for (int k = first; k <= last; ++k) vote_for(k, pattern, c, out);
  std::ranges::sort(out.whole, std::greater{}, &Whole::score);
  return out;
}

/// Pixels whose own window decides.
Map<std::uint8_t> sure_windows(const Cutout& c, const Votes& votes) {
  const Map<double> across = window_sums(c.inside, kHalfU, 0), voters = window_sums(c.inside, kHalfU, kHalfV);
  Map<std::uint8_t> out(c.inside.width(), c.inside.height());
  for (const std::size_t i : c.box)
    out[i] = across[i] > kMinAcross && voters[i] > kMinVoters && votes.best[i] > kMinScore &&
             votes.best[i] - votes.second[i] > kMinLead;
  return out;
}

/// Half fringes that hold a fair part of the segment.
std::size_t cells_of(const Cutout& c) {
  std::map<int, std::size_t> pixels;
  for (const std::size_t i : c.box) ++pixels[static_cast<int>(std::floor(c.phase_rad[i] / kPi))];
  const double fair = std::min(200.0, 0.03 * static_cast<double>(c.box.size()));
  return static_cast<std::size_t>(
      std::ranges::count_if(pixels, [&](const auto& cell) { return static_cast<double>(cell.second) > fair; }));
}

/// Whether the segment may be taken as one: its vote is clear, it is wide enough for it, and its windows agree.
bool is_clear(const Cutout& c, const Votes& votes, const Map<std::uint8_t>& sure) {
  const auto& whole = votes.whole;
  if (whole.empty() || whole[0].score < kClearScore || cells_of(c) < kMinCells) return false;
  if (whole.size() > 1 && whole[0].score - whole[1].score < kClearLead) return false;
  double windows = 0, same = 0;
  for (const std::size_t i : c.box) {
    if (sure[i] == 0) continue;
    ++windows;
    same += votes.number[i] == whole[0].number ? 1 : 0;
  }
  return windows > 0 && same > kUnanimous * windows;
}

}  // namespace

Map<double> window_sums(const Map<double>& image, int half_u, int half_v) {
  const int w = image.width(), h = image.height();
  Map<double> integral(w + 1, h + 1), out(w, h);
  for (int v = 0; v < h; ++v) {
    double row = 0;
    for (int u = 0; u < w; ++u) {
      row += image(u, v);
      integral(u + 1, v + 1) = integral(u + 1, v) + row;
    }
  }
  for (int v = 0; v < h; ++v) {
    const int top = std::max(0, v - half_v), bottom = std::min(h, v + half_v + 1);
    for (int u = 0; u < w; ++u) {
      const int left = std::max(0, u - half_u), right = std::min(w, u + half_u + 1);
      out(u, v) = integral(right, bottom) - integral(left, bottom) - integral(right, top) + integral(left, top);
    }
  }
  return out;
}

Map<double> number_fringes(const calib::PatternValues& pattern, const Fringes& fringes, const Segments& segments,
                           const FringeSpan& span) {
  Map<double> out(span.low.width(), span.low.height(), std::numeric_limits<double>::quiet_NaN());
  for (const Pixels& members : segments.members) {
    const Cutout c = cut_out(members, fringes, segments, span);
    const Votes votes = vote(pattern, c);
    const Map<std::uint8_t> sure = sure_windows(c, votes);
    const bool clear = is_clear(c, votes, sure);
    for (std::size_t j = 0; j < c.box.size(); ++j) {
      const std::size_t i = c.box[j];
      if (!clear && sure[i] == 0) continue;
      out[c.image[j]] = c.phase_rad[i] + 2 * kPi * (clear ? votes.whole[0].number : votes.number[i]);
    }
  }
  return out;
}

}  // namespace enamel::test::plain
