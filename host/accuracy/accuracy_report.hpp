// Trueness, precision and an artefact's figures for programs and for people. Pure, thread-safe.
#pragma once

#include <string>
#include <vector>

#include "host/accuracy/accuracy.hpp"
#include "host/accuracy/artefact_figures.hpp"

namespace enamel::host {

/// What was measured; empty: was not.
struct AccuracyReport {
  std::vector<std::string> runs;  ///< their names
  std::string reference;          ///< its name
  bool simulated = false;         ///< any of the runs
  std::vector<RunDeviation> trueness;
  std::vector<PairDeviation> precision;
  pipeline::KnownArtefact artefact;
  std::vector<ArtefactFigures> artefact_runs;
};

/// accuracy.json; keys in docs/desktop-accuracy.md. What was not measured is null, precision of a single run with why.
[[nodiscard]] std::string accuracy_json(const AccuracyReport& report);
/// The same as a table, um.
[[nodiscard]] std::string accuracy_text(const AccuracyReport& report);

}  // namespace enamel::host
