#include "cli/files/evaluation_flags.h"

#include "cli/client/requests.h"
#include "common/base/errors.h"

namespace mortise::cli {

bool EvaluationFlags::any() const {
  return !element_size.empty() || size_scale != 0 || relative_error != 0 || linear ||
         !wind.empty() || air_cells != 0;
}

void AddEvaluationFlags(CommandFlags& flags, EvaluationFlags& options, const std::string& parent,
                        const std::string& wind) {
  flags.Add("--element-size", options.element_size, "Edge length of the tetrahedra",
            parent + "mesh.element_size");
  flags.Add("--size-scale", options.size_scale,
            "Times that length, also where none is given, 0.5 to 2: how much is chance of the mesh",
            parent + "mesh.size_scale");
  flags.Add("--relative-error", options.relative_error,
            "Refine until the estimated error is at most this, such as 0.05",
            parent + "mesh.relative_error");
  flags.command().add_flag("--linear", options.linear, "Tetrahedra of 4 nodes instead of 10");
  flags.Add("--wind", options.wind, wind, parent + "airflow.wind");
  flags.Add("--air-cells", options.air_cells,
            "About how many cells of air to compute with, 30000 if not given",
            parent + "airflow.cells");
}

absl::StatusOr<v1::MeshSettings> MeshOf(const EvaluationFlags& flags) {
  v1::MeshSettings mesh;
  if (!flags.element_size.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const double size, ParseLength(flags.element_size, "--element-size"));
    mesh.set_element_size(size);
  }
  mesh.set_size_scale(flags.size_scale);
  mesh.set_relative_error(flags.relative_error);
  mesh.set_linear(flags.linear);
  return mesh;
}

absl::StatusOr<std::optional<v1::AirflowSettings>> AirflowOf(const EvaluationFlags& flags) {
  if (flags.wind.empty() && flags.air_cells == 0) return std::optional<v1::AirflowSettings>();
  v1::AirflowSettings airflow;
  if (!flags.wind.empty()) {
    MORTISE_ASSIGN_OR_RETURN(*airflow.mutable_wind(), ParseVector(flags.wind, "--wind"));
  }
  airflow.set_cells(flags.air_cells);
  return std::optional(airflow);
}

}  // namespace mortise::cli
