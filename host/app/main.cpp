// enamel: the host's program. stdout carries results, stderr the log.
#include <malloc.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <opencv2/core/utility.hpp>
#include <string>

#include "host/app/command.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/stdout_check.hpp"
#include "protocol/base/subcommands.hpp"

namespace {

constexpr std::array<enamel::Subcommand<enamel::app::Run>, 13> kCommands{{
    {"demo", "the whole system on this machine: twin, probe, DDS, live preview, mesh, accuracy", enamel::app::add_demo},
    {"scan", "live scan of a probe on the network", enamel::app::add_scan},
    {"replay", "reprocess a recording or exchange folder: same capture, same bits", enamel::app::add_replay},
    {"decode", "one burst, every intermediate map", enamel::app::add_decode},
    {"capture", "work on recordings: import export info verify cut repair diff", enamel::app::add_capture},
    {"calibrate", "from pictures of a target to rig.json: solve check compare show list revert",
     enamel::app::add_calibrate},
    {"patterns", "a rig's four fringe pictures, to load into its projector", enamel::app::add_patterns},
    {"desktop", "the scanner that stands above a table with two axes: axes", enamel::app::add_desktop},
    {"compare", "deviation of a mesh from a reference", enamel::app::add_compare},
    {"inspect", "what is wrong with a finished scan: nine classes of defects, where, and what to do",
     enamel::app::add_inspect},
    {"export", "mesh of a session as STL, PLY or OBJ", enamel::app::add_export},
    {"config", "the resolved configuration with every key explained", enamel::app::add_config},
    {"doctor", "what is wrong with this machine and how to mend it", enamel::app::add_doctor},
}};

int run(int argc, char** argv) {
  CLI::App app("enamel: an open intraoral 3D scanner", "enamel");
  app.set_version_flag("--version", std::string(ENAMEL_VERSION));
  const auto command = enamel::parse_subcommand<enamel::app::Run>(app, kCommands, argc, argv, 1);
  if (!command) return command.error();
  const auto code = (*command)();
  if (code) return *code;
  std::fputs((code.error().message() + "\n").c_str(), stderr);
  return enamel::exit_code(code.error().code);
}

}  // namespace

int main(int argc, char** argv) {
  // A full file system or a closed pipe shall be an error value, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  // The stage graph shares the cores out; OpenCV must not take them a second time.
  cv::setNumThreads(1);
  // Maps of some megabytes come and go with every burst: keep their pages instead of handing them back each time.
  mallopt(M_MMAP_THRESHOLD, 256 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  try {
    return enamel::with_stdout_written(run(argc, argv));
  } catch (const std::exception& e) {
    // A third-party exception that no adapter stopped: our defect, told as such.
    std::fprintf(stderr, "%s\n", enamel::Error{enamel::ErrorCode::kInternal, e.what()}.message().c_str());
    return 5;
  }
}
