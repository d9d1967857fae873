// Programs with subcommands: a table of them, and the one that a command line names.
#pragma once

#include <CLI/CLI.hpp>
#include <span>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

namespace enamel {

/// `add` gives the subcommand its options and returns what to run when it was named.
template <class Run>
struct Subcommand {
  const char* name;
  const char* what;
  Run (*add)(CLI::App&);
};

/// What to run, or the exit code when the parser has said all there is to say: 0 after help, else `usage_code`.
template <class Run>
[[nodiscard]] tl::expected<Run, int> parse_subcommand(CLI::App& app, std::span<const Subcommand<Run>> table, int argc,
                                                      const char* const* argv, int usage_code) {
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, Run>> commands;
  for (const Subcommand<Run>& command : table) {
    CLI::App* sub = app.add_subcommand(command.name, command.what);
    commands.emplace_back(sub, command.add(*sub));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return tl::unexpected(app.exit(e) == 0 ? 0 : usage_code);
  }
  for (auto& [sub, run] : commands) {
    if (sub->parsed()) return std::move(run);
  }
  return tl::unexpected(usage_code);
}

}  // namespace enamel
