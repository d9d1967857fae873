// Header of a PLY file (Turk 1994).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::host {

enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyForm : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyForm form = PlyForm::kAscii;
  std::vector<PlyElement> elements;
};

/// Takes the header off the front of `bytes`; its lines end in LF, CRLF or CR. Errors: kMeshInvalid.
[[nodiscard]] Result<PlyHeader> take_ply_header(std::string_view& bytes);

[[nodiscard]] std::size_t size_of(PlyType type) noexcept;

}  // namespace enamel::host
