// Optimises locally toward a reference point (Eq. 7.5), as ask and tell.
//
//   x_o = argmin over the box of |y(x) - z|^2 / 2,   y the scaled performance, z a reference point.
//
// This is a bounded least-squares problem whose residual r = y - z does not vanish, because z is
// meant to be out of reach. Gauss-Newton alone converges badly then: near the front the Jacobian
// loses rank (some alpha >= 0 has J^T alpha = 0), and the curvature that the residual weighs
// decides,
//
//   B = J^T J + sum_i r_i H_i.
//
// J and H_i come from least-change quadratic models of evaluations already made
// (quadratic_model.h); J is the evaluator's own where it offers gradients. A step minimises g.p +
// p.B p / 2 over the box intersected with a trust region |p|_inf <= radius (bounded_quadratic.h),
// so bounds hold exactly and one evaluation is spent per step. The radius follows the ratio of
// actual to predicted decrease. A step that fails where the known points do not span the space is
// followed by one along the direction they miss. Finite differences are made only where nothing is
// known.
//
// With constraints a step minimises the same within their quadratic models, less what these have
// lately been wrong by (constrained_quadratic.h). A design that violates constraints is first led
// to where it meets them, and none that violates any is ever preferred to one that does not.
//
// A z that turns out to be in reach was not utopian: it is moved on along its direction and the
// search continues.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "services/pareto/models/constrained_quadratic.h"
#include "services/pareto/models/quadratic_model.h"
#include "services/pareto/sources/point_source.h"

namespace mortise::pareto {

class LocalOptimization : public PointSource {
 public:
  struct Options {
    double initial_radius = 0.2;   // of the trust region, unit coordinates
    double minimal_radius = 1e-4;  // below it the search ends
    double tolerance = 1e-3;       // predicted decrease of |r| at which it ends, scaled performance
    int evaluations = 60;          // at most
    bool join = true;              // go on from whatever entry is nearest to the target, not only
                                   // from the search's own (false: explore away from the others)
    bool differences = false;      // initialise the Jacobian by D finite differences
  };

  enum class StopReason { kNone, kConverged, kStalled, kBudget, kStartFailed };

  // The goal: z, and the unit vector along which it is moved on, by `reach`, when it is in reach.
  struct Target {
    Eigen::VectorXd z;  // d, scaled performance
    Eigen::VectorXd direction;
    double reach = 0.1;
  };

  // Begin at a new design `start`, or at an evaluated one, which costs nothing.
  LocalOptimization(const Options& options, const Scaling& scaling, const Target& target,
                    const Eigen::VectorXd& start);
  LocalOptimization(const Options& options, const Scaling& scaling, const Target& target,
                    std::size_t start);

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override;
  void Tell(Archive& archive, std::size_t entry) override;
  bool Finished() const override { return stop_ != StopReason::kNone && outstanding_ == 0; }

  StopReason stop_reason() const { return stop_; }

  // Returns the best entry so far, which may violate constraints; nullopt when the start failed.
  std::optional<std::size_t> best() const { return best_; }

  int evaluations() const { return evaluations_; }

 private:
  enum class Waiting { kNothing, kStart, kDifferences, kStep, kGeometry };

  // Says how good a point is: first what it violates, then how far it is from the target.
  struct Merit {
    double violation = 0;
    double distance = 0;
  };

  Merit MeritOf(const Archive& archive, std::size_t entry) const;
  bool IsBetter(const Archive& archive, std::size_t entry, std::size_t than) const;
  std::vector<QuadraticFunction> ConstraintsAt(Archive& archive);
  void LearnMargins(const Archive& archive, std::size_t entry);
  double RatioOf(const Archive& archive, std::size_t entry) const;
  Eigen::VectorXd LeastStep(const Archive& archive) const;
  Eigen::VectorXd MostStep(const Archive& archive) const;
  Eigen::VectorXd Residual(const Archive& archive, std::size_t entry) const;
  std::optional<Eigen::VectorXd> NextPoint(Archive& archive);
  std::optional<Eigen::VectorXd> GeometryPoint(const Archive& archive,
                                               const Eigen::VectorXd& gradient);
  void JoinTheBest(const Archive& archive);
  std::optional<Eigen::VectorXd> RestoringPoint(Archive& archive);
  void QueueDifferences(const Archive& archive);
  void Judge(const Archive& archive, std::size_t entry);
  void TightenTarget(const Archive& archive);

  Options options_;
  Scaling scaling_;
  Target target_;
  Eigen::VectorXd start_;
  std::optional<std::size_t> best_;
  std::deque<Eigen::VectorXd> queue_;
  Waiting waiting_ = Waiting::kNothing;
  int outstanding_ = 0;
  int evaluations_ = 0;
  int failures_ = 0;         // steps in a row that brought nothing
  int geometry_points_ = 0;  // spent on directions that were missing
  int tightened_ = 0;
  double radius_;
  double predicted_decrease_ = 0;  // of the squared distance over 2, or of the violation
  std::vector<QuadraticFunction> constraints_;  // modelled for the step under way, with margins
  Eigen::VectorXd stepped_;                     // that step
  Eigen::VectorXd margins_;                     // m, in units of each constraint's size
  double step_length_ = 0;
  StopReason stop_ = StopReason::kNone;
};

}  // namespace mortise::pareto
