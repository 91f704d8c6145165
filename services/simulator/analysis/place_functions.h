// The functions of faces, points and parts that custom metrics can use, on a design that is
// analysed: areas, centroids, displacements, stresses, reactions, temperatures.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/metric_expressions.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

// A point, a part as a whole, or a face of a part.
struct MetricPlace {
  std::optional<Eigen::Vector3d> point;  // m
  std::optional<int> part = {};          // index
  mesh::NamedFace face = {};             // where there is neither
};

// Whether a function tells how the stress is spread over a volume, for which each load case needs
// its spread.
bool IsOfSpread(const parametric::MetricCall& call);

// Returns what metrics call a face: "cap" of a design of one part, else "seat/z_max".
std::string FaceText(const mesh::AssemblySurface& surface, const mesh::NamedFace& face);

// Returns the face that the condition of this name acts on, else a face, "cap" of a design of one
// part, or "seat/z_max" of a part; nothing if there is none.
std::optional<mesh::NamedFace> FindFace(const DesignModel& model, const std::string& name);

// Returns the index of the part of this name; nothing if there is none.
std::optional<int> FindPart(const mesh::AssemblySurface& surface, const std::string& name);

class PlaceFunctions {
 public:
  // All must outlive it. `parameters`: of the points among `own`.
  PlaceFunctions(const parametric::MetricExpressions& own, const Eigen::VectorXd& parameters,
                 const DesignModel& model, const DesignAnalysis& analysis);

  // Returns the point of this name among `own`, else the face that FindFace finds. INVALID_ARGUMENT
  // with names that there are.
  absl::StatusOr<MetricPlace> Find(const std::string& name) const;

  // Returns the first place of a call, which may be a part where its function takes one; a point or
  // a face of the same name goes before it. Fails as Find, or where the function takes another kind
  // of place.
  absl::StatusOr<MetricPlace> PlaceOf(const parametric::MetricCall& call) const;

  // Returns the value of a function of places; what its source says (metric_function.h) must have
  // been computed, and for IsOfSpread the spread of each load case. Means and sums over faces are
  // integrals, also of the stress that is recovered at their nodes; largest and smallest values are
  // those at nodes. INVALID_ARGUMENT for an unknown place or load case, a point where a face must
  // be, or one outside of the body.
  absl::StatusOr<double> Value(const parametric::MetricCall& call) const;

 private:
  absl::StatusOr<Eigen::Vector3d> PositionOf(const std::string& name) const;
  absl::StatusOr<double> OfShape(const parametric::MetricCall& call) const;
  absl::StatusOr<double> UnderLoads(const parametric::MetricCall& call) const;
  absl::StatusOr<double> InCase(const parametric::MetricCall& call, const MetricPlace& place,
                                const SolvedCase& solved) const;
  absl::StatusOr<double> Displacement(const parametric::MetricCall& call, const MetricPlace& place,
                                      const ElasticitySolution& solution) const;
  absl::StatusOr<double> Stress(const parametric::MetricCall& call, const MetricPlace& place,
                                const SolvedCase& solved) const;
  absl::StatusOr<double> OfHeat(const parametric::MetricCall& call) const;
  double Dissipation(const mesh::NamedFace& face) const;

  const parametric::MetricExpressions& own_;
  const Eigen::VectorXd& parameters_;
  const DesignModel& model_;
  const DesignAnalysis& analysis_;
};

}  // namespace mortise::simulator
