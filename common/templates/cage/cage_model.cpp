#include "common/templates/cage/cage_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/design/parameter_values.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/shapes/mean_value_coordinates.h"
#include "common/mesh/surface_check.h"
#include "common/templates/cage/cage_checks.h"
#include "common/templates/cage/cage_expressions.h"

namespace mortise::parametric {
namespace {

constexpr int kRandomPoints = 32;
constexpr std::size_t kMaxFindings = 100;
constexpr double kCollapsed = 1e-6;  // of the volume at the defaults
constexpr double kDegenerate =
    1e-12;  // of the square of a triangle's longest side, as CheckSurface

// " (at length = 0.2, width = 0.1)".
std::string At(const CageTemplate& definition, const Eigen::VectorXd& q) {
  return absl::StrCat(" (at ", ToText(definition.parameters, q), ")");
}

std::string Place(const Eigen::Vector3d& place) {
  return absl::StrFormat(" at (%.4g, %.4g, %.4g) mm", 1e3 * place.x(), 1e3 * place.y(),
                         1e3 * place.z());
}

// What is wrong with a deformed surface; empty if nothing. That it is closed does not change.
std::string FaultOf(const mesh::SurfaceMesh& surface, double volume_at_defaults) {
  if (mesh::ComputeMassProperties(surface).volume <= kCollapsed * volume_at_defaults) {
    return "collapses or turns inside out";
  }
  for (const auto& triangle : surface.triangles.colwise()) {
    const Eigen::Vector3d a = surface.vertices.col(triangle(0));
    const Eigen::Vector3d u = surface.vertices.col(triangle(1)) - a;
    const Eigen::Vector3d v = surface.vertices.col(triangle(2)) - a;
    const double longest2 = std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()});
    if (u.cross(v).norm() <= kDegenerate * longest2) {
      return absl::StrCat("has a triangle without an area", Place(a));
    }
  }
  const auto crossings = mesh::FindIntersections(surface.vertices, surface.triangles);
  return crossings.empty() ? "" : absl::StrCat("crosses itself", Place(crossings[0].place));
}

// Adds the findings of a status, the first at each place.
class FindingList {
 public:
  explicit FindingList(std::vector<FieldViolation>& findings) : findings_(findings) {}

  void Add(const absl::Status& status, const std::string& where) {
    std::vector<FieldViolation> violations = ViolationsOf(status);
    if (violations.empty()) {
      const std::string field = DetailOf(status).field;
      absl::string_view message = status.message();
      absl::ConsumePrefix(&message, field + ": ");
      violations.push_back({field, std::string(message)});
    }
    for (const FieldViolation& violation : violations) {
      if (full() || !seen_.insert(violation.field).second) continue;
      findings_.push_back({violation.field, violation.message + where});
    }
  }
  bool full() const { return findings_.size() >= kMaxFindings; }

 private:
  std::vector<FieldViolation>& findings_;
  std::set<std::string> seen_;
};

}  // namespace

struct CageModel::State {
  State(CageTemplate definition_in, std::vector<FieldViolation>& findings)
      : definition(std::move(definition_in)), expressions(definition, findings) {}

  // If there are findings already, only the cage is looked at.
  void ComputeCoordinates(std::vector<FieldViolation>& findings) {
    FindingList list(findings);
    const auto numbers =
        expressions.Cage(parametric::Defaults(definition.parameters), /*with_gradient=*/false);
    if (!numbers.ok()) return list.Add(numbers.status(), " (at the defaults)");
    const Eigen::Matrix3Xd none(3, 0);
    auto computed =
        mesh::MeanValueCoordinates({numbers->cage, definition.cage.triangles},
                                   findings.empty() ? definition.surface.vertices : none);
    if (!computed.ok()) return list.Add(computed.status(), " (at the defaults)");
    coordinates = *std::move(computed);
  }

  void CollectTriangles() {
    const CageSurface& surface = definition.surface;
    triangles = TrianglesOf(surface);
    triangle_face.resize(triangles.cols());
    Eigen::Index first = 0;
    for (std::size_t face = 0; face < surface.faces.size(); ++face) {
      const Eigen::Index count = surface.faces[face].triangles.cols();
      triangle_face.segment(first, count).setConstant(static_cast<int>(face));
      first += count;
    }
    volume = mesh::ComputeMassProperties(mesh::SurfaceMesh{surface.vertices, triangles}).volume;
  }

  mesh::SurfaceMesh SurfaceAt(const Eigen::Matrix3Xd& cage) const {
    return {cage * coordinates, triangles};
  }

  CageTemplate definition;
  CageExpressions expressions;
  Eigen::Matrix3Xi triangles;     // of all faces
  Eigen::VectorXi triangle_face;  // T
  Eigen::MatrixXd coordinates;    // C × V
  double volume = 0;              // m³, at the defaults
};

CageModel::CageModel(std::shared_ptr<const State> state) : state_(std::move(state)) {}

std::shared_ptr<const CageModel::State> CageModel::Compile(CageTemplate definition,
                                                           std::vector<FieldViolation>& findings) {
  findings = CheckCageSizes(definition);
  if (!findings.empty()) return nullptr;
  findings = CheckCageTemplate(definition);
  const std::size_t before = findings.size();
  auto state = std::make_shared<State>(std::move(definition), findings);
  if (findings.size() == before) state->ComputeCoordinates(findings);
  if (findings.size() > kMaxFindings) findings.resize(kMaxFindings);
  if (!findings.empty()) return nullptr;
  state->CollectTriangles();
  return state;
}

std::vector<FieldViolation> CageModel::TryPoints() const {
  std::vector<FieldViolation> findings;
  FindingList list(findings);
  for (const Eigen::VectorXd& q : TrialPoints(definition().parameters, kRandomPoints)) {
    if (list.full()) break;
    const auto design = Evaluate(q);
    if (design.ok()) continue;
    // A surface at fault tells of its parameters itself.
    const bool told = DetailOf(design.status()).field == "surface";
    list.Add(design.status(), told ? "" : At(definition(), q));
  }
  return findings;
}

std::vector<FieldViolation> ValidateCageTemplate(const CageTemplate& definition) {
  std::vector<FieldViolation> findings;
  const auto state = CageModel::Compile(definition, findings);
  return state == nullptr ? findings : CageModel(state).TryPoints();
}

absl::StatusOr<CageModel> CageModel::Create(CageTemplate definition) {
  std::vector<FieldViolation> findings;
  auto state = Compile(std::move(definition), findings);
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  CageModel model(std::move(state));
  MORTISE_RETURN_IF_ERROR(ToStatus(model.TryPoints()));
  return model;
}

const CageTemplate& CageModel::definition() const { return state_->definition; }

Eigen::VectorXd CageModel::Defaults() const {
  return parametric::Defaults(state_->definition.parameters);
}

const Eigen::MatrixXd& CageModel::coordinates() const { return state_->coordinates; }

absl::StatusOr<CageDesign> CageModel::Evaluate(const Eigen::VectorXd& q) const {
  MORTISE_RETURN_IF_ERROR(ToStatus(CheckRanges(state_->definition.parameters, q)));
  MORTISE_ASSIGN_OR_RETURN(const CageNumbers numbers, state_->expressions.Cage(q, false));
  MORTISE_ASSIGN_OR_RETURN(const CageExpressions::Conditions conditions,
                           state_->expressions.ConditionsAt(q));
  CageDesign design{state_->SurfaceAt(numbers.cage), state_->triangle_face, {}, {}, {},
                    conditions.reference_temperature};
  const std::string fault = FaultOf(design.surface, state_->volume);
  if (!fault.empty()) {
    return InvalidField("surface", absl::StrCat(fault, At(state_->definition, q)));
  }
  for (const CageFace& face : state_->definition.surface.faces) {
    design.face_names.push_back(face.name);
  }
  for (std::size_t i = 0; i < conditions.numbers.size(); ++i) {
    const CageCondition& condition = state_->definition.conditions[i];
    if (!conditions.numbers[i]) {
      design.absent_conditions.push_back(condition.name);
      continue;
    }
    FaceCondition at;
    static_cast<ConditionNumbers&>(at) = *conditions.numbers[i];
    at.name = condition.name;
    at.kind = condition.kind;
    at.load_case = condition.load_case;
    for (std::size_t face = 0; face < design.face_names.size(); ++face) {
      const auto& wanted = condition.faces;
      if (std::find(wanted.begin(), wanted.end(), design.face_names[face]) != wanted.end()) {
        at.faces.push_back(static_cast<int>(face));
      }
    }
    design.conditions.push_back(std::move(at));
  }
  return design;
}

absl::StatusOr<Eigen::MatrixXd> CageModel::Jacobian(const Eigen::VectorXd& q) const {
  MORTISE_RETURN_IF_ERROR(ToStatus(CheckRanges(state_->definition.parameters, q)));
  MORTISE_ASSIGN_OR_RETURN(const CageNumbers numbers, state_->expressions.Cage(q, true));
  const Eigen::Index vertices = state_->coordinates.cols();
  Eigen::MatrixXd jacobian(3 * vertices, q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    // Column i of the derivatives, seen as one vector a vertex.
    const Eigen::Map<const Eigen::Matrix3Xd> cage(numbers.by_cage.col(i).data(), 3,
                                                  numbers.cage.cols());
    Eigen::Map<Eigen::Matrix3Xd>(jacobian.col(i).data(), 3, vertices) = cage * state_->coordinates;
  }
  return jacobian;
}

absl::StatusOr<Dual> CageModel::Volume(const Eigen::VectorXd& q) const {
  MORTISE_RETURN_IF_ERROR(ToStatus(CheckRanges(state_->definition.parameters, q)));
  MORTISE_ASSIGN_OR_RETURN(const CageNumbers numbers, state_->expressions.Cage(q, true));
  const mesh::SurfaceMesh surface = state_->SurfaceAt(numbers.cage);
  Eigen::Matrix3Xd by_vertex = Eigen::Matrix3Xd::Zero(3, surface.vertices.cols());
  for (const auto& triangle : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      by_vertex.col(triangle(k)) += surface.vertices.col(triangle((k + 1) % 3))
                                        .cross(surface.vertices.col(triangle((k + 2) % 3))) /
                                    6;
    }
  }
  const Eigen::Matrix3Xd by_cage = by_vertex * state_->coordinates.transpose();
  return Dual{mesh::ComputeMassProperties(surface).volume,
              numbers.by_cage.transpose() * by_cage.reshaped()};
}

}  // namespace mortise::parametric
