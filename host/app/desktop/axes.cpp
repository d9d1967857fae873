// enamel desktop axes: looks at the two axes, homes, moves and stops them.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "host/app/desktop/open_axes.hpp"
#include "host/app/desktop/stop_by_signal.hpp"
#include "host/app/desktop/subcommand.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;
using motion::AxesAngles;
using motion::AxesPosition;
using motion::GrblAxes;

struct AxesOptions {
  std::string port;
  std::string profile;
  double within_s = 120.0;
  AxesAngles target{};
  bool json = false;
};

Json angles_json(const AxesAngles& a) {
  const auto number = [](double deg) { return std::isfinite(deg) ? Json(deg) : Json(); };
  return {{"rot_deg", number(a.rot_deg)}, {"swing_deg", number(a.swing_deg)}};
}

Json describe(const GrblAxes& axes) {
  const motion::AxesLimits l = axes.limits();
  return {{"controller", "Grbl " + axes.version()},
          {"state", motion::state_name(axes.state())},
          {"limits_deg", {{"rot", {l.rot.min_deg, l.rot.max_deg}}, {"swing", {l.swing.min_deg, l.swing.max_deg}}}}};
}

void print_text(const Json& json) {
  const auto range = [&](const char* axis) {
    const Json& r = json["limits_deg"][axis];
    return fmt::format("{} .. {} deg", r[0].get<double>(), r[1].get<double>());
  };
  std::printf("controller  %s, %s\n", json["controller"].get<std::string>().c_str(),
              json["state"].get<std::string>().c_str());
  std::printf("rotation    %s\nswing       %s\n", range("rot").c_str(), range("swing").c_str());
  for (const char* kind : {"commanded", "read"}) {
    if (!json.contains(kind)) continue;
    std::printf("%-11s rotation %.3f, swing %.3f deg\n", kind, json[kind]["rot_deg"].get<double>(),
                json[kind]["swing_deg"].get<double>());
  }
}

void add_position(Json& json, const AxesPosition& at) {
  json["commanded"] = angles_json(at.commanded);
  json["read"] = angles_json(at.read);
}

using Work = Result<void> (*)(GrblAxes& axes, const AxesOptions& o, Json& json);

Result<void> look(GrblAxes& axes, const AxesOptions&, Json& json) {
  Json settings = Json::object();
  for (const auto& [number, value] : axes.settings()) settings[fmt::format("${}", number)] = value;
  json["settings"] = settings;
  return {};
}

Result<void> home(GrblAxes& axes, const AxesOptions& o, Json& json) {
  ENAMEL_TRY(axes.home(nanoseconds(o.within_s)));
  ENAMEL_TRY_ASSIGN(const AxesPosition at, axes.position());
  add_position(json, at);
  return {};
}

Result<void> move(GrblAxes& axes, const AxesOptions& o, Json& json) {
  // Before anything moves, and not only after a minute of homing.
  ENAMEL_TRY(motion::check_target(o.target, axes.limits()));
  ENAMEL_TRY(axes.home(nanoseconds(o.within_s)));
  ENAMEL_TRY_ASSIGN(const AxesPosition at, axes.move_to(o.target, nanoseconds(o.within_s)));
  add_position(json, at);
  return {};
}

Result<void> halt(GrblAxes& axes, const AxesOptions&, Json&) { return axes.stop(); }

Result<void> run_on_axes(const AxesOptions& o, Work work, Json& json) {
  SteadyClock clock;
  ENAMEL_TRY_ASSIGN(const auto axes, open_axes(o.port, o.profile, clock));
  const StopBySignal guard(*axes);
  json = describe(*axes);
  ENAMEL_TRY(work(*axes, o, json));
  json["state"] = motion::state_name(axes->state());
  return {};
}

Result<int> run_axes(const AxesOptions& o, Work work) {
  Json json;
  const auto done = run_on_axes(o, work, json);
  if (done) {
    o.json ? static_cast<void>(std::puts(json_text(json, 1).c_str())) : print_text(json);
    return 0;
  }
  const Error& error = done.error();
  if (o.json) std::puts(json_text(Json{{"error", describe(error.code).name}, {"detail", error.detail}}, 1).c_str());
  return tl::unexpected<Error>(error);
}

CLI::App* add_common(CLI::App& app, const char* name, const char* what, AxesOptions& o) {
  CLI::App* sub = app.add_subcommand(name, what);
  sub->add_option("--port", o.port, "serial port of the controller, as /dev/ttyUSB0 or /dev/ttyACM0")->required();
  sub->add_option("--profile", o.profile, "TOML as config/desktop/grbl.toml; without it that file's values");
  sub->add_flag("--json", o.json, "one JSON object on stdout");
  return sub;
}

void add_within(CLI::App& sub, AxesOptions& o) {
  sub.add_option("--within", o.within_s, "seconds that homing, and the move, may take; the table is stopped then")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
}

}  // namespace

DesktopCommand add_desktop_axes(CLI::App& app) {
  CLI::App* axes = app.add_subcommand("axes", "the table's two axes: info home move stop");
  axes->require_subcommand(1);
  auto o = std::make_shared<AxesOptions>();
  const CLI::App* info =
      add_common(*axes, "info", "controller, limits and settings against the profile; nothing moves", *o);
  CLI::App* homing = add_common(*axes, "home", "find the switches of both axes; the table moves", *o);
  CLI::App* moving =
      add_common(*axes, "move", "home, then go to an angle and settle there; Ctrl-C stops the table", *o);
  static_cast<void>(add_common(*axes, "stop", "feed hold, then reset, of a controller that no program holds", *o));
  add_within(*homing, *o);
  add_within(*moving, *o);
  moving->add_option("--rot", o->target.rot_deg, "rotation, degrees")->required();
  moving->add_option("--swing", o->target.swing_deg, "swing, degrees")->required();
  return {axes, [o, info, homing, moving] {
            const Work work = info->parsed() ? look : homing->parsed() ? home : moving->parsed() ? move : halt;
            return run_axes(*o, work);
          }};
}

}  // namespace enamel::app
