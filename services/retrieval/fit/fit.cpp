#include "services/retrieval/fit/fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/retrieval/fit/descriptor_fit.h"

namespace mortise::retrieval {

using Eigen::AlignedBox3d;
using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// In a frame with the middle of the query's box at the origin.
struct FitQuery::Prepared {
  Prepared(const mesh::SurfaceMesh& surface, QueryPoints all, Index glance_points,
           Index coarse_points, const Vector3d& middle_in)
      : middle(middle_in),
        glance(EvenPart(all, glance_points)),
        coarse(EvenPart(all, coarse_points)),
        fine(std::move(all)),
        distances(surface) {}

  Vector3d middle;     // of the query, in its own frame
  QueryPoints glance;  // few, to choose starts by
  QuerySearch coarse;  // some
  QuerySearch fine;    // many
  SurfaceDistances distances;
};

namespace {

constexpr Index kGlancePoints = 300;
constexpr Index kCoarsePoints = 700;
constexpr Index kFinePoints = 5000;
constexpr Index kScorePoints = 500;
constexpr std::uint64_t kSeed = 11;
constexpr int kQuarterTurns = 4;
constexpr double kFirstReach = 0.3;  // of the diagonal: what is further off hardly counts at first
constexpr double kMinReach = 0.004;  // of the diagonal: and in the end, without noise
constexpr double kReachOfNoise = 3;  // deviations, with noise
constexpr double kShrink = 0.75;     // of the reach, from step to step
constexpr double kTrust = 0.35;      // of each range, in one step
constexpr int kCoarseRounds = 6;
constexpr int kStepsOfRound = 4;
constexpr double kAlike = 0.85;         // cosine of normals, in the end
constexpr double kDoneOfNoise = 0.005;  // of the noise, in parts of the diagonal
constexpr double kDone = 1e-8;          // of the extents: a smaller change is none
// A fit has settled when a round moves no parameter by more than this of its range, and the pose by
// as little, or by no more than this of the standard deviation that noise leaves it.
constexpr double kSettled = 1e-5;
constexpr double kSettledOfNoise = 0.1;
constexpr int kShortenings = 6;  // halvings of a step to where no design is

// Finite numbers of the triangles' corners alone, about the middle.
mesh::SurfaceMesh AboutMiddle(const mesh::SurfaceMesh& surface, Vector3d* middle) {
  mesh::SurfaceMesh moved{surface.vertices, Eigen::Matrix3Xi(3, 0)};
  std::vector<Index> kept;
  AlignedBox3d box;
  for (Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = surface.vertices(Eigen::all, surface.triangles.col(t));
    if (!corners.allFinite()) continue;
    kept.push_back(t);
    for (const auto& corner : corners.colwise()) box.extend(corner);
  }
  *middle = box.isEmpty() ? Vector3d::Zero() : Vector3d(box.center());
  moved.triangles = surface.triangles(Eigen::all, kept);
  moved.vertices.colwise() -= *middle;
  return moved;
}

// A start at one turn, and how much its design looks like the query.
struct Candidate {
  std::size_t start = 0;
  VectorXd q;
  UprightPose pose;
  double difference = 0;
};

// A member, where it stands, and how far it is off.
struct Fitted {
  FamilyMember member;
  Placement placement;
  double difference = 0;
  bool converged = false;
};

// Mean of squares, none more than that of the limit.
double LimitedMean(const VectorXd& distances, double limit) {
  if (distances.size() == 0) return limit * limit;
  return distances.cwiseMin(limit).squaredNorm() / static_cast<double>(distances.size());
}

class DesignFit {
 public:
  DesignFit(const FitQuery::Prepared& query, const FitFamily& family, const FitOptions& options)
      : query_(query),
        family_(Watched(family, options)),
        options_(options),
        ranges_(family.surfaces.upper - family.surfaces.lower),
        constraints_(ConstraintsOf(family)) {}

  absl::StatusOr<FittedDesign> Run(std::vector<FitStart> starts) {
    AddByDescriptor(&starts);
    MORTISE_ASSIGN_OR_RETURN(const std::vector<Candidate> candidates, CandidatesOf(starts));
    MORTISE_ASSIGN_OR_RETURN(Fitted best, BestOf(candidates));
    const absl::Status aligned =
        Align(query_.fine, kFinePoints / 2, options_.fine_rounds, false, &best);
    if (!aligned.ok() && !absl::IsDeadlineExceeded(aligned)) return aligned;
    if (!aligned.ok()) best.converged = false;
    return Told(std::move(best));
  }

 private:
  // The family, of which no more designs are made once the fit is over.
  static FitFamily Watched(const FitFamily& family, const FitOptions& options) {
    FitFamily watched = family;
    watched.surfaces.surface = [make = family.surfaces.surface,
                                &options](const VectorXd& q) -> absl::StatusOr<mesh::SurfaceMesh> {
      MORTISE_RETURN_IF_ERROR(MayGoOn(options));
      return make(q);
    };
    return watched;
  }

  static absl::Status MayGoOn(const FitOptions& options) {
    if (options.is_given_up()) return absl::CancelledError("the fit was given up");
    if (options.is_out_of_time()) return absl::DeadlineExceededError("the fit ran out of time");
    return absl::OkStatus();
  }

  // The candidate that comes nearest, once the likeliest are aligned coarsely; of those for which
  // there is time.
  absl::StatusOr<Fitted> BestOf(const std::vector<Candidate>& candidates) {
    absl::Status failure;
    std::optional<Fitted> best;
    const auto count = std::min(candidates.size(), static_cast<std::size_t>(options_.refined));
    for (std::size_t i = 0; i < count; ++i) {
      absl::StatusOr<Fitted> fitted = Begin(candidates[i]);
      if (fitted.ok()) {
        const absl::Status aligned =
            Align(query_.coarse, kCoarsePoints, kCoarseRounds, true, &*fitted);
        if (!aligned.ok()) fitted = aligned;
      }
      if (absl::IsCancelled(fitted.status())) return fitted.status();
      if (absl::IsDeadlineExceeded(fitted.status())) {
        if (!best) return fitted.status();
        break;
      }
      if (!fitted.ok()) {
        if (failure.ok()) failure = fitted.status();
        continue;
      }
      if (!best || fitted->difference < best->difference) best = *std::move(fitted);
    }
    if (!best) return failure;
    return *std::move(best);
  }

  // One more start, from the first; none where it cannot be made, as others may.
  void AddByDescriptor(std::vector<FitStart>* starts) {
    if (options_.descriptor == nullptr || options_.descriptor_vectors.empty()) return;
    if (starts->empty() || starts->front().q.size() != ranges_.size()) return;
    const absl::StatusOr<VectorXd> first = NearestFeasible(family_, starts->front().q);
    if (!first.ok()) return;
    const absl::StatusOr<FamilyMember> member = MemberOf(0, *first);
    if (!member.ok()) return;
    absl::StatusOr<VectorXd> nearer = NearerByDescriptor(
        *options_.descriptor, options_.descriptor_vectors, family_, *member, options_.threads);
    if (nearer.ok() && *nearer != *first) starts->push_back({*std::move(nearer)});
  }

  // The member of a start, which is made once, however many turns it is aligned at.
  absl::StatusOr<FamilyMember> MemberOf(std::size_t start, const VectorXd& q) {
    const auto known = members_.find(start);
    if (known != members_.end()) return known->second;
    ++evaluations_;
    MORTISE_ASSIGN_OR_RETURN(FamilyMember member, MakeMember(family_, q, options_.threads));
    return members_.emplace(start, std::move(member)).first->second;
  }

  absl::StatusOr<std::vector<Candidate>> CandidatesOf(const std::vector<FitStart>& starts) {
    if (starts.empty()) return InvalidField("starts", "there must be one");
    std::vector<Candidate> candidates;
    absl::Status failure;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      if (starts[i].q.size() != ranges_.size() || !starts[i].q.allFinite()) {
        return InvalidField(absl::StrCat("starts[", i, "]"),
                            absl::StrCat("must have ", ranges_.size(), " finite parameters"));
      }
      MORTISE_RETURN_IF_ERROR(MayGoOn(options_));
      absl::StatusOr<VectorXd> q = NearestFeasible(family_, starts[i].q);
      const absl::StatusOr<mesh::SurfaceMesh> surface =
          q.ok() ? family_.surfaces.surface(*q) : q.status();
      if (!surface.ok()) {
        if (failure.ok()) failure = surface.status();
        continue;
      }
      ++evaluations_;
      AddCandidates(i, *q, *surface, &candidates);
    }
    if (candidates.empty()) return failure;
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.difference < b.difference; });
    return candidates;
  }

  void AddCandidates(std::size_t start, const VectorXd& q, const mesh::SurfaceMesh& surface,
                     std::vector<Candidate>* candidates) const {
    const MeshPoints samples = SampleSurface(surface, kCoarsePoints);
    const Matrix3Xd places = samples.PlacesOn(surface);
    const AlignedBox3d box = BoxAround(places);
    const OrientedPoints design(places, samples.NormalsOn(surface), 0.1 * box.diagonal().norm());
    for (int turn = 0; turn < kQuarterTurns; ++turn) {
      Candidate candidate{start, q, {.turn = turn * std::numbers::pi / 2}, 0};
      const AlignedBox3d turned = BoxAround(candidate.pose.ToDesign(query_.glance.smoothed));
      if (options_.scale_is_free) {
        candidate.pose.scale = box.diagonal().norm() / turned.diagonal().norm();
      }
      candidate.pose.translation = box.center() - candidate.pose.scale * turned.center();
      candidate.difference = GlanceAt(candidate.pose, box, design);
      candidates->push_back(std::move(candidate));
    }
  }

  // How different both are if stretched into one box, and how far they are stretched.
  double GlanceAt(const UprightPose& pose, const AlignedBox3d& box,
                  const OrientedPoints& design) const {
    const QueryPoints& glance = query_.glance;
    const Matrix3Xd places = pose.ToDesign(glance.smoothed);
    const Matrix3Xd normals = pose.Rotation() * glance.normals;
    const AlignedBox3d around = BoxAround(places);
    const double diagonal = box.diagonal().norm();
    const Vector3d flat = Vector3d::Constant(1e-6 * diagonal);
    const Vector3d factors = (box.sizes() + flat).cwiseQuotient(around.sizes() + flat);
    double sum = 0;
    for (Index i = 0; i < glance.size(); ++i) {
      const Vector3d place = factors.cwiseProduct(places.col(i) - around.center()) + box.center();
      const bool sided = glance.sided[static_cast<std::size_t>(i)];
      sum +=
          (sided ? design.Find(place, normals.col(i)) : design.FindEitherWay(place, normals.col(i)))
              .squared;
    }
    constexpr double kOfStretch = 0.02;
    return sum / static_cast<double>(glance.size()) / (diagonal * diagonal) +
           kOfStretch * factors.array().log().square().sum();
  }

  absl::StatusOr<Fitted> Begin(const Candidate& candidate) {
    MORTISE_ASSIGN_OR_RETURN(FamilyMember member, MemberOf(candidate.start, candidate.q));
    Fitted fitted{std::move(member), {candidate.q, candidate.pose}, 0, false};
    return fitted;
  }

  // Rounds of steps, each round from a member made anew.
  absl::Status Align(const QuerySearch& query, Index design_points, int rounds, bool from_afar,
                     Fitted* fitted) {
    const double diagonal = query.points().diagonal * fitted->placement.pose.scale;
    const double noise = query.points().noise * fitted->placement.pose.scale;
    const double least = std::max(kMinReach * diagonal, kReachOfNoise * noise);
    const double done = std::max(kDone, kDoneOfNoise * noise / diagonal);
    double reach = from_afar ? kFirstReach * diagonal : least;
    for (int round = 0; round < rounds; ++round) {
      MORTISE_RETURN_IF_ERROR(MayGoOn(options_));
      const Placement begun = fitted->placement;
      const Alignment alignment(
          query, fitted->member,
          {.scale_is_free = options_.scale_is_free, .design_points = design_points});
      AlignmentChange change;
      for (int i = 0; i < kStepsOfRound; ++i) {
        AlignmentStep step{.reach = reach, .damping = from_afar ? 1e-5 : 1e-9};
        if (!from_afar) step.alike = kAlike;
        step.stretched = from_afar && round == 0 && i < 2;
        if (from_afar && round == 0 && i == 0) step.damping = 1e-3;
        MORTISE_ASSIGN_OR_RETURN(
            change, alignment.Step(step, ConstraintsFrom(begun.q), ranges_, &fitted->placement));
        ++iterations_;
        reach = std::max(least, kShrink * reach);
        if (change.largest < done) break;
      }
      MoveTo(fitted);
      if (fitted->member.q == begun.q && !MayGoOn(options_).ok()) fitted->placement = begun;
      const double moved =
          (fitted->placement.q - begun.q).cwiseQuotient(ranges_).cwiseAbs().maxCoeff();
      fitted->converged =
          reach == least && HasSettled(begun, fitted->placement, diagonal, change.deviations);
      if (reach == least && moved < done && change.largest < 10 * done) break;
    }
    fitted->difference = DifferenceOf(*fitted);
    return absl::OkStatus();
  }

  // Whether a round moved nothing by more than what is next to nothing.
  bool HasSettled(const Placement& begun, const Placement& ended, double diagonal,
                  const VectorXd& deviations) const {
    VectorXd extents = VectorXd::Ones(ranges_.size() + 5);
    extents.head(ranges_.size()) = ranges_;
    extents.segment<3>(ranges_.size() + 1).setConstant(diagonal);
    const VectorXd nothing = (kSettled * extents).cwiseMax(kSettledOfNoise * deviations);
    const VectorXd moves = (UnknownsOf(ended) - UnknownsOf(begun)).cwiseAbs();
    return (moves.array() <= nothing.array()).all();
  }

  // The feasible set, as far as a step from q may go.
  LinearConstraints ConstraintsFrom(const VectorXd& q) const {
    LinearConstraints near = constraints_;
    const Index count = q.size();
    near.bounds.head(2 * count) = near.bounds.head(2 * count).cwiseMin(
        BoxConstraints(q - kTrust * ranges_, q + kTrust * ranges_).bounds);
    return near;
  }

  // Makes the member where the placement is; where none can be made, part of the way there.
  void MoveTo(Fitted* fitted) {
    VectorXd& q = fitted->placement.q;
    q = q.cwiseMax(family_.surfaces.lower).cwiseMin(family_.surfaces.upper);
    for (int i = 0; i <= kShortenings; ++i) {
      ++evaluations_;
      absl::StatusOr<FamilyMember> moved = MoveMember(family_, fitted->member, q, options_.threads);
      if (moved.ok()) {
        fitted->member = *std::move(moved);
        return;
      }
      q = (0.5 * (q + fitted->member.q)).eval();
    }
    q = fitted->member.q;
  }

  double DifferenceOf(const Fitted& fitted) const {
    const double diagonal = fitted.placement.pose.scale * query_.fine.points().diagonal;
    const double limit = 0.1 * diagonal;
    const auto [from_query, from_design] = DistancesOf(fitted, kScorePoints);
    return (LimitedMean(from_query, limit) + 0.3 * LimitedMean(from_design, limit)) /
           (diagonal * diagonal);
  }

  // From points of the query to the design, and from points of the design to the query, m.
  std::pair<VectorXd, VectorXd> DistancesOf(const Fitted& fitted, Index count) const {
    const UprightPose& pose = fitted.placement.pose;
    const SurfaceDistances design(fitted.member.surface);
    const QueryPoints some = EvenPart(query_.fine.points(), count);
    const Matrix3Xd places =
        SampleSurface(fitted.member.surface, count).PlacesOn(fitted.member.surface);
    const Matrix3Xd even = places.leftCols(std::min(count, places.cols()));
    return {design.From(pose.ToDesign(some.places)),
            pose.scale * query_.distances.From(pose.ToQuery(even))};
  }

  FittedDesign Told(Fitted fitted) const {
    FittedDesign told;
    told.q = fitted.member.q;
    told.pose = fitted.placement.pose;
    told.pose.translation -= told.pose.scale * (told.pose.Rotation() * query_.middle);
    told.pose.turn = std::remainder(told.pose.turn, 2 * std::numbers::pi);
    const auto [from_query, from_design] = DistancesOf(fitted, kFinePoints);
    told.remaining = Summarize(from_query);
    told.beyond = Summarize(from_design);
    told.iterations = iterations_;
    told.evaluations = evaluations_;
    told.converged = fitted.converged;
    told.surface = std::move(fitted.member.surface);
    return told;
  }

  const FitQuery::Prepared& query_;
  const FitFamily family_;
  const FitOptions& options_;
  const VectorXd ranges_;
  const LinearConstraints constraints_;
  std::map<std::size_t, FamilyMember> members_;  // by start
  int iterations_ = 0;
  int evaluations_ = 0;
};

}  // namespace

absl::StatusOr<FitQuery> FitQuery::Create(const mesh::SurfaceMesh& surface) {
  if (surface.triangles.cols() == 0) return InvalidField("query", "has no triangles");
  if (surface.triangles.minCoeff() < 0 || surface.triangles.maxCoeff() >= surface.vertices.cols()) {
    return InvalidField("query", "has triangles with vertices that do not exist");
  }
  Vector3d middle;
  const mesh::SurfaceMesh moved = AboutMiddle(surface, &middle);
  MORTISE_ASSIGN_OR_RETURN(QueryPoints points, MakeQueryPoints(moved, kFinePoints, kSeed));
  FitQuery query;
  query.prepared_ = std::make_shared<const Prepared>(moved, std::move(points), kGlancePoints,
                                                     kCoarsePoints, middle);
  return query;
}

absl::StatusOr<FittedDesign> FitDesign(const FitQuery& query, const FitFamily& family,
                                       const std::vector<FitStart>& starts,
                                       const FitOptions& options) {
  return DesignFit(query.prepared(), family, options).Run(starts);
}

}  // namespace mortise::retrieval
