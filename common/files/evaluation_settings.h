// How a request wants designs evaluated: checked and read.
#pragma once

#include "absl/status/statusor.h"
#include "common/design/airflow.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::parametric {

// Fails with INVALID_ARGUMENT naming "mesh.element_size" or "mesh.relative_error".
absl::Status CheckMeshSettings(const v1::MeshSettings& settings);

// Returns the air with defaults for what the settings leave out. INVALID_ARGUMENT naming
// "airflow.wind" and the like, as CheckAirflow.
absl::StatusOr<Airflow> ReadAirflow(const v1::AirflowSettings& settings);

}  // namespace mortise::parametric
