// enamel config: the resolved configuration, as TOML that reads back the same. config/default.toml is its output.
#include <cstdio>
#include <memory>

#include "host/app/command.hpp"
#include "host/app/run_options.hpp"

namespace enamel::app {

Run add_config(CLI::App& app) {
  auto o = std::make_shared<RunOptions>();
  app.add_option("--config", o->config_file, "configuration (TOML) over the defaults");
  app.add_option("--set", o->settings, "stage.key=value")->allow_extra_args(false);
  return [o]() -> Result<int> {
    ENAMEL_TRY_ASSIGN(const LoadedConfig config, load_config(*o));
    std::fputs(config.text.c_str(), stdout);
    return 0;
  };
}

}  // namespace enamel::app
