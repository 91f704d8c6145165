#include "services/simulator/analysis/place_functions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/fem/elements/point_location.h"
#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

using parametric::MetricCall;
using parametric::MetricFunctionSource;

constexpr std::size_t kNamesTold = 12;
constexpr char kField[] = "metric_definitions";

// The axis that a function's name ends in, as in "reaction_x"; -1 without one.
int AxisOf(const std::string& function) {
  if (function.size() < 2 || function[function.size() - 2] != '_') return -1;
  return static_cast<int>(std::string("xyz").find(function.back()));
}

// The area of a face, and its first moment.
struct FaceMoments {
  double area = 0;                                   // m²
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // m³
};

FaceMoments MomentsOf(const mesh::AssemblySurface& surface, const mesh::NamedFace& face) {
  FaceMoments sum;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const auto& origins = surface.faces[static_cast<std::size_t>(surface.triangle_face[t])].origins;
    if (std::find(origins.begin(), origins.end(), face) == origins.end()) continue;
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = surface.vertices.col(surface.triangles(k, t));
    const double area =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm() / 2;
    sum.area += area;
    sum.moment += area * corners.rowwise().mean();
  }
  return sum;
}

// The nodes of a face's triangles, each once.
std::vector<int> NodesOn(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face) {
  std::vector<int> nodes;
  for (const int t : TrianglesOn(mesh, face, false)) {
    for (const int node : mesh.face_triangles.col(t)) nodes.push_back(node);
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

// The first dozen of some names, in order.
std::string Told(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  const std::size_t more = names.size() - std::min(names.size(), kNamesTold);
  names.resize(names.size() - more);
  return absl::StrCat(absl::StrJoin(names, ", "),
                      more > 0 ? absl::StrCat(" and ", more, " more") : "");
}

// Calls back with the shape functions of a triangle, its nodes, and the area at each point of the
// rule.
using AtPoint =
    std::function<void(const ShapeVector& shape, const Eigen::VectorXi& nodes, double area)>;
void Integrate(const mesh::TetrahedralMesh& mesh, const std::vector<int>& triangles,
               const AtPoint& at) {
  for (const int t : triangles) {
    const GradientMatrix positions = TrianglePositions(mesh, t);
    const Eigen::VectorXi nodes = mesh.face_triangles.col(t);
    for (const TrianglePoint& point : TriangleRule()) {
      at(TriangleShape(point.barycentric, static_cast<int>(nodes.size())), nodes,
         point.weight * TriangleAreaVector(positions, point.barycentric).norm());
    }
  }
}

// The mean over a face of what `measure` makes of a field's value. `field`: a column a node.
using Measure = std::function<double(const Eigen::VectorXd& value)>;
double MeanOver(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face,
                const Eigen::MatrixXd& field, const Measure& measure) {
  double area = 0;
  double sum = 0;
  Integrate(mesh, TrianglesOn(mesh, face, false),
            [&](const ShapeVector& shape, const Eigen::VectorXi& nodes, double piece) {
              Eigen::VectorXd value = Eigen::VectorXd::Zero(field.rows());
              for (Eigen::Index k = 0; k < nodes.size(); ++k) {
                value += shape[k] * field.col(nodes[k]);
              }
              area += piece;
              sum += piece * measure(value);
            });
  return sum / area;
}

// The column of `field` in the element at `point`; INVALID_ARGUMENT outside of the body.
absl::StatusOr<Eigen::VectorXd> AtPointOf(const mesh::TetrahedralMesh& mesh,
                                          const std::string& name, const Eigen::Vector3d& point,
                                          const Eigen::MatrixXd& field) {
  const LocatedPoint located = LocatePoints(mesh, {point})[0];
  if (located.element < 0) {
    return InvalidField(kField, absl::StrCat("the point '", name, "' lies outside of the body"));
  }
  const auto nodes = mesh.tetrahedra.col(located.element);
  const ShapeVector shape =
      TetrahedronShape(located.barycentric, static_cast<int>(mesh.tetrahedra.rows()));
  Eigen::VectorXd value = Eigen::VectorXd::Zero(field.rows());
  for (Eigen::Index k = 0; k < nodes.size(); ++k) value += shape[k] * field.col(nodes[k]);
  return value;
}

}  // namespace

bool IsOfSpread(const MetricCall& call) {
  const std::string& function = call.function->name;
  return function != "max_von_mises" && function.find("von_mises") != std::string::npos;
}

std::optional<int> FindPart(const mesh::AssemblySurface& surface, const std::string& name) {
  const auto found = std::find(surface.part_names.begin(), surface.part_names.end(), name);
  if (found == surface.part_names.end()) return std::nullopt;
  return static_cast<int>(found - surface.part_names.begin());
}

std::string FaceText(const mesh::AssemblySurface& surface, const mesh::NamedFace& face) {
  if (surface.part_names.size() == 1) return face.name;
  return absl::StrCat(surface.part_names[static_cast<std::size_t>(face.part)], "/", face.name);
}

std::optional<mesh::NamedFace> FindFace(const DesignModel& model, const std::string& name) {
  for (const auto& [condition, face] : model.condition_faces) {
    if (condition == name) return face;
  }
  for (const mesh::AssemblyFace& face : model.surface.faces) {
    for (const mesh::NamedFace& origin : face.origins) {
      const std::string& part = model.surface.part_names[static_cast<std::size_t>(origin.part)];
      if (name == FaceText(model.surface, origin) || name == absl::StrCat(part, "/", origin.name)) {
        return origin;
      }
    }
  }
  return std::nullopt;
}

namespace {

// How many faces the condition of this name acts on; 0 if there is none.
int CopiesOf(const DesignModel& model, const std::string& name) {
  return static_cast<int>(
      std::count_if(model.condition_faces.begin(), model.condition_faces.end(),
                    [&name](const auto& condition) { return condition.first == name; }));
}

// Says that there is no such place, and which faces there are.
std::string NoPlace(const mesh::AssemblySurface& surface, const std::string& name) {
  std::vector<std::string> names;
  for (const mesh::AssemblyFace& face : surface.faces) {
    for (const mesh::NamedFace& origin : face.origins) names.push_back(FaceText(surface, origin));
  }
  return absl::StrCat("there is no point, condition or face '", name, "'; faces are ",
                      Told(std::move(names)));
}

}  // namespace

PlaceFunctions::PlaceFunctions(const parametric::MetricExpressions& own,
                               const Eigen::VectorXd& parameters, const DesignModel& model,
                               const DesignAnalysis& analysis)
    : own_(own), parameters_(parameters), model_(model), analysis_(analysis) {}

absl::StatusOr<MetricPlace> PlaceFunctions::Find(const std::string& name) const {
  MORTISE_ASSIGN_OR_RETURN(const auto point, own_.PointAt(name, parameters_));
  if (point) return MetricPlace{.point = point->position};
  if (const int copies = CopiesOf(model_, name); copies > 1) {
    return InvalidField(kField,
                        absl::StrCat("'", name, "' acts on ", copies,
                                     " copies of a part: name the face of one, as '",
                                     FaceText(model_.surface, *FindFace(model_, name)), "'"));
  }
  if (const auto face = FindFace(model_, name)) return MetricPlace{.point = {}, .face = *face};
  return InvalidField(kField, NoPlace(model_.surface, name));
}

absl::StatusOr<MetricPlace> PlaceFunctions::PlaceOf(const MetricCall& call) const {
  using Kind = parametric::MetricPlaceKind;
  const Kind kind = call.function->kind;
  const std::string& name = call.places[0];
  const std::optional<int> part = FindPart(model_.surface, name);
  if (kind == Kind::kPart) {
    if (part) return MetricPlace{.point = {}, .part = part};
    return InvalidField(kField, absl::StrCat("there is no part '", name, "'; parts are ",
                                             Told(model_.surface.part_names)));
  }
  absl::StatusOr<MetricPlace> place = Find(name);
  const bool is_none = !place.ok() && !own_.HasPoint(name) && CopiesOf(model_, name) == 0;
  if (kind == Kind::kAny && is_none) {
    if (part) return MetricPlace{.point = {}, .part = part};
    return InvalidField(kField, absl::StrCat(NoPlace(model_.surface, name), "; parts are ",
                                             Told(model_.surface.part_names)));
  }
  if (kind == Kind::kFace && place.ok() && place->point) {
    return InvalidField(
        kField, absl::StrCat("'", name, "' is a point; ", call.function->name, " is of faces"));
  }
  return place;
}

absl::StatusOr<double> PlaceFunctions::Value(const MetricCall& call) const {
  switch (call.function->source) {
    case MetricFunctionSource::kShape:
      return OfShape(call);
    case MetricFunctionSource::kLoads:
      return UnderLoads(call);
    case MetricFunctionSource::kHeat:
      return OfHeat(call);
  }
  return absl::InternalError("a function without a source");
}

absl::StatusOr<Eigen::Vector3d> PlaceFunctions::PositionOf(const std::string& name) const {
  MORTISE_ASSIGN_OR_RETURN(const MetricPlace place, Find(name));
  if (place.point) return *place.point;
  const FaceMoments moments = MomentsOf(model_.surface, place.face);
  return moments.moment / moments.area;
}

absl::StatusOr<double> PlaceFunctions::OfShape(const MetricCall& call) const {
  if (call.function->name == "area") {
    MORTISE_ASSIGN_OR_RETURN(const MetricPlace place, PlaceOf(call));
    return MomentsOf(model_.surface, place.face).area;
  }
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Vector3d position, PositionOf(call.places[0]));
  if (call.function->name != "distance") return position[AxisOf(call.function->name)];
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Vector3d other, PositionOf(call.places[1]));
  return (position - other).norm();
}

absl::StatusOr<double> PlaceFunctions::UnderLoads(const MetricCall& call) const {
  MORTISE_ASSIGN_OR_RETURN(const MetricPlace place, PlaceOf(call));
  double worst = 0;
  bool is_there = false;
  for (const SolvedCase& solved : analysis_.cases) {
    if (!call.load_case.empty() && call.load_case != solved.name) continue;
    MORTISE_ASSIGN_OR_RETURN(const double value, InCase(call, place, solved));
    if (!is_there || std::abs(value) > std::abs(worst)) worst = value;
    is_there = true;
  }
  if (is_there) return worst;
  return InvalidField(
      kField,
      absl::StrCat("there is no load case '", call.load_case, "'; there are ",
                   absl::StrJoin(analysis_.cases, ", ", [](std::string* out, const auto& solved) {
                     out->append(solved.name);
                   })));
}

absl::StatusOr<double> PlaceFunctions::InCase(const MetricCall& call, const MetricPlace& place,
                                              const SolvedCase& solved) const {
  const std::string& function = call.function->name;
  const mesh::TetrahedralMesh& mesh = *analysis_.mesh;
  const ElasticitySolution& solution = solved.solution;
  if (function.find("von_mises") != std::string::npos) return Stress(call, place, solved);
  if (function.starts_with("reaction") || function.starts_with("moment")) {
    Eigen::Vector3d about = Eigen::Vector3d::Zero();
    if (call.places.size() > 1) {
      MORTISE_ASSIGN_OR_RETURN(about, PositionOf(call.places[1]));
    }
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (const int node : NodesOn(mesh, place.face)) {
      const Eigen::Vector3d reaction = solution.reaction.col(node);
      force += reaction;
      moment += (mesh.nodes.col(node) - about).cross(reaction);
    }
    const int axis = AxisOf(function);
    return call.places.size() > 1 ? moment[axis] : force[axis];
  }
  return Displacement(call, place, solution);
}

absl::StatusOr<double> PlaceFunctions::Displacement(const MetricCall& call,
                                                    const MetricPlace& place,
                                                    const ElasticitySolution& solution) const {
  const std::string& function = call.function->name;
  const mesh::TetrahedralMesh& mesh = *analysis_.mesh;
  const int axis = AxisOf(function);
  const Measure measure = [axis](const Eigen::VectorXd& displacement) {
    return axis < 0 ? displacement.norm() : displacement[axis];
  };
  if (place.point) {
    MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd displacement,
                             AtPointOf(mesh, call.places[0], *place.point, solution.displacement));
    return measure(displacement);
  }
  if (function.starts_with("mean")) {
    return MeanOver(mesh, place.face, solution.displacement, measure);
  }
  double largest = 0;
  for (const int node : NodesOn(mesh, place.face)) {
    const double value = measure(solution.displacement.col(node));
    if (std::abs(value) > std::abs(largest)) largest = value;
  }
  return largest;
}

// Over the volume, of the elements' own stress; on faces and at points, of what is recovered at
// nodes, as the fields show it.
absl::StatusOr<double> PlaceFunctions::Stress(const MetricCall& call, const MetricPlace& place,
                                              const SolvedCase& solved) const {
  const std::string& function = call.function->name;
  const mesh::TetrahedralMesh& mesh = *analysis_.mesh;
  const ElasticitySolution& solution = solved.solution;
  if (place.part) {
    if (function == "max_von_mises") return solution.part_maximum_von_mises[*place.part];
    const StressSpread spread = SpreadInPart(mesh, *solved.spread, *place.part);
    if (function == "mean_von_mises") return spread.Mean();
    if (function == "rms_von_mises") return spread.RootMeanSquare();
    if (function == "von_mises_p99") return spread.Percentile(kShareBelowP99);
    return spread.Integral();
  }
  if (place.point) {
    MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd stress,
                             AtPointOf(mesh, call.places[0], *place.point, solution.stress));
    return VonMises(stress);
  }
  if (function == "mean_von_mises") {
    return MeanOver(mesh, place.face, solution.stress,
                    [](const Eigen::VectorXd& stress) { return VonMises(stress); });
  }
  double largest = 0;
  for (const int node : NodesOn(mesh, place.face)) {
    largest = std::max(largest, solution.von_mises[node]);
  }
  return largest;
}

absl::StatusOr<double> PlaceFunctions::OfHeat(const MetricCall& call) const {
  MORTISE_ASSIGN_OR_RETURN(const MetricPlace place, PlaceOf(call));
  const std::string& function = call.function->name;
  if (function == "heat_dissipation") return Dissipation(place.face);
  const mesh::TetrahedralMesh& mesh = *analysis_.mesh;
  const Eigen::VectorXd& temperature = analysis_.heat->temperature;
  if (place.point) {
    MORTISE_ASSIGN_OR_RETURN(
        const Eigen::VectorXd value,
        AtPointOf(mesh, call.places[0], *place.point, temperature.transpose()));
    return value[0];
  }
  if (function == "mean_temperature") {
    return MeanOver(mesh, place.face, temperature.transpose(),
                    [](const Eigen::VectorXd& value) { return value[0]; });
  }
  const std::vector<int> nodes = NodesOn(mesh, place.face);
  const Eigen::VectorXd on_face = temperature(nodes);
  return function == "max_temperature" ? on_face.maxCoeff() : on_face.minCoeff();
}

// What the convections on the face carry off, and what its nodes of held temperature let out.
double PlaceFunctions::Dissipation(const mesh::NamedFace& face) const {
  const mesh::TetrahedralMesh& mesh = *analysis_.mesh;
  const HeatSolution& heat = *analysis_.heat;
  const std::vector<int> triangles = TrianglesOn(mesh, face, true);
  double power = 0;
  for (const Convection& convection : model_.heat->convections) {
    std::vector<int> shared;
    const std::vector<int> cooled = TrianglesOn(mesh, convection.face, true);
    std::set_intersection(triangles.begin(), triangles.end(), cooled.begin(), cooled.end(),
                          std::back_inserter(shared));
    Integrate(mesh, shared,
              [&](const ShapeVector& shape, const Eigen::VectorXi& nodes, double area) {
                double temperature = 0;
                for (Eigen::Index k = 0; k < nodes.size(); ++k) {
                  temperature += shape[k] * heat.temperature[nodes[k]];
                }
                power += area * convection.coefficient * (temperature - convection.ambient);
              });
  }
  for (const int node : NodesOn(mesh, face)) power -= heat.reaction[node];
  return power;
}

}  // namespace mortise::simulator
