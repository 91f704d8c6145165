#include "services/simulator/worker/design_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "services/simulator/worker/design_conditions.h"

namespace mortise::simulator {
namespace {

using parametric::EvaluatedDesign;
using parametric::EvaluatedPart;

constexpr double kStep = 1e-4;    // of a parameter's range
constexpr double kAcross = 1e-9;  // m, how far an edge along an axis may stray from it
constexpr char kReason[] = "MESH_MOTION";

// A design at three values of a parameter, and the factors that make a derivative of them.
struct Stencil {
  std::vector<EvaluatedDesign> designs;
  std::vector<double> factors;

  // The derivative of `of(design)`, in which sums and products by numbers are known.
  template <typename Of>
  auto Rate(const Of& of) const {
    auto rate = of(designs[0]);
    rate *= factors[0];
    for (std::size_t i = 1; i < designs.size(); ++i) {
      auto more = of(designs[i]);
      more *= factors[i];
      rate += more;
    }
    return rate;
  }
};

// The load-bearing parts, in their order.
std::vector<const EvaluatedPart*> BearingParts(const EvaluatedDesign& design) {
  std::vector<const EvaluatedPart*> parts;
  for (const EvaluatedPart& part : design.parts) {
    if (!part.connecting) parts.push_back(&part);
  }
  return parts;
}

bool IsAlike(const EvaluatedDesign& a, const EvaluatedDesign& b) {
  const auto first = BearingParts(a);
  const auto second = BearingParts(b);
  return std::equal(first.begin(), first.end(), second.begin(), second.end(),
                    [](const EvaluatedPart* one, const EvaluatedPart* other) {
                      return one->name == other->name && one->item == other->item &&
                             one->axis == other->axis &&
                             one->outline.cols() == other->outline.cols() &&
                             one->face_names == other->face_names;
                    }) &&
         a.boundary_conditions.size() == b.boundary_conditions.size();
}

// Central differences, or three points to one side at the end of the range.
absl::StatusOr<Stencil> StencilOf(const templates::Template& function, const Eigen::VectorXd& at,
                                  const EvaluatedDesign& design, std::size_t index) {
  const parametric::Parameter& parameter = function.parameters()[index];
  if (parameter.IsChoice()) return Stencil{{design}, {0}};
  const double h = kStep * (parameter.maximum - parameter.minimum);
  const double value = at[static_cast<Eigen::Index>(index)];
  std::vector<double> steps{-h, h};
  Stencil stencil{{}, {-0.5 / h, 0.5 / h}};
  if (value - h < parameter.minimum || value + h > parameter.maximum) {
    const double inwards = value - h < parameter.minimum ? h : -h;
    steps = {0, inwards, 2 * inwards};
    stencil.factors = {-1.5 / inwards, 2 / inwards, -0.5 / inwards};
  }
  for (const double step : steps) {
    Eigen::VectorXd q = at;
    q[static_cast<Eigen::Index>(index)] += step;
    absl::StatusOr<EvaluatedDesign> beside = function.Evaluate(q);
    if (!beside.ok()) {
      // What is counted by a whole number has no design beside it, and stays as it is.
      if (parametric::IsWhole(parameter)) return Stencil{{design}, {0}};
      return beside.status();
    }
    EvaluatedDesign moved = *std::move(beside);
    if (!IsAlike(design, moved)) {
      return PreconditionFailed(
          kReason, absl::StrCat("a small change of ", parameter.name, " changes its parts"),
          parameter.name);
    }
    stencil.designs.push_back(std::move(moved));
  }
  return stencil;
}

// Where the axes of a prism's outline lie in space.
std::array<int, 2> OutlineAxes(parametric::Axis axis) {
  const int along = static_cast<int>(axis);
  return {(along + 1) % 3, (along + 2) % 3};
}

Eigen::Vector3d OutlinePoint(const EvaluatedPart& part, Eigen::Index i) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  const auto [u, v] = OutlineAxes(part.axis);
  point[u] = part.outline(0, i);
  point[v] = part.outline(1, i);
  return point;
}

// The faces of a part at rest, without velocities.
std::vector<FaceMotion> FacesOf(const EvaluatedPart& part, int index, Eigen::Index parameters) {
  const Eigen::Matrix3Xd still = Eigen::Matrix3Xd::Zero(3, parameters);
  const Eigen::Index edges = part.outline.cols();
  std::vector<FaceMotion> faces;
  for (Eigen::Index f = 0; f < edges + 2; ++f) {
    FaceMotion face{.face = {index, part.face_names[static_cast<std::size_t>(f)]},
                    .start_velocity = still,
                    .end_velocity = still};
    if (f >= edges) {
      face.prescribed[static_cast<std::size_t>(part.axis)] = true;
    } else {
      face.start = OutlinePoint(part, f);
      face.to_end = OutlinePoint(part, (f + 1) % edges) - face.start;
      for (const int axis : OutlineAxes(part.axis)) {
        face.prescribed[static_cast<std::size_t>(axis)] = true;
      }
    }
    faces.push_back(std::move(face));
  }
  return faces;
}

// Area (m²) and centroid (m) of each face of a prism: 4 × faces.
Eigen::Matrix4Xd FaceShapes(const EvaluatedPart& part) {
  const Eigen::Index edges = part.outline.cols();
  Eigen::Matrix4Xd shapes(4, edges + 2);
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(static_cast<int>(part.axis));
  for (Eigen::Index f = 0; f < edges; ++f) {
    const Eigen::Vector3d start = OutlinePoint(part, f);
    const Eigen::Vector3d end = OutlinePoint(part, (f + 1) % edges);
    shapes(0, f) = (end - start).norm() * std::abs(part.to - part.from);
    shapes.col(f).tail<3>() = (start + end) / 2 + (part.from + part.to) / 2 * along;
  }
  // From triangles about the first point, which may be negative.
  const Eigen::Vector3d first = OutlinePoint(part, 0);
  double area = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index f = 1; f + 1 < edges; ++f) {
    const Eigen::Vector3d a = OutlinePoint(part, f) - first, b = OutlinePoint(part, f + 1) - first;
    const double piece = a.cross(b).dot(along) / 2;
    area += piece;
    moment += piece * (a + b) / 3;
  }
  for (const Eigen::Index cap : {edges, edges + 1}) {
    shapes(0, cap) = std::abs(area);
    shapes.col(cap).tail<3>() =
        first + moment / area + (cap == edges ? part.from : part.to) * along;
  }
  return shapes;
}

// The same faces at rest, as shapes.
std::vector<FaceShapeMotion> ShapesOf(const EvaluatedPart& part, int index,
                                      Eigen::Index parameters) {
  const Eigen::Matrix4Xd known = FaceShapes(part);
  std::vector<FaceShapeMotion> shapes;
  for (Eigen::Index f = 0; f < known.cols(); ++f) {
    shapes.push_back({.face = {index, part.face_names[static_cast<std::size_t>(f)]},
                      .centroid = known.col(f).tail<3>(),
                      .area_rate = Eigen::VectorXd::Zero(parameters),
                      .centroid_rate = Eigen::Matrix3Xd::Zero(3, parameters)});
  }
  return shapes;
}

// Along an edge that lies along an axis and stays so, nodes may slide.
void LetSlide(FaceMotion& face) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!face.prescribed[static_cast<std::size_t>(axis)]) continue;
    const bool is_across = std::abs(face.to_end[axis]) < kAcross;
    const double turn =
        (face.end_velocity.row(axis) - face.start_velocity.row(axis)).cwiseAbs().maxCoeff();
    if (!is_across || turn > 1e-6) continue;
    face.prescribed = {};
    face.prescribed[static_cast<std::size_t>(axis)] = true;
    return;
  }
}

void AddRates(const Stencil& stencil, std::size_t part, Eigen::Index parameter,
              std::vector<FaceMotion>& faces, std::vector<FaceShapeMotion>& shapes) {
  const auto part_of = [part](const EvaluatedDesign& design) -> const EvaluatedPart& {
    return *BearingParts(design)[part];
  };
  const EvaluatedPart& at_rest = part_of(stencil.designs[0]);
  const auto edges = at_rest.outline.cols();
  const Eigen::Matrix2Xd outline = stencil.Rate(
      [&](const EvaluatedDesign& design) { return Eigen::Matrix2Xd(part_of(design).outline); });
  const Eigen::Matrix4Xd shape_rates =
      stencil.Rate([&](const EvaluatedDesign& design) { return FaceShapes(part_of(design)); });
  for (Eigen::Index f = 0; f < edges + 2; ++f) {
    FaceShapeMotion& shape = shapes[static_cast<std::size_t>(f)];
    shape.area_rate[parameter] = shape_rates(0, f);
    shape.centroid_rate.col(parameter) = shape_rates.col(f).tail<3>();
  }
  const auto [u, v] = OutlineAxes(at_rest.axis);
  for (Eigen::Index f = 0; f < edges; ++f) {
    FaceMotion& face = faces[static_cast<std::size_t>(f)];
    face.start_velocity(u, parameter) = outline(0, f);
    face.start_velocity(v, parameter) = outline(1, f);
    face.end_velocity(u, parameter) = outline(0, (f + 1) % edges);
    face.end_velocity(v, parameter) = outline(1, (f + 1) % edges);
  }
  const auto along = static_cast<Eigen::Index>(at_rest.axis);
  const double from =
      stencil.Rate([&](const EvaluatedDesign& design) { return part_of(design).from; });
  const double to = stencil.Rate([&](const EvaluatedDesign& design) { return part_of(design).to; });
  FaceMotion& base = faces[static_cast<std::size_t>(edges)];
  FaceMotion& cap = faces[static_cast<std::size_t>(edges) + 1];
  base.start_velocity(along, parameter) = base.end_velocity(along, parameter) = from;
  cap.start_velocity(along, parameter) = cap.end_velocity(along, parameter) = to;
}

// The numbers of all loads as one vector, and back.
Eigen::VectorXd NumbersOf(const LoadCase& loads) {
  std::vector<double> numbers(loads.gravity.begin(), loads.gravity.end());
  for (const FaceForce& force : loads.forces) {
    numbers.insert(numbers.end(), force.force.begin(), force.force.end());
  }
  for (const FacePressure& pressure : loads.pressures) numbers.push_back(pressure.pressure);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

void SetNumbers(const Eigen::VectorXd& numbers, LoadCase& loads) {
  Eigen::Index next = 3;
  loads.gravity = numbers.head<3>();
  for (FaceForce& force : loads.forces) {
    force.force = numbers.segment<3>(next);
    next += 3;
  }
  for (FacePressure& pressure : loads.pressures) pressure.pressure = numbers[next++];
}

// The loads of a design, those of all load cases first.
absl::StatusOr<DesignModel> LoadsOf(const EvaluatedDesign& design) {
  EvaluatedDesign bearing = design;
  std::erase_if(bearing.parts, [](const EvaluatedPart& part) { return part.connecting; });
  DesignModel loads;
  MORTISE_RETURN_IF_ERROR(AddConditions(bearing, loads));
  return loads;
}

absl::StatusOr<DesignModel> LoadRates(const Stencil& stencil) {
  std::vector<DesignModel> models;
  for (const EvaluatedDesign& design : stencil.designs) {
    MORTISE_ASSIGN_OR_RETURN(models.emplace_back(), LoadsOf(design));
  }
  DesignModel rates = models[0];
  const auto differentiate = [&](const auto& of) {
    Eigen::VectorXd rate = stencil.factors[0] * NumbersOf(of(models[0]));
    for (std::size_t i = 1; i < models.size(); ++i) {
      rate += stencil.factors[i] * NumbersOf(of(models[i]));
    }
    return rate;
  };
  SetNumbers(
      differentiate([](const DesignModel& model) -> const LoadCase& { return model.analysis; }),
      rates.analysis);
  for (std::size_t c = 0; c < rates.load_cases.size(); ++c) {
    SetNumbers(differentiate([c](const DesignModel& model) -> const LoadCase& {
                 return model.load_cases[c].loads;
               }),
               rates.load_cases[c].loads);
  }
  return rates;
}

}  // namespace

bool IsMadeOfPrisms(const EvaluatedDesign& design) {
  return std::none_of(design.parts.begin(), design.parts.end(), [](const EvaluatedPart& part) {
    return !part.connecting && part.faceted.has_value();
  });
}

absl::StatusOr<DesignMotion> MotionOf(const templates::Template& function,
                                      const Eigen::VectorXd& parameters,
                                      const EvaluatedDesign& design, const DesignModel& model) {
  if (!IsMadeOfPrisms(design)) {
    return PreconditionFailed(kReason, "it has parts that are no prisms", "parts");
  }
  const std::vector<const EvaluatedPart*> parts = BearingParts(design);
  std::vector<std::vector<FaceMotion>> faces;
  std::vector<std::vector<FaceShapeMotion>> shapes;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    faces.push_back(FacesOf(*parts[p], static_cast<int>(p), parameters.size()));
    shapes.push_back(ShapesOf(*parts[p], static_cast<int>(p), parameters.size()));
  }
  DesignMotion motion;
  motion.mass = motion.volume = Eigen::VectorXd::Zero(parameters.size());
  for (Eigen::Index k = 0; k < parameters.size(); ++k) {
    MORTISE_ASSIGN_OR_RETURN(const Stencil stencil,
                             StencilOf(function, parameters, design, static_cast<std::size_t>(k)));
    for (std::size_t p = 0; p < parts.size(); ++p) {
      AddRates(stencil, p, k, faces[p], shapes[p]);
      const double volume =
          stencil.Rate([p](const EvaluatedDesign& of) { return BearingParts(of)[p]->volume; });
      motion.volume[k] += volume;
      motion.mass[k] += volume * model.analysis.materials[p].density;
    }
    MORTISE_ASSIGN_OR_RETURN(motion.load_rates.emplace_back(), LoadRates(stencil));
  }
  for (std::vector<FaceMotion>& of_part : faces) {
    for (FaceMotion& face : of_part) {
      LetSlide(face);
      motion.faces.push_back(std::move(face));
    }
  }
  for (std::vector<FaceShapeMotion>& of_part : shapes) {
    for (FaceShapeMotion& shape : of_part) motion.shapes.push_back(std::move(shape));
  }
  return motion;
}

bool HasConstantSupports(const EvaluatedDesign& design) {
  using Kind = parametric::BoundaryConditionKind;
  return !design.reference_temperature &&
         std::none_of(design.boundary_conditions.begin(), design.boundary_conditions.end(),
                      [](const parametric::EvaluatedBoundaryCondition& condition) {
                        const auto& moved = condition.displacement;
                        return condition.kind == Kind::kRotation ||
                               std::any_of(moved.begin(), moved.end(), [](const auto& along) {
                                 return along.value_or(0) != 0;
                               });
                      });
}

OfferedGradients GradientsOf(const templates::Template& function, bool is_of_prisms) {
  OfferedGradients offered{.mass = function.OffersMassGradient()};
  if (!is_of_prisms) return offered;
  const auto design = function.Evaluate(parametric::Defaults(function.parameters()));
  offered.shape = design.ok() && IsMadeOfPrisms(*design);
  offered.loads = offered.shape && HasConstantSupports(*design);
  offered.mass = offered.mass || offered.shape;
  return offered;
}

DesignMotion KnownMotion(const templates::Template& function, const Eigen::VectorXd& parameters,
                         const EvaluatedDesign& design, const DesignModel& model) {
  DesignMotion known;
  if (auto motion = MotionOf(function, parameters, design, model); motion.ok()) {
    known = *std::move(motion);
  }
  if (!function.OffersMassGradient()) return known;
  if (const auto mass = function.Mass(parameters); mass.ok()) {
    known.mass = mass->mass_gradient;
    known.volume = mass->volume_gradient;
  }
  return known;
}

}  // namespace mortise::simulator
