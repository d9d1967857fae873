// A base under what was scanned, as files: what `enamel desktop scan --base` and `enamel desktop base` share.
#pragma once

#include <optional>
#include <string>

#include "calib/model/mount.hpp"
#include "host/mesh_base/close_base.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

/// From the table to the head, in the frame of a desktop scan.
[[nodiscard]] Vec3d up_of(const calib::Mount& mount);

/// Closes RUN/mesh.ply: closed.ply and closed.stl beside it, and key `base` in RUN/report.json where there is one.
/// Without `config.up` the rotation axis of the folder's recording is taken, else where the surface looks. Errors: of
/// reading and closing the mesh; kFileWrite.
[[nodiscard]] Result<host::ClosedMesh> write_base_of_run(const std::string& run, host::BaseConfig config);

}  // namespace enamel::app
