// What programs and people read of it.
#include "host/accuracy/accuracy_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace enamel::host {
namespace {

AccuracyReport two_runs() {
  AccuracyReport out;
  out.runs = {"a", "b"};
  out.reference = "ref.stl";
  out.trueness = {{figures_of({1, -1, 3}), 0.5}, {figures_of({2, -2, 6}), 0}};
  out.precision = {{0, 1, figures_of({1, 1}), 2}};
  out.artefact = {.diameters_mm = {8, 7}, .distances = {{0, 1, 54, 0.0025}}};
  out.artefact_runs = {
      {.balls = {{.share = 0.4}, {.share = 0.5}}, .form_um = {4, 5}, .size_um = {1, 2}, .distance_um = {3}},
      {.balls = {{.share = 0.4}, {.share = 0.5}}, .form_um = {6, 5}, .size_um = {1, 4}, .distance_um = {5}}};
  return out;
}

TEST(AccuracyReport, has_figures_by_run_and_over_runs) {
  const auto json = nlohmann::json::parse(accuracy_json(two_runs()));
  EXPECT_EQ(json["trueness"]["runs"][1]["run"], "b");
  EXPECT_NEAR(json["trueness"]["over_runs"]["mean_um"]["mean"].get<double>(), 1.5, 1e-12);
  EXPECT_NEAR(json["trueness"]["over_runs"]["mean_um"]["sd"].get<double>(), std::sqrt(0.5), 1e-12);
  EXPECT_EQ(json["precision"]["pairs"][0]["runs"][1], "b");
  EXPECT_TRUE(json["precision"]["over_pairs"]["p95_um"]["sd"].is_null());
  EXPECT_EQ(json["artefact"]["balls"][0]["form_um"]["mean"], 5);
  EXPECT_EQ(json["artefact"]["distances"][0]["error_um"]["mean"], 4);
  const std::string text = accuracy_text(two_runs());
  EXPECT_NE(text.find("distance 0-1, 54.000 mm: SD"), std::string::npos) << text;
  EXPECT_EQ(text.find("SIMULATED"), std::string::npos);
}

TEST(AccuracyReport, says_what_was_not_measured_and_what_is_simulated) {
  AccuracyReport one;
  one.runs = {"a"};
  one.simulated = true;
  const auto json = nlohmann::json::parse(accuracy_json(one));
  EXPECT_TRUE(json["trueness"].is_null());
  EXPECT_TRUE(json["artefact"].is_null());
  EXPECT_EQ(json["precision"]["why_not"], "needs two runs");
  EXPECT_EQ(json["simulated"], true);
  EXPECT_NE(accuracy_text(one).find("SIMULATED"), std::string::npos);
}

}  // namespace
}  // namespace enamel::host
