#include "host/session/artefact_file.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "calib/model/json_object.hpp"
#include "protocol/base/file.hpp"

namespace enamel::host {
namespace {

using Json = nlohmann::json;
using pipeline::KnownArtefact;

auto refusal(const std::string& what) { return fail(ErrorCode::kArtefactFile, what); }

/// The list under a key, or a fault that names it.
Result<Json> list_of(const Json& json, const char* key) {
  const auto it = json.find(key);
  if (it == json.end() || !it->is_array()) return refusal(std::string("key '") + key + "' must be a list");
  return *it;
}

bool is_index(const Json& value) { return value.is_number_unsigned(); }
bool is_finite(const Json& value) { return value.is_number() && std::isfinite(value.get<double>()); }

}  // namespace

Result<KnownArtefact> parse_artefact(std::string_view text) {
  ENAMEL_TRY_ASSIGN(const auto json, calib::parse_json_object(text, ErrorCode::kArtefactFile));
  ENAMEL_TRY_ASSIGN(const Json spheres, list_of(json, "spheres"));
  ENAMEL_TRY_ASSIGN(const Json distances, list_of(json, "distances_mm"));
  KnownArtefact out;
  for (const Json& sphere : spheres) {
    if (!sphere.is_object() || !sphere.contains("d_mm") || !is_finite(sphere["d_mm"]))
      return refusal("sphere " + std::to_string(out.diameters_mm.size()) + " needs 'd_mm', its diameter");
    out.diameters_mm.push_back(sphere["d_mm"].get<double>());
  }
  for (const Json& d : distances) {
    if (!d.is_array() || d.size() != 4 || !is_index(d[0]) || !is_index(d[1]) || !is_finite(d[2]) || !is_finite(d[3]))
      return refusal("distance " + std::to_string(out.distances.size()) + " must be [sphere, sphere, mm, sigma in mm]");
    out.distances.push_back({d[0].get<std::size_t>(), d[1].get<std::size_t>(), d[2].get<double>(), d[3].get<double>()});
  }
  if (const std::string fault = pipeline::fault_of(out); !fault.empty()) return refusal(fault);
  return out;
}

Result<KnownArtefact> load_artefact(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  auto artefact = parse_artefact(text);
  if (!artefact) return fail(artefact.error().code, path + ": " + artefact.error().detail);
  return artefact;
}

}  // namespace enamel::host
