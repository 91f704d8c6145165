// How designs are meshed and what air flows around them, as flags give it.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "cli/client/command_flags.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::cli {

struct EvaluationFlags {
  std::string element_size;   // "20mm"
  double size_scale = 0;      // times that, or its default; 0 for 1
  double relative_error = 0;  // 0 for no refinement
  bool linear = false;        // tetrahedra of 4 nodes
  std::string wind;           // "-10, 0, 0", m/s
  int air_cells = 0;          // 0 for the default

  // Returns whether any was given.
  bool any() const;
};

// Declares --element-size, --size-scale, --relative-error, --linear, --wind and --air-cells. They
// give the fields `mesh` and `airflow` of what has the path `parent` in the request
// ("specification."). `wind` is the help of --wind.
void AddEvaluationFlags(CommandFlags& flags, EvaluationFlags& options, const std::string& parent,
                        const std::string& wind);

// INVALID_ARGUMENT naming "--element-size".
absl::StatusOr<v1::MeshSettings> MeshOf(const EvaluationFlags& flags);

// Returns nothing where no flag speaks of the air. INVALID_ARGUMENT naming "--wind".
absl::StatusOr<std::optional<v1::AirflowSettings>> AirflowOf(const EvaluationFlags& flags);

}  // namespace mortise::cli
