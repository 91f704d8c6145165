// Probes along the axes, then places between them.
#include "services/retrieval/cover/tangent_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "common/base/errors.h"
#include "common/base/random.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTight = 0.9;       // of δ: what radii are measured for
constexpr int kProbeRounds = 4;      // evaluations along one axis, one way
constexpr double kNearEnough = 0.5;  // of the tight distance: a probe that needs no further one
constexpr double kMaxLeap = 4;       // from one probe to the next
constexpr double kMinMargin = 0.97;  // of the place where a parabola says that d is 0.9 δ
constexpr int kShrinkRounds = 6;
constexpr double kMaxShrink = 0.6;
constexpr double kMinShrink = 0.95;
constexpr int kPlacesPerAxis = 4;

// One way along one axis, and how far the ellipsoid may go there.
struct Probe {
  Index axis = 0;
  double sign = 1;
  Way way = {};
  double at = 0;     // of way.length: where it looks next
  double reach = 0;  // what has been found out
  bool done = false;
  bool cut = false;  // something beyond way.length cannot be evaluated
};

// What a probe makes of the foot (a distance along the axis) and the distance from it.
void Learn(double foot, double distance, double tight, bool last, Probe* probe) {
  const bool at_end = probe->at >= probe->way.length;
  if (foot <= 0 || distance > tight) {
    const double part = foot <= 0 ? 0.5 : std::max(0.1, kMinMargin * std::sqrt(tight / distance));
    if (foot > 0 && last) probe->reach = part * foot;
    probe->at *= part;
    probe->done = last;
    return;
  }
  const double beside = std::sqrt(tight * tight - distance * distance);
  if (at_end) {
    probe->reach = foot + beside;
    probe->done = true;
    return;
  }
  const double ahead = distance > 0 ? kMinMargin * std::sqrt(tight / distance) : kMaxLeap;
  probe->reach = foot * std::clamp(ahead, 1.0, 1.2);
  probe->done = last || distance >= kNearEnough * tight;
  probe->at = std::min(probe->way.length, probe->at * std::clamp(ahead, 1.0, kMaxLeap));
}

class Fit {
 public:
  Fit(ParallelEvaluator& evaluator, const TangentFrame& frame, Index axes, const TangentSite& site)
      : evaluator_(evaluator),
        frame_(frame),
        site_(site),
        axes_(frame.basis().leftCols(axes)),
        tight_(kTight * site.delta) {}

  absl::StatusOr<VectorXd> Radii() {
    MORTISE_RETURN_IF_ERROR(StartProbes());
    for (int round = 1; round <= kProbeRounds; ++round) ProbeOnce(round == kProbeRounds);
    VectorXd radii = VectorXd::Constant(axes_.cols(), std::numeric_limits<double>::infinity());
    for (const Probe& probe : probes_) {
      radii[probe.axis] = std::min(radii[probe.axis], std::max(site_.delta, probe.reach));
    }
    if (axes_.cols() > 1) MORTISE_RETURN_IF_ERROR(ShrinkBetween(&radii));
    return radii;
  }

 private:
  // A place of the ellipsoid, and the point of the manifold that may be nearest.
  struct Place {
    VectorXd target;  // N
    VectorXd change;  // K, of q
    double distance = std::numeric_limits<double>::infinity();
  };

  VectorXd Padded(const VectorXd& move) const {
    VectorXd padded = VectorXd::Zero(frame_.rank());
    padded.head(move.size()) = move;
    return padded;
  }

  absl::Status StartProbes() {
    for (Index axis = 0; axis < axes_.cols(); ++axis) {
      for (const double sign : {1.0, -1.0}) {
        Probe probe{.axis = axis, .sign = sign};
        MORTISE_ASSIGN_OR_RETURN(probe.way,
                                 frame_.WayAlong(sign * VectorXd::Unit(frame_.rank(), axis)));
        probe.at = std::min(probe.way.length, frame_.curvature_radii()[axis]);
        probe.done = !(probe.way.length > 0) || !std::isfinite(probe.way.length);
        probes_.push_back(std::move(probe));
      }
    }
    return absl::OkStatus();
  }

  // The manifold's point where q has gone by `change`; nothing if there is none of this structure.
  std::vector<std::optional<VectorXd>> Offsets(const std::vector<VectorXd>& changes) {
    std::vector<VectorXd> points;
    for (const VectorXd& change : changes) points.emplace_back(site_.parameters + change);
    const auto values = evaluator_.Evaluate(points);
    std::vector<std::optional<VectorXd>> offsets(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (values[i].ok() && evaluator_.manifold().Structure(points[i]) == site_.structure) {
        offsets[i] = *values[i] - site_.value;
      }
    }
    return offsets;
  }

  void ProbeOnce(bool last) {
    std::vector<VectorXd> changes;
    for (const Probe& probe : probes_) {
      if (!probe.done) changes.emplace_back(probe.at / probe.way.length * probe.way.change);
    }
    const auto offsets = Offsets(changes);
    std::size_t next = 0;
    for (Probe& probe : probes_) {
      if (probe.done) continue;
      const std::optional<VectorXd>& offset = offsets[next++];
      if (!offset) {
        CutAt(probe.at / 2, last, &probe);
        continue;
      }
      const VectorXd feet = frame_.basis().transpose() * *offset;
      const double distance = std::sqrt(std::max(0.0, offset->squaredNorm() - feet.squaredNorm()));
      Learn(probe.sign * feet[probe.axis], distance, tight_, last, &probe);
    }
  }

  // Looks no further than `length` along a probe's way.
  static void CutAt(double length, bool last, Probe* probe) {
    probe->way.change *= length / probe->way.length;
    probe->way.length = length;
    probe->at = length;
    probe->done = last;
  }

  absl::Status ShrinkBetween(VectorXd* radii) {
    Random random(site_.seed);
    std::vector<VectorXd> directions;
    for (Index i = 0; i < kPlacesPerAxis * radii->size(); ++i) {
      directions.push_back(random.UnitVector(radii->size()));
    }
    for (int round = 0; round < kShrinkRounds; ++round) {
      MORTISE_ASSIGN_OR_RETURN(const double worst, FurthestPlace(directions, *radii));
      if (worst <= site_.delta) return absl::OkStatus();
      const double part = std::clamp(std::sqrt(tight_ / worst), kMaxShrink, kMinShrink);
      *radii = (part * *radii).cwiseMax(site_.delta);
    }
    radii->setConstant(site_.delta);
    return absl::OkStatus();
  }

  // The largest distance of the ellipsoid's places in these directions from the manifold.
  absl::StatusOr<double> FurthestPlace(const std::vector<VectorXd>& directions,
                                       const VectorXd& radii) {
    std::vector<Place> places;
    for (const VectorXd& direction : directions) {
      const VectorXd move = Padded(radii.cwiseProduct(direction));
      MORTISE_ASSIGN_OR_RETURN(const Way way, frame_.WayAlong(move));
      const double part = way.length > move.norm() ? move.norm() / way.length : 1;
      places.push_back({frame_.basis() * move, part * way.change});
    }
    CompareWithManifold(true, &places);
    CompareWithManifold(false, &places);
    double worst = 0;
    for (const Place& place : places) worst = std::max(worst, place.distance);
    return worst;
  }

  // Evaluates the manifold for each place that is not near enough yet, and takes a Newton step
  // towards it if there is to be another round.
  void CompareWithManifold(bool step, std::vector<Place>* places) {
    std::vector<Place*> open;
    std::vector<VectorXd> changes;
    for (Place& place : *places) {
      if (place.distance <= site_.delta) continue;
      open.push_back(&place);
      changes.push_back(place.change);
    }
    const auto offsets = Offsets(changes);
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (!offsets[i]) continue;
      const VectorXd gap = open[i]->target - *offsets[i];
      open[i]->distance = std::min(open[i]->distance, gap.norm());
      if (!step) continue;
      const auto change = frame_.StepFrom(open[i]->change, frame_.basis().transpose() * gap);
      if (change.ok()) open[i]->change += *change;
    }
  }

  ParallelEvaluator& evaluator_;
  const TangentFrame& frame_;
  const TangentSite& site_;
  MatrixXd axes_;  // N × m
  double tight_;
  std::vector<Probe> probes_;
};

}  // namespace

absl::StatusOr<Primitive> FitTangent(ParallelEvaluator& evaluator, const TangentFrame& frame,
                                     Index axes, const TangentSite& site) {
  Fit fit(evaluator, frame, axes, site);
  MORTISE_ASSIGN_OR_RETURN(const VectorXd radii, fit.Radii());
  std::vector<Index> order(static_cast<std::size_t>(axes));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return radii[a] > radii[b]; });
  Primitive primitive{.parameters = site.parameters,
                      .center = site.value,
                      .axes = MatrixXd(site.value.size(), axes),
                      .radii = VectorXd(axes),
                      .structure = site.structure};
  for (Index i = 0; i < axes; ++i) {
    const Index from = order[static_cast<std::size_t>(i)];
    primitive.axes.col(i) = frame.basis().col(from);
    primitive.radii[i] = radii[from];
  }
  return primitive;
}

void KeepAxes(Index axes, Primitive* primitive) {
  primitive->axes.conservativeResize(Eigen::NoChange, axes);
  primitive->radii.conservativeResize(axes);
}

}  // namespace mortise::retrieval
