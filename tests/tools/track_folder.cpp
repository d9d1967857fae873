// track_folder FOLDER OUT [D]: decodes an exchange folder, registers each burst to the model of
// D bursts before (default 2), fuses, writes OUT/poses.csv and OUT/mesh.ply for the yardstick.
// Where the folder has truth/poses.csv, says how far each pose is off, both laid on each other at the first placed
// burst. A tool of the tests: the algorithms alone, on one thread, without graph or recording.
#include <cstdio>
#include <ctime>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/model/fuse/tsdf_model.hpp"
#include "pipeline/model/mesh/incremental_mesher.hpp"
#include "pipeline/register/track/tracker.hpp"
#include "tests/tools/folder_truth.hpp"
#include "tests/unit/decode/folder_burst.hpp"

namespace {

namespace ea = enamel::pipeline;

struct Row {
  int id = 0;
  enamel::DeviceTime t_mid;
};

/// Mid-burst: between the start of frame 0 and the end of frame 3.
std::vector<Row> read_rows(const std::string& folder) {
  std::vector<Row> rows;
  std::ifstream in(folder + "/bursts.csv");
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::array<std::int64_t, 6> value{};
    char comma = 0;
    for (auto& v : value) fields >> v >> comma;
    rows.push_back({static_cast<int>(value[0]), enamel::device_time((value[1] + value[4] + value[5] * 1000) / 2)});
  }
  return rows;
}

void write_pose(std::ostream& out, const Row& row, const enamel::Pose& T) {
  const Eigen::Quaterniond q(T.linear());
  const auto& t = T.translation();
  out << row.id << ',' << enamel::to_ns(row.t_mid) << std::setprecision(12);
  for (const double v : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) out << ',' << v;
  out << '\n';
}

void write_ply(const enamel::Mesh& mesh, const std::string& path) {
  std::ofstream out(path);
  out << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n"
      << std::setprecision(9);
  for (const auto& v : mesh.vertices) out << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& t : mesh.triangles) out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
}

/// Processor time, so that a busy machine does not blur the figure.
double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Errors of poses whose model frame is laid on the true one where the first of them is.
class Judge {
 public:
  explicit Judge(const std::string& folder) : truth_(enamel::test::read_true_poses(folder)) {}
  void print(int burst, const enamel::Pose& T_model_cam) {
    const auto truth = truth_.find(burst);
    if (truth == truth_.end()) return;
    if (!placed_) T_truth_model_ = truth->second * T_model_cam.inverse();
    placed_ = true;
    const auto error = enamel::test::pose_error(T_truth_model_ * T_model_cam, truth->second);
    std::printf(" off %.3f mm %.3f deg", error.mm, error.deg);
  }

 private:
  std::map<int, enamel::Pose> truth_;
  enamel::Pose T_truth_model_ = enamel::Pose::Identity();
  bool placed_ = false;
};

int run(const std::string& folder, const std::string& out, std::size_t delay) {
  const auto rig = enamel::calib::load_rig(folder + "/rig.json");
  if (!rig) return std::fprintf(stderr, "%s\n", rig.error().message().c_str()), 2;
  const auto decoder = ea::BurstDecoder::make(*rig);
  if (!decoder) return std::fprintf(stderr, "%s\n", decoder.error().message().c_str()), 2;
  std::filesystem::create_directories(out);
  std::ofstream poses(out + "/poses.csv");
  poses << "burst_id,t_ns,tx,ty,tz,qx,qy,qz,qw\n";
  ea::Tracker tracker(*rig, {});
  ea::TsdfModel model(*rig);
  Judge judge(folder);
  std::deque<enamel::ModelView> views(delay);  // front: the model as it was `delay` bursts ago
  const std::array<const char*, 4> names{"started", "tracking", "relocalised", "lost"};
  for (const Row& row : read_rows(folder)) {
    const auto frames = enamel::test::load_folder_burst(folder, row.id);
    if (!frames) return std::fprintf(stderr, "burst %d: frames missing\n", row.id), 2;
    const auto decoded = decoder->decode(frames->view());
    const enamel::BurstId id{static_cast<std::uint64_t>(row.id)};
    const double before = cpu_ms();
    const auto result = tracker.track(id, row.t_mid, decoded.patch, views.front());
    const double track_ms = cpu_ms() - before;
    views.pop_front();
    const bool placed = result.state != enamel::TrackState::kLost && result.segment == enamel::kModelSegment;
    if (placed) {
      (void)model.integrate(id, decoded.patch, result.T_model_cam);
      write_pose(poses, row, result.T_model_cam);
    }
    views.push_back(placed || views.empty() ? model.view(result.T_model_cam, decoded.patch) : views.back());
    std::printf("%3d %-11s rms %5.1f um overlap %.3f iterations %2d track %5.1f ms valid %zu", row.id,
                names[static_cast<std::size_t>(result.state)], 1e3 * result.rms_mm, result.overlap, result.iterations,
                track_ms, decoded.patch.valid_px);
    if (placed) judge.print(row.id, result.T_model_cam);
    std::printf("\n");
  }
  ea::IncrementalMesher mesher;
  (void)mesher.update(model, model.take_changed(0.0));
  write_ply(mesher.extract(), out + "/mesh.ply");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: %s FOLDER OUT [DELAY]\n", argv[0]);
    return 1;
  }
  const std::size_t delay = argc == 4 ? std::stoul(argv[3]) : 2;
  return run(argv[1], argv[2], std::max<std::size_t>(delay, 1));
}
