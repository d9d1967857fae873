// enamel calibrate list, revert: the calibrations that were accepted, by probe.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "calib/io/rig_store.hpp"
#include "host/app/calibrate/subcommand.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::app {
namespace {

using Json = nlohmann::ordered_json;

struct StoreOptions {
  std::string store, serial, to;
  bool json = false;
};

calib::RigStore store_of(const StoreOptions& o) {
  return calib::RigStore(o.store.empty() ? calib::RigStore::default_folder() : o.store);
}

Result<int> run_list(const StoreOptions& o) {
  const calib::RigStore store = store_of(o);
  Json json = Json::array();
  for (const std::string& serial : o.serial.empty() ? store.serials() : std::vector<std::string>{o.serial}) {
    ENAMEL_TRY_ASSIGN(const auto stored, store.list(serial));
    for (const calib::StoredRig& rig : stored) {
      json.push_back({{"serial", serial},
                      {"id", rig.id},
                      {"calibrated_at", rig.calibrated_at},
                      {"current", rig.is_current},
                      {"path", rig.path}});
    }
  }
  if (o.json) {
    std::puts(json_text(json, 1).c_str());
    return 0;
  }
  if (json.empty()) std::printf("%s holds no calibration\n", store.folder().c_str());
  for (const auto& r : json) {
    std::printf("%s %-16s %-28s %s\n", r["current"].get<bool>() ? "*" : " ", r["serial"].get<std::string>().c_str(),
                r["id"].get<std::string>().c_str(), r["path"].get<std::string>().c_str());
  }
  return 0;
}

Result<int> run_revert(const StoreOptions& o) {
  ENAMEL_TRY_ASSIGN(const calib::StoredRig now, store_of(o).revert(o.serial, o.to));
  std::printf("%s is current: %s\n", now.id.c_str(), now.path.c_str());
  return 0;
}

void add_store(CLI::App& command, StoreOptions& o) {
  command.add_option("--store", o.store,
                     "folder of calibrations (default $ENAMEL_CALIBRATIONS, else the user's data folder)");
}

}  // namespace

CalibrateCommand add_calibrate_list(CLI::App& app) {
  auto o = std::make_shared<StoreOptions>();
  CLI::App* list = app.add_subcommand("list", "calibrations that were installed, the current one marked");
  list->add_option("SERIAL", o->serial, "only those of this probe");
  list->add_flag("--json", o->json, "one JSON array on stdout");
  add_store(*list, *o);
  return {list, [o] { return run_list(*o); }};
}

CalibrateCommand add_calibrate_revert(CLI::App& app) {
  auto o = std::make_shared<StoreOptions>();
  CLI::App* revert = app.add_subcommand("revert", "makes an earlier calibration of a probe the current one");
  revert->add_option("SERIAL", o->serial, "the probe")->required();
  revert->add_option("--to", o->to, "id of the calibration; default: the one taken before the current one");
  add_store(*revert, *o);
  return {revert, [o] { return run_revert(*o); }};
}

}  // namespace enamel::app
