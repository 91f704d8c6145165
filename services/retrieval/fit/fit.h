// Fits the parameters of a family to a surface: what §4.5 of the thesis leaves to be done once the
// nearest primitive is known, "existing search methods" from its parameters on.
//
//   MORTISE_ASSIGN_OR_RETURN(const FitQuery query, FitQuery::Create(surface));
//   MORTISE_ASSIGN_OR_RETURN(const FittedDesign fitted,
//                            FitDesign(query, family, {{.q = primitive.parameters}}, {}));
//
// The surface is as people have it: scanned, with noise, with holes, open, flipped, in pieces; it
// stands upright, and may be turned about the vertical by any angle. From the starts, at each of
// four quarter turns, those that look nearest are aligned coarsely, by iterated closest points from
// points to planes over parameters and pose together (alignment.h), and the best of them finely.
// What is far off, as parts that one of the two lacks, has no part in it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/fit/alignment.h"
#include "services/retrieval/fit/family_member.h"
#include "services/retrieval/fit/surface_distances.h"
#include "services/retrieval/fit/upright_pose.h"

namespace mortise::retrieval {

// A surface ready to be fitted to. Immutable; copies share what was prepared.
class FitQuery {
 public:
  // Returns the surface, z upwards, in metres where its unit is known. INVALID_ARGUMENT, "query",
  // without a triangle that has an area, or with indices of no vertex. O(T log T).
  static absl::StatusOr<FitQuery> Create(const mesh::SurfaceMesh& surface);

  struct Prepared;
  const Prepared& prepared() const { return *prepared_; }

 private:
  std::shared_ptr<const Prepared> prepared_;
};

// Where a fit begins.
struct FitStart {
  Eigen::VectorXd q;  // K
};

struct FitOptions {
  // Whether the query may be larger or smaller than the design, as where its unit is not known.
  bool scale_is_free = false;
  // The descriptor that the starts are near by, and the query's vectors by it, one for each turn:
  // the first start is improved by it, and is another start then. Not done without.
  const Descriptor* descriptor = nullptr;
  std::vector<Eigen::VectorXd> descriptor_vectors = {};
  int refined = 3;      // starts that are aligned coarsely, >= 1
  int fine_rounds = 8;  // of steps that the best of them is aligned finely in, at most, >= 1
  int threads = 1;      // for designs beside each other
  // Asked before each design that is made: true ends the fit with what it has by then.
  std::function<bool()> is_out_of_time = [] { return false; };
  // Asked now and then: true ends the fit, CANCELLED.
  std::function<bool()> is_given_up = [] { return false; };
};

struct FittedDesign {
  Eigen::VectorXd q;          // K, feasible
  UprightPose pose;           // from the query to the design
  DistanceSummary remaining;  // m, from the query's surface to the design's
  DistanceSummary beyond;     // m, from the design's surface to the query's: what that lacks
  int iterations = 0;         // steps of the alignment, of all starts together
  int evaluations = 0;        // members of the family that were made, those beside it left out
  // Whether the last round of steps moved no parameter by more than a hundred thousandth of its
  // range, or by more than a tenth of the standard deviation that noise in the query leaves it. Not
  // where the time ran out.
  bool converged = false;
  mesh::SurfaceMesh surface;  // of the design, in its own frame
};

// Returns the member of the family that comes nearest to the query from one of the starts.
// Distances are the design's metres. What the query does not show of a design keeps the value of
// its start; with a free scale that may be how large all is. Starts outside of the feasible set
// begin nearest to it. INVALID_ARGUMENT, "starts", for none or of another size than the family's
// box; the first failure of the family where it has no member at any start; DEADLINE_EXCEEDED where
// the time ran out before one start was aligned coarsely; CANCELLED. The same arguments give the
// same result on any number of threads, but for what time decides.
absl::StatusOr<FittedDesign> FitDesign(const FitQuery& query, const FitFamily& family,
                                       const std::vector<FitStart>& starts,
                                       const FitOptions& options);

}  // namespace mortise::retrieval
