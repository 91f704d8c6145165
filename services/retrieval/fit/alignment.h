// The geometric part of a fit: iterated closest points, from points to planes (Chen and Medioni
// 1992; for parameters of templates Nan et al. 2012), over parameters and pose together.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold.h"
#include "services/retrieval/fit/family_member.h"
#include "services/retrieval/fit/mesh_points.h"
#include "services/retrieval/fit/oriented_points.h"
#include "services/retrieval/fit/query_points.h"
#include "services/retrieval/fit/upright_pose.h"

namespace mortise::retrieval {

// Points of a query, ready to be searched.
class QuerySearch {
 public:
  explicit QuerySearch(QueryPoints points);

  const QueryPoints& points() const { return points_; }

  // Returns the point that is nearest to a place and faces the same way, or may face either, all in
  // the query's frame.
  Eigen::Index Find(const Eigen::Vector3d& place, const Eigen::Vector3d& normal) const;

 private:
  QueryPoints points_;
  std::vector<Eigen::Index> numbers_;  // of the tree's points
  std::optional<OrientedPoints> tree_;
};

// What is sought.
struct Placement {
  Eigen::VectorXd q;  // K
  UprightPose pose;
};

struct AlignmentOptions {
  bool scale_is_free = false;
  Eigen::Index design_points = 3000;
  double part_of_design = 0.3;  // how much the way from design to query counts
};

struct AlignmentStep {
  double reach = 1;        // m: what is further off hardly counts (Geman and McClure's loss)
  double damping = 1e-8;   // of the largest diagonal entry, each unknown in parts of its extent
  double alike = 0.3;      // cosine that the normals of what belongs together have at least
  bool stretched = false;  // finds what belongs together in one box, as when sizes are quite wrong
};

// What a step did.
struct AlignmentChange {
  double largest = 0;  // change of an unknown, in parts of its extent
  // K + 5: standard deviations that noise in the query leaves the unknowns, as UnknownsOf has them.
  Eigen::VectorXd deviations;
};

// Returns the parameters, the turn, the translation and the logarithm of the scale: K + 5.
Eigen::VectorXd UnknownsOf(const Placement& placement);

// Steps of a fit to a family near one of its members, to first order.
class Alignment {
 public:
  // Both outlive it.
  Alignment(const QuerySearch& query, const FamilyMember& member, AlignmentOptions options)
      : query_(query), member_(member), options_(options) {}

  // Finds for each point of the query a triangle of the design that faces the same way, and for
  // points of the design such points of the query, and moves parameters, within the constraints,
  // and pose to where the planes are nearest, in least squares that what is far off has no part in.
  // INTERNAL as ConstrainedStep.
  absl::StatusOr<AlignmentChange> Step(const AlignmentStep& step,
                                       const LinearConstraints& constraints,
                                       const Eigen::VectorXd& ranges, Placement* placement) const;

 private:
  const QuerySearch& query_;
  const FamilyMember& member_;
  const AlignmentOptions options_;
};

}  // namespace mortise::retrieval
