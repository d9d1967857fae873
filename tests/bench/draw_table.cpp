#include "tests/bench/draw_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

namespace enamel::bench {
namespace {

using pipeline::BurstVerdict;
using test::Judged;
using test::PixelKind;

struct Tally {
  std::size_t bursts = 0, accepted = 0, large_wrong = 0;
  std::map<std::string, std::size_t> rejected;
  std::size_t sure = 0, sure_covered = 0, sure_of_accepted = 0, placed = 0, wrong = 0, in_shadow = 0, off_object = 0;
  std::size_t smooth = 0, misled = 0;
  std::size_t floors = 0, below = 0;  ///< bursts of which a plain decoder's depths are a floor; that fall below it
  std::array<test::ZScores, test::kPixelKinds> z;

  void add(const DrawRow& row) {
    const Judged& j = row.judged;
    ++bursts;
    floors += row.beside.is_floor() ? 1U : 0U, below += row.beside.holds() ? 0U : 1U;
    sure += j.sure, sure_covered += j.sure_covered;
    if (!j.accepted()) {
      ++rejected[std::string(name_of(j.verdict))];
      return;
    }
    ++accepted;
    sure_of_accepted += j.sure;
    large_wrong += j.largest_wrong > test::kLargeWrongRegion_px ? 1U : 0U;
    placed += j.placed, wrong += j.wrong, in_shadow += j.in_shadow, off_object += j.off_object;
    smooth += j.smooth, misled += j.misled;
    for (std::size_t k = 0; k < z.size(); ++k) z[k] += j.z[k];
  }

  [[nodiscard]] std::string line(std::string_view name) const {
    const auto of = [&](PixelKind k) -> const test::ZScores& { return z[static_cast<std::size_t>(k)]; };
    std::string why;
    for (const auto& [reason, count] : rejected) why += fmt::format("{}{} {}", why.empty() ? "" : ", ", count, reason);
    return fmt::format(
        "{:<16}{:>6}{:>6}{:>7}{:>7}{:>8.1f}{:>8.1f}{:>9.3f}{:>6}{:>8}{:>9}{:>9.3f}{:>7.2f}{:>7.2f}{:>7.2f}{:>7.2f}{:>7."
        "2f}  {}\n",
        name, bursts, accepted, floors, below, 100 * Judged::share(sure_covered, sure),
        100 * Judged::share(sure_covered, sure_of_accepted), 100 * Judged::share(wrong, placed), large_wrong, in_shadow,
        off_object, 100 * Judged::share(misled, smooth), of(PixelKind::kSmooth).rms(),
        of(PixelKind::kSmooth).by_median(), of(PixelKind::kNearEdge).rms(), of(PixelKind::kMoving).rms(),
        of(PixelKind::kWeak).rms(), why);
  }
};

constexpr std::string_view kHead =
    "                bursts  acc.  plain  below  cover%   acc.%   wrong%  >100   shade  nowhere  misled%    rms  by "
    "med   edge "
    "moving   weak  "
    "rejected\n";

using ClassOf = std::function<int(const test::Drawn&)>;

template <std::size_t N>
std::string table(const std::vector<const DrawRow*>& rows, std::string_view title,
                  const std::array<std::string_view, N>& names, const ClassOf& class_of) {
  std::array<Tally, N> classes;
  for (const DrawRow* row : rows) {
    if (row->judged.is_true_burst()) classes[static_cast<std::size_t>(class_of(row->drawn))].add(*row);
  }
  std::string out = fmt::format("{}\n{}", title, kHead);
  for (std::size_t k = 0; k < N; ++k) out += classes[k].line(names[k]);
  return out + "\n";
}

constexpr double kMisled = 0.01;  ///< of the pixels away from edges

/// Whether the fault brought errors that its burst has not without it.
bool misleads(const DrawRow& row, const FaultRow& f) {
  return f.verdict == BurstVerdict::kAccepted && f.misled_share > kMisled && row.judged.misled_share() <= kMisled;
}

std::string fault_table(const std::vector<const DrawRow*>& rows) {
  struct Counts {
    std::size_t bursts = 0, rejected = 0, misled = 0;
  };
  std::array<Counts, test::kFrameFaults> counts{};
  for (const DrawRow* row : rows) {
    for (const FaultRow& f : row->faults) {
      Counts& c = counts[static_cast<std::size_t>(f.fault)];
      ++c.bursts, c.rejected += f.verdict == BurstVerdict::kAccepted ? 0U : 1U, c.misled += misleads(*row, f) ? 1U : 0U;
    }
  }
  std::string out;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (counts[k].bursts == 0) continue;
    out += fmt::format("{:<12}{:>8}{:>10}{:>17}{:>12.2f} %\n", test::kFrameFaultNames[k], counts[k].bursts,
                       counts[k].rejected, counts[k].misled, 100 * Judged::share(counts[k].misled, counts[k].bursts));
  }
  return out.empty() ? out : "faults        bursts  rejected  accepted, misled\n" + out + "\n";
}

std::string worst_faults(const std::vector<DrawRow>& rows, std::size_t how_many) {
  std::vector<std::pair<const DrawRow*, const FaultRow*>> bad;
  for (const DrawRow& row : rows) {
    for (const FaultRow& f : row.faults)
      if (misleads(row, f)) bad.emplace_back(&row, &f);
  }
  std::stable_sort(bad.begin(), bad.end(),
                   [](const auto& a, const auto& b) { return a.second->misled_share > b.second->misled_share; });
  std::string out = fmt::format("pixels misled by a fault, % ({} bursts)\n", bad.size());
  for (std::size_t k = 0; k < std::min(bad.size(), how_many); ++k) {
    const auto& [row, f] = bad[k];
    out += fmt::format("  {:>9.2f} {}, {} | {}\n", 100 * f->misled_share,
                       test::kFrameFaultNames[static_cast<std::size_t>(f->fault)], f->what, test::describe(row->drawn));
  }
  return bad.empty() ? "" : out;
}

std::string of_mode(const std::vector<const DrawRow*>& rows) {
  Tally true_bursts, others;
  std::size_t refused = 0;
  double render_ms = 0, decode_ms = 0;
  for (const DrawRow* row : rows) {
    (row->judged.is_true_burst() ? true_bursts : others).add(*row);
    refused += row->refused.size();
    render_ms += row->render_ms, decode_ms += row->decode_ms;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(1, rows.size()));
  std::string out = table(rows, "by response", test::kResponseNames, test::response_class);
  out +=
      table(rows, "by scene", test::kSceneNames, [](const test::Drawn& d) { return static_cast<int>(d.scene.kind); });
  out += table(rows, "by motion", test::kMotionNames, test::motion_band);
  out += table(rows, "by albedo", test::kAlbedoNames, test::albedo_band);
  out += table(rows, "by view", test::kViewNames, test::view_band);
  out += fmt::format("all\n{}{}{}", kHead, true_bursts.line("true bursts"), others.line("others"));
  out += fmt::format("{} rigs refused and drawn anew; {:.0f} ms to render and {:.0f} ms to decode a burst\n\n", refused,
                     render_ms / n, decode_ms / n);
  return out + fault_table(rows);
}

struct Ranking {
  std::string_view title;
  std::function<double(const DrawRow&)> badness;  ///< 0 and below: not bad
};

}  // namespace

std::string draw_tables(const std::vector<DrawRow>& rows) {
  std::string out;
  for (const auto mode : {calib::PatternMode::kMicro, calib::PatternMode::kPolarity}) {
    std::vector<const DrawRow*> of;
    for (const DrawRow& row : rows)
      if (row.decoded && row.drawn.rig.patterns.mode == mode) of.push_back(&row);
    if (of.empty()) continue;
    out += fmt::format("mode {}\n\n", mode == calib::PatternMode::kMicro ? "M" : "T") + of_mode(of);
  }
  return out;
}

std::string worst_draws(const std::vector<DrawRow>& rows, std::size_t how_many) {
  constexpr double kGap = 0.03, kTooSmall = 1.15;
  const auto rejected = [](const DrawRow& row) {
    const Judged& j = row.judged;
    return j.is_true_burst() && !j.accepted() ? static_cast<double>(j.sure) : 0;
  };
  const auto large_wrong = [](const DrawRow& row) {
    const auto px = static_cast<double>(row.judged.largest_wrong);
    return row.judged.largest_wrong > test::kLargeWrongRegion_px ? px : 0;
  };
  const auto gap = [](const DrawRow& row) {
    const double missing = 1 - row.judged.coverage();
    return row.judged.is_true_burst() && row.judged.accepted() && missing > kGap ? 100 * missing : 0;
  };
  const auto below_plain = [](const DrawRow& row) {
    const double less = row.beside.plain.coverage() - row.beside.product.coverage();
    return row.judged.is_true_burst() && row.judged.accepted() && !row.beside.holds() ? std::max(100 * less, 0.01) : 0;
  };
  const auto too_small = [](const DrawRow& row) {
    const double rms = row.judged.z[static_cast<std::size_t>(PixelKind::kSmooth)].rms();
    return row.judged.is_true_burst() && rms > kTooSmall ? rms : 0;
  };
  const std::array<Ranking, 5> rankings = {{{"true bursts rejected, by sure pixels", rejected},
                                            {"largest wrong region, px", large_wrong},
                                            {"sure pixels without a depth, %", gap},
                                            {"coverage below a plain decoder's or more wrong, %", below_plain},
                                            {"rms of error over sigma, smooth surface", too_small}}};
  std::string out;
  for (const Ranking& ranking : rankings) {
    std::vector<const DrawRow*> bad;
    for (const DrawRow& row : rows)
      if (ranking.badness(row) > 0) bad.push_back(&row);
    std::stable_sort(bad.begin(), bad.end(),
                     [&](const DrawRow* a, const DrawRow* b) { return ranking.badness(*a) > ranking.badness(*b); });
    out += fmt::format("{} ({} bursts)\n", ranking.title, bad.size());
    for (std::size_t k = 0; k < std::min(bad.size(), how_many); ++k) {
      const DrawRow& row = *bad[k];
      out += fmt::format("  {:>9.2f} {} | {} fastest {:.2f} rad\n", ranking.badness(row), test::describe(row.drawn),
                         name_of(row.judged.verdict), row.judged.fastest_rad_a_frame);
    }
  }
  return out + worst_faults(rows, how_many);
}

std::string draws_json(const std::vector<DrawRow>& rows) {
  using Json = nlohmann::ordered_json;
  Json out = Json::array();
  for (const DrawRow& row : rows) {
    if (!row.decoded) continue;
    const test::Drawn& d = row.drawn;
    const Judged& j = row.judged;
    Json z;
    for (std::size_t k = 0; k < test::kPixelKinds; ++k) {
      const test::ZScores& of = j.z[k];
      z[std::string(test::kPixelKindNames[k])] = {of.count(), of.rms(), of.by_median(), of.mean()};
    }
    Json faults = Json::array();
    for (const FaultRow& f : row.faults) {
      faults.push_back({{"fault", test::kFrameFaultNames[static_cast<std::size_t>(f.fault)]},
                        {"what", f.what},
                        {"verdict", name_of(f.verdict)},
                        {"misled_share", f.misled_share}});
    }
    out.push_back({{"seed", d.seed},
                   {"mode", d.rig.patterns.mode == calib::PatternMode::kMicro ? "M" : "T"},
                   {"conditions", test::describe(d)},
                   {"response", test::kResponseNames[static_cast<std::size_t>(test::response_class(d))]},
                   {"scene", test::kSceneNames[static_cast<std::size_t>(d.scene.kind)]},
                   {"motion", test::kMotionNames[static_cast<std::size_t>(test::motion_band(d))]},
                   {"albedo", test::kAlbedoNames[static_cast<std::size_t>(test::albedo_band(d))]},
                   {"verdict", name_of(j.verdict)},
                   {"true_burst", j.is_true_burst()},
                   {"fastest_rad_a_frame", j.fastest_rad_a_frame},
                   {"lit", j.lit},
                   {"covered", j.covered},
                   {"sure", j.sure},
                   {"sure_covered", j.sure_covered},
                   {"placed", j.placed},
                   {"wrong", j.wrong},
                   {"largest_wrong", j.largest_wrong},
                   {"in_shadow", j.in_shadow},
                   {"off_object", j.off_object},
                   {"plain_coverage", row.beside.plain.coverage()},
                   {"plain_wrong_share", row.beside.plain.wrong_share()},
                   {"holds_beside_plain", row.beside.holds()},
                   {"smooth", j.smooth},
                   {"misled", j.misled},
                   {"z_count_rms_median_mean", z},
                   {"faults", faults},
                   {"refused", row.refused}});
  }
  return out.dump(1);
}

}  // namespace enamel::bench
