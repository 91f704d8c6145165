#include "common/files/evaluation_settings.h"

#include "common/base/errors.h"

namespace mortise::parametric {

absl::Status CheckMeshSettings(const v1::MeshSettings& settings) {
  if (settings.element_size() < 0) {
    return InvalidField("mesh.element_size", "must be positive, or 0 for the default");
  }
  const double error = settings.relative_error();
  if (error != 0 && !(error >= 0.001 && error <= 1)) {
    return InvalidField("mesh.relative_error", "must be within 0.001 to 1, or 0 for no refinement");
  }
  const double scale = settings.size_scale();
  if (scale != 0 && !(scale >= 0.5 && scale <= 2)) {
    return InvalidField("mesh.size_scale", "must be within 0.5 to 2, or 0 for 1");
  }
  return absl::OkStatus();
}

absl::StatusOr<Airflow> ReadAirflow(const v1::AirflowSettings& settings) {
  Airflow airflow;
  if (settings.has_wind()) {
    airflow.wind = {settings.wind().x(), settings.wind().y(), settings.wind().z()};
  }
  if (settings.temperature() != 0) airflow.air.temperature = settings.temperature();
  if (settings.pressure() != 0) airflow.air.pressure = settings.pressure();
  if (settings.cells() != 0) airflow.cells = settings.cells();
  MORTISE_RETURN_IF_ERROR(UnderField("airflow", CheckAirflow(airflow)));
  return airflow;
}

}  // namespace mortise::parametric
