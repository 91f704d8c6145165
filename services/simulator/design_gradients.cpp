#include "services/simulator/design_gradients.h"

#include <algorithm>
#include <cmath>

#include "common/base/errors.h"
#include "services/simulator/design_solver.h"
#include "services/simulator/loads.h"
#include "services/simulator/place_functions.h"
#include "services/simulator/shape_derivative.h"

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
    AdjointGradients gradients(solved);
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
    Eigen::Matrix3Xd force = Eigen::Matrix3Xd::Zero(3, solved_.mesh.nodes.cols());
    force.col(node) = solution.displacement.col(node).normalized();
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd adjoint, solved_.system.SolveForces(force));
    return By(load_case, adjoint, Eigen::Matrix3Xd::Zero(3, force.cols()));
  }

  absl::StatusOr<Eigen::VectorXd> FaceMeanOf(std::size_t load_case, const FaceMean& mean) const {
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd adjoint,
                             solved_.system.SolveForces(mean.by_field));
    return By(load_case, adjoint, mean.by_position);
  }

 private:
  explicit AdjointGradients(const SolvedLoads& solved) : solved_(solved) {}

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

absl::StatusOr<Eigen::VectorXd> GradientOf(const std::string& metric, const SolvedLoads& solved,
                                           const AdjointGradients& gradients) {
  if (metric == "max_displacement") {
    return gradients.LargestDisplacement(Worst(solved.cases, [](const SolvedCase& of) {
      return of.solution.summary.maximum_displacement;
    }));
  }
  const std::size_t worst =
      Worst(solved.cases, [](const SolvedCase& of) { return of.solution.summary.compliance; });
  const Eigen::VectorXd gradient = gradients.Compliance(worst);
  return metric == "compliance" ? gradient : Eigen::VectorXd(gradient / 2);
}

absl::StatusOr<Eigen::VectorXd> GradientOf(const MetricCall& call, const SolvedLoads& solved,
                                           const AdjointGradients& gradients) {
  const auto face = FindFace(solved.model, call.places[0]);
  if (!face) return InvalidField("metric_definitions", "there is no face " + call.places[0]);
  const std::vector<int> triangles = TrianglesOn(solved.mesh, *face, false);
  const Eigen::Vector3d direction = Eigen::Vector3d::Unit(call.function->name.back() - 'x');
  std::size_t worst = 0;
  std::optional<FaceMean> of_worst;
  for (std::size_t c = 0; c < solved.cases.size(); ++c) {
    if (!call.load_case.empty() && call.load_case != solved.cases[c].name) continue;
    FaceMean mean =
        MeanOverTriangles(solved.mesh, triangles, solved.cases[c].solution.displacement, direction);
    if (of_worst && std::abs(mean.value) <= std::abs(of_worst->value)) continue;
    worst = c;
    of_worst = std::move(mean);
  }
  if (!of_worst) return InvalidField("metric_definitions", "there is no such load case");
  return gradients.FaceMeanOf(worst, *of_worst);
}

}  // namespace

bool HasGradientUnderLoads(const std::string& metric) {
  return metric == "compliance" || metric == "strain_energy" || metric == "max_displacement";
}

bool HasGradientUnderLoads(const MetricCall& call) {
  return call.function->name.starts_with("mean_displacement_");
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
  for (const std::string& metric : metrics) {
    if (!HasGradientUnderLoads(metric)) continue;
    MORTISE_ASSIGN_OR_RETURN(found[metric], GradientOf(metric, solved, gradients));
  }
  for (const MetricCall& call : calls) {
    if (!HasGradientUnderLoads(call)) continue;
    MORTISE_ASSIGN_OR_RETURN(found[ToText(call)], GradientOf(call, solved, gradients));
  }
  return found;
}

}  // namespace mortise::simulator
