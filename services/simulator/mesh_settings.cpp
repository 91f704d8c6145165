#include "services/simulator/mesh_settings.h"

#include "absl/strings/str_format.h"
#include "common/base/errors.h"

namespace mortise::simulator {

absl::Status CheckMeshSettings(const v1::MeshSettings& settings) {
  if (settings.element_size() < 0) {
    return InvalidField("mesh.element_size", "must be positive, or 0 for the default");
  }
  const double error = settings.relative_error();
  if (error != 0 && !(error >= 0.001 && error <= 1)) {
    return InvalidField("mesh.relative_error", "must be within 0.001 to 1, or 0 for no refinement");
  }
  return absl::OkStatus();
}

std::string RefinementText(const v1::MeshSettings& settings) {
  if (settings.relative_error() == 0) return "";
  return absl::StrFormat(" to %a", settings.relative_error());
}

}  // namespace mortise::simulator
