#include "host/session/model_checkpoint.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "protocol/base/bytes.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::host {
namespace {

template <class T>
void put_all(ByteWriter& out, const std::vector<T>& values) {
  out.put_bytes(std::as_bytes(std::span(values)));
}

/// Precondition: the bytes that are left hold so many, which has been checked.
template <class T>
void get_all(ByteReader& in, std::vector<T>& into, std::size_t count) {
  const auto bytes = in.take(count * sizeof(T));
  into.resize(bytes.size() / sizeof(T));
  std::ranges::copy(bytes, std::as_writable_bytes(std::span(into)).begin());
}

static_assert(sizeof(Vec3f) == 3 * sizeof(float));
constexpr std::size_t kVertexBytes = 2 * sizeof(Vec3f) + sizeof(float), kTriangleBytes = 3 * sizeof(std::uint32_t);

void put_block(ByteWriter& out, const BlockMesh& block) {
  for (const std::int32_t index : block.block) out.put(index);
  out.put(block.epoch);
  out.put(static_cast<std::uint32_t>(block.vertices.size()));
  out.put(static_cast<std::uint32_t>(block.triangles.size()));
  put_all(out, block.vertices);
  put_all(out, block.normals);
  put_all(out, block.quality);
  put_all(out, block.triangles);
  out.put(static_cast<std::uint8_t>(block.soft.empty() ? 0 : 1));
  put_all(out, block.soft);
}

/// Null where it does not add up.
std::shared_ptr<const BlockMesh> get_block(ByteReader& in) {
  auto block = std::make_shared<BlockMesh>();
  for (std::int32_t& index : block->block) index = in.get<std::int32_t>();
  block->epoch = in.get<std::uint64_t>();
  const auto vertices = in.get<std::uint32_t>(), triangles = in.get<std::uint32_t>();
  if (!in.ok() || vertices * kVertexBytes + triangles * kTriangleBytes > in.remaining()) return nullptr;
  get_all(in, block->vertices, vertices);
  get_all(in, block->normals, vertices);
  get_all(in, block->quality, vertices);
  get_all(in, block->triangles, triangles);
  const auto has_soft = in.get<std::uint8_t>();
  // One text a model: another value of the flag, or a one where nothing follows, is not as it was written.
  if (!in.ok() || has_soft > (vertices > 0 ? 1 : 0) || has_soft * vertices > in.remaining()) return nullptr;
  get_all(in, block->soft, has_soft * vertices);
  for (const auto& corners : block->triangles) {
    for (const std::uint32_t corner : corners)
      if (corner >= vertices) return nullptr;
  }
  return block;
}

}  // namespace

std::string checkpoint_path(const std::string& session_folder) { return session_folder + "/model.checkpoint"; }

std::string checkpoint_bytes(const ModelCheckpoint& checkpoint) {
  ByteWriter out;
  out.put_text(kCheckpointMagic);
  for (const double value : std::span(checkpoint.T_model_cam.data(), 16)) out.put(value);
  out.put(checkpoint.model->after_burst);
  out.put(static_cast<std::uint32_t>(checkpoint.model->blocks.size()));
  for (const auto& block : checkpoint.model->blocks) put_block(out, *block);
  out.put(crc32(out.bytes()));
  return {reinterpret_cast<const char*>(out.bytes().data()), out.size()};
}

Result<ModelCheckpoint> parse_checkpoint(std::string_view bytes) {
  const auto invalid = [](const char* why) { return fail(ErrorCode::kMeshInvalid, std::string("checkpoint: ") + why); };
  if (!bytes.starts_with(kCheckpointMagic) || bytes.size() < kCheckpointMagic.size() + sizeof(std::uint32_t))
    return invalid("another format");
  const auto body = bytes.substr(0, bytes.size() - sizeof(std::uint32_t));
  ByteReader sum(std::as_bytes(std::span(bytes.substr(body.size()))));
  if (sum.get<std::uint32_t>() != crc32(std::as_bytes(std::span(body)))) return invalid("damaged");
  ByteReader in(std::as_bytes(std::span(body.substr(kCheckpointMagic.size()))));
  ModelCheckpoint out;
  for (double& value : std::span(out.T_model_cam.data(), 16)) value = in.get<double>();
  auto model = std::make_shared<ModelSnapshot>();
  model->after_burst = in.get<std::uint64_t>();
  for (auto left = in.get<std::uint32_t>(); left > 0; --left) {
    auto block = get_block(in);
    if (!block) return invalid("its blocks do not add up");
    model->blocks.push_back(std::move(block));
  }
  if (!in.ok() || in.remaining() > 0) return invalid("its blocks do not add up");
  out.model = std::move(model);
  return out;
}

std::shared_ptr<const BurstPreview> as_preview(const ModelCheckpoint& checkpoint) {
  auto out = std::make_shared<BurstPreview>();
  out->T_model_cam = out->T_model_return = checkpoint.T_model_cam;
  out->model = checkpoint.model;
  return out;
}

CheckpointWriter::CheckpointWriter(std::string path, Nanoseconds period)
    : path_(std::move(path)), period_(period), thread_([this](const std::stop_token& stop) { run(stop); }) {}

CheckpointWriter::~CheckpointWriter() { thread_.request_stop(); }

void CheckpointWriter::offer(const BurstPreview& shown) {
  if (!shown.model || shown.segment != kModelSegment) return;
  const std::lock_guard lock(mutex_);
  newest_ = {shown.model, shown.T_model_cam};
}

void CheckpointWriter::run(const std::stop_token& stop) {
  std::shared_ptr<const ModelSnapshot> written;
  bool told = false;
  while (!stop.stop_requested()) {
    ModelCheckpoint now;
    {
      std::unique_lock lock(mutex_);
      tick_.wait_for(lock, stop, period_, [] { return false; });
      now = newest_;
    }
    if (stop.stop_requested() || !now.model || now.model == written) continue;
    const auto kept = write_file(path_, checkpoint_bytes(now), Sync::kLater);
    if (!kept && !std::exchange(told, true))
      log::warn("session", "{}; after a crash the model is not on the screen at once", kept.error().message());
    written = now.model;
  }
}

}  // namespace enamel::host
