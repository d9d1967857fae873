// How what the decoder finds depends on the numbers that were chosen for it: each is varied by 30 %, alone, and the
// figures stand in a table. Test-only.
#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"

namespace enamel::test {

using pipeline::DecodeConfig;

/// One chosen number and how it is changed by a factor.
struct Member {
  std::string name;
  std::function<void(DecodeConfig&, double)> scale;
};

template <class T>
void put(T& to, double value) {
  if constexpr (std::is_integral_v<T>) {
    to = static_cast<T>(std::lround(value));
  } else {
    to = static_cast<T>(value);
  }
}

/// get: the member of a configuration.
template <class Get>
Member times(std::string name, Get get) {
  return {std::move(name), [get](DecodeConfig& c, double by) { put(get(c), by * static_cast<double>(get(c))); }};
}

/// Of a share near 1 what is missing to 1 is what was chosen.
template <class Get>
Member rest_times(std::string name, Get get) {
  return {std::move(name),
          [get](DecodeConfig& c, double by) { put(get(c), 1 - by * (1 - static_cast<double>(get(c)))); }};
}

/// Of a steepest angle, in degrees, its tangent.
template <class Get>
Member tangent_times(std::string name, Get get) {
  return {std::move(name), [get](DecodeConfig& c, double by) {
            constexpr double kRad = std::numbers::pi / 180;
            put(get(c), std::atan(by * std::tan(kRad * static_cast<double>(get(c)))) / kRad);
          }};
}

/// Of one burst.
struct Figures {
  double placed_pct = 0;  ///< of the pixels that could be
  double wrong_pct = 0;   ///< of those placed
  double error = 0;       ///< of those right, in the unit that the scene says
};

/// Bursts under a configuration, the same ones each time.
using Judge = std::function<std::vector<Figures>(const DecodeConfig&)>;

/// Mean over bursts, and its standard error.
struct Mean {
  std::array<double, 3> of{}, error{};
};

inline Mean mean_of(const std::vector<Figures>& bursts) {
  const auto n = static_cast<double>(bursts.size());
  std::array<double, 3> sums{}, squares{};
  for (const Figures& f : bursts) {
    const std::array<double, 3> x{f.placed_pct, f.wrong_pct, f.error};
    for (std::size_t k = 0; k < x.size(); ++k) sums[k] += x[k], squares[k] += x[k] * x[k];
  }
  Mean out;
  for (std::size_t k = 0; k < out.of.size(); ++k) {
    out.of[k] = sums[k] / n;
    out.error[k] = std::sqrt(std::max(0.0, squares[k] / n - out.of[k] * out.of[k]) / (n - 1));
  }
  return out;
}

/// Of the lit pixels, that the design leaves to be undecided (docs/bench/decode.md): a value that moves fewer is none
/// to be exact about.
inline constexpr double kUndecidedPct = 1;

/// Whether figures are as near to those of the configuration as it is as those of other bursts of the same kind would
/// be: within two standard errors. Where all bursts agree, so must the figures.
inline bool near(const Mean& figures, const Mean& as_is) {
  bool all = true;
  for (std::size_t k = 0; k < as_is.of.size(); ++k) {
    const bool may_be_undecided = k == 0 && as_is.error[k] > 0;
    const double slack = std::max(2 * as_is.error[k], may_be_undecided ? kUndecidedPct : 1e-9);
    all = all && std::abs(figures.of[k] - as_is.of[k]) <= slack;
  }
  return all;
}

/// Every member by 0.7 and by 1.3 leaves the figures near, the controls by their own factors do not.
inline void expect_no_laws(const std::string& group, const Judge& judge, const std::vector<Member>& members,
                           const std::vector<std::pair<Member, double>>& controls) {
  const auto line = [&](const std::string& name, double by, const std::array<double, 3>& x) {
    fmt::print("{:12} {:36} {:>6.2f} {:9.3f} {:9.4f} {:9.3f}\n", group, name, by, x[0], x[1], x[2]);
  };
  const auto scaled = [&](const Member& member, double by) {
    DecodeConfig config;
    member.scale(config, by);
    const Mean m = mean_of(judge(config));
    line(member.name, by, m.of);
    return m;
  };
  const Mean as_is = mean_of(judge({}));
  fmt::print("{:12} {:36} {:>6} {:>9} {:>9} {:>9}\n", "group", "member", "times", "placed %", "wrong %", "error");
  line("as it is", 1, as_is.of);
  line("  two standard errors", 1, {2 * as_is.error[0], 2 * as_is.error[1], 2 * as_is.error[2]});
  for (const Member& member : members) {
    for (const double by : {0.7, 1.3})
      EXPECT_TRUE(near(scaled(member, by), as_is)) << group << ": " << member.name << " times " << by;
  }
  for (const auto& [member, by] : controls)
    EXPECT_FALSE(near(scaled(member, by), as_is)) << group << ", control: " << member.name << " times " << by;
}

}  // namespace enamel::test

/// The member of a configuration, for times() and its like.
#define ENAMEL_MEMBER(path) \
#path, [](enamel::pipeline::DecodeConfig & c) -> auto& { return c.path; }
