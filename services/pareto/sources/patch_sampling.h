// Samples adaptively the affine piece that a first-order expansion spans (§7.5.3, Storage).
//
// The thesis evaluates a whole grid on every piece, 1,001 points for d = 2, which dominates its
// cost. Here the piece is walked from its centre outwards on a lattice whose spacing is chosen so
// that one step moves the scaled performance by about `spacing`:
//   - a node is only reached from an evaluated neighbour that no known point clearly dominates, so
//     the walk stops at the first dominated stretch and at the bounds of the design space (which
//     are hit exactly);
//   - a node whose predicted performance is already covered by a known point as good is passed
//     without an evaluation; where many turn out after one to be where the front was known already,
//     as metrics stand still along the piece or the prediction is bad, the walk ends, and nothing
//     beyond is probed;
//   - for d = 2 the walk goes a few nodes ahead of what has been answered, but no more than half as
//     many as have held so far on that side: the workers need not wait for each other, and little
//     is lost where the stretch ends;
//   - for d = 2, neighbours too far apart are bisected; for d > 3, wide holes are filled first;
//   - at last a few nodes beyond are probed, up to the bounds, since a front may go on where a
//     stretch of the same piece is dominated: ZDT3's comes back four times. The walk goes on from
//     those that no known point clearly dominates.
// Where constraints hold the front they may be curved, which the piece is not. So nodes are brought
// to where the models of the constraints, at the neighbour that they were reached from, say that
// these are met. A node that violates some nevertheless is tried once more, further from them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/models/difference_model.h"
#include "services/pareto/models/first_order_expansion.h"
#include "services/pareto/models/quadratic_model.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

// The affine piece u = centre + directions t, within the unit box.
struct AffinePiece {
  std::size_t entry = 0;       // the critical design it expands from
  Eigen::VectorXd centre;      // D
  Eigen::MatrixXd directions;  // D x k, orthonormal, k <= d - 1
};

class PatchSampling : public PointSource {
 public:
  struct Options {
    double spacing = 0.05;    // wanted distance of neighbours in scaled performance
    double tolerance = 1e-2;  // delta_B: how much dominance ends a stretch, scaled performance
    int evaluations = 200;    // at most
    int probes = 0;           // beyond where the walk ended
    int ahead = 0;            // nodes asked for before their inner neighbour is known, each way
    // True if slopes and curvature that are not offered are measured by differences first, and the
    // centre is brought to where they say that it is best.
    bool measures = false;
    double measured_step = 0.02;           // of unit coordinates
    double critical_residual = 0.3;        // KKT residual up to which a design counts as critical
    double exact_critical_residual = 0.1;  // the same with exact gradients
    double difference = 1e-4;              // step of the Hessian's differences of offered gradients
  };

  PatchSampling(const Options& options, const Scaling& scaling, std::size_t entry);

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override;
  void Tell(Archive& archive, std::size_t entry) override;
  bool Finished() const override { return finished_ && asked_.empty(); }

  // Returns the piece, which is known once its first point has been asked for. It has no directions
  // where the design is not critical, or the metrics agree.
  const AffinePiece& piece() const { return piece_; }

  // Whether it looks beyond where the walk ends.
  bool probes() const { return options_.probes > 0; }

  // Returns how many evaluations went into slopes and curvature by differences.
  Eigen::Index measurements() const { return measurement_ ? measurement_->evaluations() : 0; }

 private:
  using Node = std::vector<int>;

  struct Reached {
    Node node;
    bool beyond = false;     // from a probe: nothing is known about it
    std::size_t parent = 0;  // entry of the evaluated neighbour
    bool again = false;      // it violated constraints once
  };

  // The purpose of a point that is under way.
  struct Request {
    enum class Kind { kMeasurement, kCentre, kHessian, kNode, kBisection } kind;
    Eigen::Index coordinate = 0;  // kHessian
    Reached reached = {};         // kNode
    double parameter = 0;         // t, for d = 2
    int depth = 0;                // kBisection
  };

  void Start(Archive& archive);
  bool IsCritical(const Eigen::MatrixXd& jacobian) const;
  std::optional<Eigen::VectorXd> BetterCentre() const;
  void FinishMeasurement(const Archive& archive);
  void MoveCentre(const Archive& archive, std::size_t entry);
  void FinishHessian(const Archive& archive);
  void Open(const Archive& archive);
  void RecoverDualsAt(const Archive& archive, std::size_t entry);
  Eigen::VectorXd WithinConstraints(const Archive& archive, const Eigen::VectorXd& point,
                                    std::size_t parent) const;
  void LearnMargin(const Archive& archive, std::size_t entry);
  void Expand(const Reached& from);
  std::vector<Node> WaysOut(std::size_t most) const;
  void QueueProbes();
  void EndWalk();
  std::optional<Eigen::VectorXd> AskNode(const Archive& archive);
  std::optional<Eigen::VectorXd> AskAhead(const Archive& archive);
  std::optional<Eigen::VectorXd> NodePoint(const Node& node, double* parameter) const;
  bool Covered(const Archive& archive, const Eigen::VectorXd& metrics,
               std::optional<std::size_t> but) const;
  void Keep(const Archive& archive, double parameter, std::size_t entry, int depth);

  Options options_;
  Scaling scaling_;
  AffinePiece piece_;
  bool started_ = false;
  bool finished_ = false;
  int evaluations_ = 0;
  int redundant_ = 0;  // nodes that turned out to be where the front was known already
  bool walk_over_ = false;
  std::optional<QuadraticModel> model_;
  std::optional<DifferenceModel> measurement_;
  std::optional<Eigen::VectorXd> better_centre_;  // to be asked for
  KktPoint kkt_;
  Eigen::MatrixXd constraint_hessian_;  // sum_k mu_k H_gk, D x D
  double margin_ = 0;                   // kept from constraints, each in units of its size
  Eigen::VectorXd steps_;               // lattice spacing along each direction
  std::deque<Eigen::Index> hessian_coordinates_;
  int hessian_pending_ = 0;
  std::deque<Reached> frontier_;
  // The walk each way for d = 2: the last node that held, the last asked for or passed, and whether
  // one did not hold.
  struct Walk {
    int held = 0;
    int asked = 0;
    bool ended = false;
  };
  Walk& WalkOf(const Node& node);
  std::array<Walk, 2> walks_;
  bool probed_ = false;
  std::set<Node> seen_;
  std::map<double, std::size_t> line_;  // d = 2: parameter to entry of the points kept
  struct Bisection {
    double parameter;
    int depth;
  };
  std::deque<Bisection> bisections_;
  std::deque<Request> asked_;
};

}  // namespace mortise::pareto
