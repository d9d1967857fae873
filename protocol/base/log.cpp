#include "protocol/base/log.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <string>

#include "protocol/base/clock.hpp"

namespace enamel::log {
namespace {

constexpr std::array<std::string_view, 6> kNames = {"trace", "debug", "info", "warn", "error", "off"};
constexpr std::array<spdlog::level::level_enum, 6> kLevels = {spdlog::level::trace, spdlog::level::debug,
                                                              spdlog::level::info,  spdlog::level::warn,
                                                              spdlog::level::err,   spdlog::level::off};

spdlog::level::level_enum to_spdlog(Level level) { return kLevels.at(static_cast<std::size_t>(level)); }

struct Sink {
  Sink() : logger("enamel", std::make_shared<spdlog::sinks::stderr_sink_mt>()) {
    logger.set_pattern("%L %t %v");
    const char* wanted = std::getenv("ENAMEL_LOG");
    logger.set_level(to_spdlog(parse_level(wanted != nullptr ? wanted : "info").value_or(Level::kInfo)));
    logger.flush_on(spdlog::level::warn);
  }
  SteadyClock clock;
  HostTime start = clock.now();
  spdlog::logger logger;
};

// Never destroyed: threads and static destructors may log until the very end.
Sink& sink() {
  static Sink* const kSink = new Sink;
  return *kSink;
}

}  // namespace

Result<Level> parse_level(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames.at(i) == name) return static_cast<Level>(i);
  }
  return fail(ErrorCode::kConfigValue,
              "log level '" + std::string(name) + "' is none of trace, debug, info, warn, error, off");
}

void set_level(Level level) { sink().logger.set_level(to_spdlog(level)); }

bool enabled(Level level) { return level != Level::kOff && sink().logger.should_log(to_spdlog(level)); }

void write(Level level, std::string_view module, std::string_view text) {
  if (!enabled(level)) return;
  Sink& s = sink();
  const double seconds = std::chrono::duration<double>(s.clock.now() - s.start).count();
  s.logger.log(to_spdlog(level), "{:10.3f} [{}] {}", seconds, module, text);
}

}  // namespace enamel::log
