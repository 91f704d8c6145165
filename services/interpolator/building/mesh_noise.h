// How much of what an evaluator says is chance of its meshes: what differs when one design is
// evaluated on two of them.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "services/interpolator/building/design_answer.h"
#include "services/interpolator/building/shape_options.h"

namespace mortise::interpolator {

// Nothing of what was not asked for, or could not be compared.
struct MeshNoise {
  struct OfField {
    std::string name;
    std::string load_case;
    double floor = 0;  // SI unit
  };

  int evaluations = 0;                         // that were for the sake of it alone
  std::vector<std::optional<double>> metrics;  // M, SI units; may be empty
  std::optional<double> shape;                 // m
  std::vector<OfField> fields;

  // Returns that of a field, or nothing.
  std::optional<double> OfFieldNamed(const std::string& name, const std::string& load_case) const;
};

// What is to be estimated, and how.
struct MeshNoiseOptions {
  std::vector<bool> of_metrics;  // M: whether that metric's is
  bool of_shape = false;
  std::vector<std::string> of_fields;  // names
  // Evaluates a design on other meshes than the map's. Called once, on a thread of its own. Fails
  // as BuildOptions::evaluate.
  std::function<absl::StatusOr<DesignAnswer>(const Eigen::VectorXd&)> evaluate;
  // Gives the file of that answer; fails as ShapeOptions::get.
  std::function<absl::StatusOr<std::string>(const std::string& file)> get;
  // Called with what came of it, before anything else happens with it. A failure stops the build.
  std::function<absl::Status(const MeshNoise&)> keep;
  // What came of it in an earlier run of the build: then nothing is evaluated.
  std::optional<MeshNoise> known;
};

// Compares what was said of one design on the map's mesh and on another. Nothing of an answer that
// failed, and no shape that cannot be brought into the mesh of the other. `shapes`: null of maps of
// metrics alone. Fails where a file cannot be got.
absl::StatusOr<MeshNoise> CompareMeshes(const DesignAnswer& one, const DesignAnswer& other,
                                        const ShapeOptions* shapes,
                                        const MeshNoiseOptions& options);

}  // namespace mortise::interpolator
