// The functions of faces and points that custom metrics can use, on a design that is
// analysed: areas, centroids, displacements, reactions, temperatures.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/metric_expressions.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

// A point, or a face of a part.
struct MetricPlace {
  std::optional<Eigen::Vector3d> point;  // m
  mesh::NamedFace face;                  // where there is no point
};

// Returns what metrics call a face: "cap" of a design of one part, else "seat/z_max".
std::string FaceText(const mesh::AssemblySurface& surface, const mesh::NamedFace& face);

// Returns the face that the condition of this name acts on, else a face, "cap" of a design of one
// part, or "seat/z_max" of a part; nothing if there is none.
std::optional<mesh::NamedFace> FindFace(const DesignModel& model, const std::string& name);

class PlaceFunctions {
 public:
  // All must outlive it. `parameters`: of the points among `own`.
  PlaceFunctions(const parametric::MetricExpressions& own, const Eigen::VectorXd& parameters,
                 const DesignModel& model, const DesignAnalysis& analysis);

  // Returns the point of this name among `own`, else the face that FindFace finds. INVALID_ARGUMENT
  // with names that there are.
  absl::StatusOr<MetricPlace> Find(const std::string& name) const;

  // Returns the value of a function of places; what its source says (metric_function.h) must have
  // been computed. Means and sums over faces are integrals; largest and smallest values are those
  // at nodes. INVALID_ARGUMENT for an unknown place or load case, a point where a face must be, or
  // one outside of the body.
  absl::StatusOr<double> Value(const parametric::MetricCall& call) const;

 private:
  absl::StatusOr<Eigen::Vector3d> PositionOf(const std::string& name) const;
  absl::StatusOr<double> OfShape(const parametric::MetricCall& call) const;
  absl::StatusOr<double> UnderLoads(const parametric::MetricCall& call) const;
  absl::StatusOr<double> InCase(const parametric::MetricCall& call, const MetricPlace& place,
                                const ElasticitySolution& solution) const;
  absl::StatusOr<double> OfHeat(const parametric::MetricCall& call) const;
  double Dissipation(const mesh::NamedFace& face) const;

  const parametric::MetricExpressions& own_;
  const Eigen::VectorXd& parameters_;
  const DesignModel& model_;
  const DesignAnalysis& analysis_;
};

}  // namespace mortise::simulator
