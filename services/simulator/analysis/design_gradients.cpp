#include "services/simulator/analysis/design_gradients.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/metric_registry.h"
#include "common/fem/elements/loads.h"
#include "common/fem/elements/shape_derivative.h"
#include "common/fem/stress/stress_derivative.h"
#include "common/fem/stress/stress_recovery.h"
#include "common/fem/stress/stress_spread.h"
#include "common/fem/stress/surface_traction.h"
#include "services/simulator/analysis/design_solver.h"
#include "services/simulator/analysis/place_displacement.h"
#include "services/simulator/analysis/place_functions.h"

namespace mortise::simulator {
namespace {

using parametric::MetricCall;

double Dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a.array() * b.array()).sum();
}

// Gradients over the velocities of one mesh.
class AdjointGradients {
 public:
  static absl::StatusOr<AdjointGradients> Create(const SolvedLoads& solved,
                                                 const DesignMotion& motion) {
    AdjointGradients gradients(solved, motion.load_rates);
    MORTISE_ASSIGN_OR_RETURN(
        gradients.velocities_,
        NodeVelocities(solved.mesh, motion.faces, static_cast<int>(motion.load_rates.size()),
                       solved.memory_limit));
    for (const DesignModel& rates : motion.load_rates) {
      std::vector<Eigen::Matrix3Xd>& of_parameter = gradients.load_rates_.emplace_back();
      for (const NamedLoadCase& named : LoadCasesOf(rates)) {
        MORTISE_ASSIGN_OR_RETURN(
            of_parameter.emplace_back(),
            AssembleLoads(solved.mesh, solved.model.analysis.materials, named.loads));
      }
    }
    return gradients;
  }

  // λᵀ f' + (fixed + d(λᵀ f)/dX − d(λᵀ K u)/dX) · V, in a load case.
  Eigen::VectorXd By(std::size_t load_case, const Eigen::Matrix3Xd& adjoint,
                     const Eigen::Matrix3Xd& by_position) const {
    const auto& materials = solved_.model.analysis.materials;
    const Eigen::Matrix3Xd factors =
        by_position + Loads(load_case, adjoint) -
        StiffnessDerivative(solved_.mesh, materials, solved_.cases[load_case].solution.displacement,
                            adjoint);
    return Along(factors) + ByLoads(load_case, adjoint);
  }

  Eigen::VectorXd Compliance(std::size_t load_case) const {
    const Eigen::Matrix3Xd& u = solved_.cases[load_case].solution.displacement;
    return By(load_case, u, Loads(load_case, u)) + ByLoads(load_case, u);
  }

  absl::StatusOr<Eigen::VectorXd> LargestDisplacement(std::size_t load_case) const {
    const ElasticitySolution& solution = solved_.cases[load_case].solution;
    const int node = solution.summary.maximum_displacement_node;
    const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, solved_.mesh.nodes.cols());
    Eigen::Matrix3Xd force = none;
    force.col(node) = solution.displacement.col(node).normalized();
    return Of(load_case, force, none);
  }

  // Gives the gradient of a number that depends on the displacements and on where nodes are.
  absl::StatusOr<Eigen::VectorXd> Of(std::size_t load_case, const Eigen::Matrix3Xd& by_displacement,
                                     const Eigen::Matrix3Xd& by_position) const {
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd adjoint,
                             solved_.system.SolveForces(by_displacement));
    return By(load_case, adjoint, by_position);
  }

  // Gives the gradient of a number that depends on the tractions themselves, as these change with
  // the parameters.
  Eigen::VectorXd ByTractions(std::size_t load_case, const PartSurface& surface,
                              const std::vector<ByTraction>& changes) const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(parameters());
    if (changes.empty()) return gradient;
    const Eigen::Index places = surface.nodes().rows();
    for (std::size_t k = 0; k < rates_.size(); ++k) {
      const LoadCase loads = LoadCasesOf(rates_[k])[load_case].loads;
      const SurfaceTraction rate = TractionOn(solved_.mesh, surface, {}, loads);
      for (const ByTraction& change : changes) {
        gradient[static_cast<Eigen::Index>(k)] +=
            change.derivative.dot(rate.at_nodes.col(places * change.at.face + change.at.place));
      }
    }
    return gradient;
  }

  Eigen::Index parameters() const { return static_cast<Eigen::Index>(velocities_.size()); }

 private:
  AdjointGradients(const SolvedLoads& solved, const std::vector<DesignModel>& rates)
      : solved_(solved), rates_(rates) {}

  Eigen::Matrix3Xd Loads(std::size_t load_case, const Eigen::Matrix3Xd& adjoint) const {
    return LoadDerivative(solved_.mesh, solved_.model.analysis.materials,
                          solved_.load_cases[load_case].loads, adjoint);
  }

  Eigen::VectorXd Along(const Eigen::Matrix3Xd& factors) const {
    Eigen::VectorXd gradient(static_cast<Eigen::Index>(velocities_.size()));
    for (std::size_t k = 0; k < velocities_.size(); ++k) {
      gradient[static_cast<Eigen::Index>(k)] = Dot(factors, velocities_[k]);
    }
    return gradient;
  }

  Eigen::VectorXd ByLoads(std::size_t load_case, const Eigen::Matrix3Xd& adjoint) const {
    Eigen::VectorXd gradient(static_cast<Eigen::Index>(load_rates_.size()));
    for (std::size_t k = 0; k < load_rates_.size(); ++k) {
      gradient[static_cast<Eigen::Index>(k)] = Dot(adjoint, load_rates_[k][load_case]);
    }
    return gradient;
  }

  const SolvedLoads& solved_;
  const std::vector<DesignModel>& rates_;                  // for each parameter
  std::vector<Eigen::Matrix3Xd> velocities_;               // for each parameter
  std::vector<std::vector<Eigen::Matrix3Xd>> load_rates_;  // for each parameter and load case
};

// The load case where the value is largest.
template <typename ValueOf>
std::size_t Worst(const std::vector<SolvedCase>& cases, const ValueOf& value_of) {
  std::size_t worst = 0;
  for (std::size_t c = 1; c < cases.size(); ++c) {
    if (value_of(cases[c]) > value_of(cases[worst])) worst = c;
  }
  return worst;
}

// The gradients of stresses where they are largest.
class StressGradients {
 public:
  StressGradients(const SolvedLoads& solved, const AdjointGradients& gradients)
      : solved_(solved),
        gradients_(gradients),
        nodes_(solved.mesh),
        surface_(solved.mesh, nodes_),
        team_(solved.threads) {}

  absl::StatusOr<Eigen::VectorXd> VonMisesOf() {
    const std::size_t worst = Worst(solved_.cases, [](const SolvedCase& of) {
      return of.solution.part_maximum_von_mises.maxCoeff();
    });
    return VonMisesAt(worst, LargestSlot(worst, [](int, double stress) { return stress; }), 1);
  }

  // Zero where nobody says how strong anything is.
  absl::StatusOr<Eigen::VectorXd> Ratio() {
    const auto ratio = [this](int part, double stress) {
      const double strength = StrengthOf(part);
      return strength > 0 ? stress / strength : 0;
    };
    const std::size_t worst = Worst(solved_.cases, [&ratio](const SolvedCase& of) {
      const Eigen::VectorXd& stresses = of.solution.part_maximum_von_mises;
      double largest = 0;
      for (Eigen::Index p = 0; p < stresses.size(); ++p) {
        largest = std::max(largest, ratio(static_cast<int>(p), stresses[p]));
      }
      return largest;
    });
    const int slot = LargestSlot(worst, ratio);
    const double strength = StrengthOf(nodes_.part(slot));
    if (!(strength > 0)) return Eigen::VectorXd::Zero(gradients_.parameters()).eval();
    return VonMisesAt(worst, slot, 1 / strength);
  }

  absl::StatusOr<Eigen::VectorXd> Principal() {
    const std::size_t worst = Worst(solved_.cases, [](const SolvedCase& of) {
      return of.solution.maximum_principal.maxCoeff();
    });
    Eigen::Index node = 0;
    solved_.cases[worst].solution.maximum_principal.maxCoeff(&node);
    // At a node of several parts that of the part under the larger von Mises stress counts.
    const int slot = LargestSlot(
        worst, [](int, double stress) { return stress; }, static_cast<int>(node));
    return At(worst, slot, MaximumPrincipalGradient(InCase(worst).at_slots.col(slot)));
  }

 private:
  struct Recovered {
    Stresses at_points, at_slots;
  };

  const Recovered& InCase(std::size_t load_case) {
    const auto known = recovered_.find(load_case);
    if (known != recovered_.end()) return known->second;
    Recovered recovered;
    recovered.at_points = StressAtPoints(solved_.mesh, solved_.model.analysis.materials,
                                         solved_.cases[load_case].solution.displacement, {}, team_);
    recovered.at_slots = RecoverAtSlots(BodyIn(load_case), nodes_, surface_, team_);
    return recovered_.emplace(load_case, std::move(recovered)).first->second;
  }

  DeformedBody BodyIn(std::size_t load_case) const {
    const ElasticitySolution& solution = solved_.cases[load_case].solution;
    return {solved_.mesh, solved_.model.analysis.materials, solution.displacement,
            solution.temperature, solution.traction};
  }

  double StrengthOf(int part) const {
    return solved_.model.analysis.materials[static_cast<std::size_t>(part)].strength;
  }

  // The slot (of a node, if there is one) where `of` its part and von Mises stress is largest.
  template <typename Of>
  int LargestSlot(std::size_t load_case, const Of& of, int node = -1) {
    const Stresses& stresses = InCase(load_case).at_slots;
    int largest = -1;
    double value = 0;
    for (int slot = 0; slot < nodes_.size(); ++slot) {
      if (node >= 0 && nodes_.node(slot) != node) continue;
      const double here = of(nodes_.part(slot), VonMises(stresses.col(slot)));
      if (largest >= 0 && !(here > value)) continue;
      largest = slot;
      value = here;
    }
    return largest;
  }

  absl::StatusOr<Eigen::VectorXd> VonMisesAt(std::size_t load_case, int slot, double factor) {
    return At(load_case, slot, factor * VonMisesGradient(InCase(load_case).at_slots.col(slot)));
  }

  absl::StatusOr<Eigen::VectorXd> At(std::size_t load_case, int slot, const Vector6d& direction) {
    const StressDerivative derivative = NodalStressDerivative(
        BodyIn(load_case), nodes_, surface_, InCase(load_case).at_points, slot, direction);
    const LoadCase& loads = solved_.load_cases[load_case].loads;
    MORTISE_ASSIGN_OR_RETURN(
        Eigen::VectorXd gradient,
        gradients_.Of(load_case, derivative.by_displacement,
                      derivative.by_position + TractionDerivative(solved_.mesh, surface_, loads,
                                                                  derivative.by_traction)));
    return gradient + gradients_.ByTractions(load_case, surface_, derivative.by_traction);
  }

  const SolvedLoads& solved_;
  const AdjointGradients& gradients_;
  const PartNodes nodes_;
  const PartSurface surface_;
  ThreadTeam team_;
  std::map<std::size_t, Recovered> recovered_;
};

// Which measure of a spread a metric or function of this name is; nothing if it is none that has a
// gradient whatever place it is of.
std::optional<SpreadMeasure> MeasureOf(BuiltInMetric metric) {
  switch (metric) {
    case BuiltInMetric::kMeanVonMises:
      return SpreadMeasure::kMean;
    case BuiltInMetric::kRmsVonMises:
      return SpreadMeasure::kRootMeanSquare;
    case BuiltInMetric::kVonMisesIntegral:
      return SpreadMeasure::kIntegral;
    default:
      return std::nullopt;
  }
}
std::optional<SpreadMeasure> MeasureOf(const MetricCall& call) {
  // Functions of parts are called as the metric is that is of all parts.
  if (call.function->kind != parametric::MetricPlaceKind::kPart) return std::nullopt;
  return MeasureOf(FindMetric(call.function->name)->metric);
}

// In the worst of the load cases, or in the one of this name; over a part, or all where it is -1.
absl::StatusOr<Eigen::VectorXd> GradientOf(SpreadMeasure measure, int part,
                                           const std::string& load_case, const SolvedLoads& solved,
                                           const AdjointGradients& gradients) {
  ThreadTeam team(solved.threads);
  std::size_t worst = 0;
  std::optional<SpreadDerivative> of_worst;
  for (std::size_t c = 0; c < solved.cases.size(); ++c) {
    if (!load_case.empty() && load_case != solved.cases[c].name) continue;
    SpreadDerivative derivative =
        DerivativeOf(measure, solved.mesh, solved.model.analysis.materials,
                     solved.cases[c].solution.displacement, part, team);
    if (of_worst && derivative.value <= of_worst->value) continue;
    worst = c;
    of_worst = std::move(derivative);
  }
  if (!of_worst) return InvalidField("metric_definitions", "there is no such load case");
  return gradients.Of(worst, of_worst->by_displacement, of_worst->by_position);
}

// The gradient of a metric under loads that has one.
absl::StatusOr<Eigen::VectorXd> GradientOf(BuiltInMetric metric, const SolvedLoads& solved,
                                           const AdjointGradients& gradients,
                                           std::optional<StressGradients>& stresses) {
  const auto of_stress = [&]() -> StressGradients& {
    return stresses ? *stresses : stresses.emplace(solved, gradients);
  };
  const auto of_compliance = [&] {
    return gradients.Compliance(
        Worst(solved.cases, [](const SolvedCase& of) { return of.solution.summary.compliance; }));
  };
  if (const auto measure = MeasureOf(metric)) {
    return GradientOf(*measure, -1, "", solved, gradients);
  }
  switch (metric) {
    case BuiltInMetric::kMaxVonMises:
      return of_stress().VonMisesOf();
    case BuiltInMetric::kMaxPrincipal:
      return of_stress().Principal();
    case BuiltInMetric::kStressRatio:
      return of_stress().Ratio();
    case BuiltInMetric::kMaxDisplacement:
      return gradients.LargestDisplacement(Worst(solved.cases, [](const SolvedCase& of) {
        return of.solution.summary.maximum_displacement;
      }));
    case BuiltInMetric::kCompliance:
      return of_compliance();
    case BuiltInMetric::kStrainEnergy:
      return Eigen::VectorXd(of_compliance() / 2);
    default:
      return absl::InternalError(
          absl::StrCat("nothing computes the gradient of ", DescriptionOf(metric).name));
  }
}

absl::StatusOr<Eigen::VectorXd> GradientOf(const MetricCall& call, const SolvedLoads& solved,
                                           const AdjointGradients& gradients) {
  if (const auto measure = MeasureOf(call)) {
    const std::optional<int> part = FindPart(solved.model.surface, call.places[0]);
    if (!part) return InvalidField("metric_definitions", "there is no part " + call.places[0]);
    return GradientOf(*measure, *part, call.load_case, solved, gradients);
  }
  std::size_t worst = 0;
  std::optional<PlaceDisplacement> of_worst;
  for (std::size_t c = 0; c < solved.cases.size(); ++c) {
    if (!call.load_case.empty() && call.load_case != solved.cases[c].name) continue;
    MORTISE_ASSIGN_OR_RETURN(PlaceDisplacement place,
                             DisplacementOf(call, solved, solved.cases[c]));
    if (of_worst && std::abs(place.value) <= std::abs(of_worst->value)) continue;
    worst = c;
    of_worst = std::move(place);
  }
  if (!of_worst) return InvalidField("metric_definitions", "there is no such load case");
  MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd gradient,
                           gradients.Of(worst, of_worst->by_field, of_worst->by_position));
  if (of_worst->by_parameters.size() > 0) gradient += of_worst->by_parameters;
  return gradient;
}

}  // namespace

bool HasGradientUnderLoads(const MetricCall& call) {
  return call.function->name.starts_with("mean_displacement") ||
         call.function->name.starts_with("max_displacement") || MeasureOf(call).has_value();
}

std::optional<Eigen::VectorXd> GradientOfShape(const MetricCall& call, const DesignModel& model,
                                               const DesignMotion& motion,
                                               const parametric::MetricExpressions& own,
                                               const Eigen::VectorXd& parameters) {
  const auto shape_of = [&](const std::string& name) -> const FaceShapeMotion* {
    const auto face = FindFace(model, name);
    if (!face) return nullptr;
    const auto shape =
        std::find_if(motion.shapes.begin(), motion.shapes.end(),
                     [&face](const FaceShapeMotion& of) { return of.face == *face; });
    return shape == motion.shapes.end() ? nullptr : &*shape;
  };
  using PlacedPoint = parametric::MetricExpressions::PlacedPoint;
  const auto place_of = [&](const std::string& name) -> std::optional<PlacedPoint> {
    auto point = own.PointAt(name, parameters);
    if (!point.ok() || *point) return point.ok() ? *std::move(point) : std::nullopt;
    const FaceShapeMotion* const shape = shape_of(name);
    if (shape == nullptr) return std::nullopt;
    return PlacedPoint{shape->centroid, shape->centroid_rate};
  };
  const std::string& function = call.function->name;
  if (function == "area") {
    const FaceShapeMotion* const shape = shape_of(call.places[0]);
    return shape == nullptr ? std::nullopt : std::optional(shape->area_rate);
  }
  const auto place = place_of(call.places[0]);
  if (!place) return std::nullopt;
  if (function != "distance") {
    return Eigen::VectorXd(place->velocity.row(function.back() - 'x').transpose());
  }
  const auto other = place_of(call.places[1]);
  if (!other || place->position == other->position) return std::nullopt;
  const Eigen::Vector3d direction = (place->position - other->position).normalized();
  return Eigen::VectorXd((place->velocity - other->velocity).transpose() * direction);
}

bool AllowsGradients(const DesignModel& model, const DesignMotion& motion) {
  const auto is_still = [&motion](const Support& support) {
    if (!support.displacement.isZero(0)) return false;
    return !support.symmetric ||
           std::none_of(motion.faces.begin(), motion.faces.end(), [&](const FaceMotion& face) {
             return face.face == support.face &&
                    std::count(face.prescribed.begin(), face.prescribed.end(), true) > 1;
           });
  };
  return !(model.heat && model.reference_temperature) && !model.analysis.rotation &&
         std::none_of(
             model.load_cases.begin(), model.load_cases.end(),
             [](const NamedLoadCase& named) { return named.loads.rotation.has_value(); }) &&
         std::all_of(model.analysis.supports.begin(), model.analysis.supports.end(), is_still);
}

absl::StatusOr<std::map<std::string, Eigen::VectorXd>> GradientsUnderLoads(
    const SolvedLoads& solved, const DesignMotion& motion, const std::vector<std::string>& metrics,
    const std::vector<MetricCall>& calls) {
  std::map<std::string, Eigen::VectorXd> found;
  MORTISE_ASSIGN_OR_RETURN(const AdjointGradients gradients,
                           AdjointGradients::Create(solved, motion));
  std::optional<StressGradients> stresses;
  for (const std::string& name : metrics) {
    const MetricDescription* const metric = FindMetric(name);
    const bool is_known = metric != nullptr && metric->source == MetricSource::kLoads;
    if (!is_known || !metric->has_gradient) continue;
    MORTISE_ASSIGN_OR_RETURN(found[name], GradientOf(metric->metric, solved, gradients, stresses));
  }
  for (const MetricCall& call : calls) {
    if (!HasGradientUnderLoads(call)) continue;
    MORTISE_ASSIGN_OR_RETURN(found[ToText(call)], GradientOf(call, solved, gradients));
  }
  return found;
}

}  // namespace mortise::simulator
