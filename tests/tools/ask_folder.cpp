// ask_folder KNOWN FIRST [ASKED [TURN]]: what finding again is worth, burst by burst and by angle. The bursts of the
// exchange folder KNOWN before burst FIRST become keyframes at their true poses; each of the others is asked for alone,
// as if nothing were known of it. ASKED: the bursts of another folder are asked for instead; where it is another
// surface, every answer is false. TURN: degrees that the camera is rolled by, or "mirror": asks for mirror images (all
// false). A tool of the tests: needs truth/poses.csv.
#include <cstdio>
#include <ctime>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/register/track/find_turned.hpp"
#include "pipeline/register/track/tracker.hpp"
#include "tests/tools/folder_truth.hpp"
#include "tests/tools/reimaged_patch.hpp"
#include "tests/unit/decode/folder_burst.hpp"

namespace {

namespace ea = enamel::pipeline;
using Poses = std::map<int, enamel::Pose>;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kFalseMm = 0.2;  // a placement that is off by more is a false one

/// Processor time, so that a busy machine does not blur the figure.
double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// One folder's bursts as patches.
struct Folder {
  explicit Folder(const std::string& folder)
      : path(folder),
        rig(*enamel::calib::load_rig(folder + "/rig.json")),
        decoder(*ea::BurstDecoder::make(rig)),
        truth(enamel::test::read_true_poses(folder)) {}
  [[nodiscard]] enamel::SurfacePatch patch(int burst) const {
    const auto frames = enamel::test::load_folder_burst(path, burst);
    if (!frames) return {};
    return decoder.decode(frames->view()).patch;
  }
  std::string path;
  enamel::calib::Rig rig;
  ea::BurstDecoder decoder;
  Poses truth;
};

struct Bin {
  int asked = 0, right = 0, wrong = 0;
  double ms = 0;
};

/// The nearest keyframe's distance at the point looked at, and the angle between its axis and the pose's.
std::array<double, 2> nearest(const ea::KeyframeStore& store, const enamel::Pose& T) {
  std::array<double, 2> out{1e9, 0};
  for (const ea::Keyframe& k : store.all()) {
    const double d = (k.T_model_cam * enamel::Vec3d(0, 0, 48) - T * enamel::Vec3d(0, 0, 48)).norm();
    if (d >= out[0]) continue;
    out = {d, kDegrees * std::acos(std::min(1.0, k.T_model_cam.linear().col(2).dot(T.linear().col(2))))};
  }
  return out;
}

int run(const Folder& known, const Folder& asked, int first, const std::string& turn) {
  const ea::TrackerConfig config;
  ea::KeyframeStore store(known.rig.camera, config.keyframes);
  for (const auto& [id, T] : known.truth) {
    if (id >= first || !store.wants(T)) continue;
    const auto patch = known.patch(id);
    store.add(patch, T, ea::view_from_patch(patch, T, known.rig.camera, config.keyframes.view_stride));
  }
  const bool own = &known == &asked && turn != "mirror";
  const double roll = turn == "mirror" ? 0 : std::stod(turn);
  const Eigen::AngleAxisd turned(roll / kDegrees, enamel::Vec3d::UnitZ());
  const Eigen::Matrix3d M =
      turn == "mirror" ? Eigen::Matrix3d(enamel::Vec3d(-1, 1, 1).asDiagonal()) : turned.toRotationMatrix();
  std::map<int, Bin> bins;
  std::uint64_t count = 0;
  for (const auto& [id, truth] : asked.truth) {
    if (own && id < first) continue;
    const auto patch = enamel::test::reimaged(asked.patch(id), asked.rig.camera, M);
    const enamel::Pose T = own ? enamel::Pose(truth * Eigen::Isometry3d(M)) : truth;
    const double before = cpu_ms();
    const auto pyramid = ea::make_pyramid(patch, config.icp);
    const enamel::Pose last = enamel::Pose::Identity();
    const auto found =
        ea::relocalise({patch, pyramid, count}, {store, last, count}, asked.rig.camera, config.icp, config.relocalise);
    const double ms = cpu_ms() - before;
    ++count;
    const auto [distance, angle] = nearest(store, T);
    Bin& bin = bins[own ? static_cast<int>(angle / 10) * 10 : 0];
    ++bin.asked;
    bin.ms += ms;
    if (!found) {
      const auto there =
          ea::weigh_found({patch, pyramid, count}, {store, last, count}, T, asked.rig.camera, config.relocalise);
      std::printf("%3d not found, %.1f mm and %.0f deg from the nearest, at the true place overlap %.2f, %.0f ms\n", id,
                  distance, angle, there.overlap, ms);
      continue;
    }
    const auto error = enamel::test::pose_error(found->icp.T_model_cam, T);
    const bool right = own && error.mm < kFalseMm;
    ++(right ? bin.right : bin.wrong);
    std::printf("%3d %s off %.3f mm %.3f deg, %d votes, overlap %.2f rms %.1f um, %.0f deg, %.0f ms\n", id,
                right ? "found" : "FALSE", error.mm, error.deg, found->inliers, found->icp.overlap,
                1e3 * found->icp.rms_mm, angle, ms);
  }
  for (const auto& [angle, bin] : bins) {
    std::printf("%2d deg and more: asked %d found %d false %d mean %.0f ms\n", angle, bin.asked, bin.right, bin.wrong,
                bin.ms / bin.asked);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc > 5) {
    std::fprintf(stderr, "usage: %s KNOWN FIRST [ASKED [TURN]]\n", argv[0]);
    return 1;
  }
  const Folder known(argv[1]);
  const std::string turn = argc == 5 ? argv[4] : "0";
  if (argc < 4 || std::string(argv[3]) == argv[1]) return run(known, known, std::stoi(argv[2]), turn);
  return run(known, Folder(argv[3]), std::stoi(argv[2]), turn);
}
