#include "common/fem/stress/patch_recovery.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "common/fem/elements/shape_functions.h"
#include "common/mesh/element_faces.h"

namespace mortise::simulator {
namespace {

constexpr int kLinearTerms = 4;
constexpr int kQuadraticTerms = 10;
constexpr int kRings = 3;  // of neighbours that may join a patch

// Samples wanted: enough to average out what is not smooth. A node inside a mesh of linear elements
// has about 24 elements; with the half of them that a node on a side has, the extrapolation to the
// surface amplifies the differences between neighbours. So do eight quadratic ones round an edge
// that goes straight inwards, to 1 % of the stress.
constexpr int kLinearSamples = 24;
constexpr int kQuadraticSamples = 40;

// Pivots of a fit smaller than this, next to the largest, do not determine it.
constexpr double kMinPivot = 1e-7;

using Terms = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kQuadraticTerms, 1>;
using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kQuadraticTerms, 6>;
using Square =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kQuadraticTerms, kQuadraticTerms>;

// A polynomial about a corner node.
struct Patch {
  Eigen::Vector3d centre;
  double scale = 1;  // m
  Coefficients coefficients;
};

// 1, x, y, z and, of ten, x², y², z², xy, yz, xz.
Terms Monomials(const Eigen::Vector3d& x, int count) {
  Terms terms(count);
  terms.head<4>() << 1, x;
  if (count == kQuadraticTerms) {
    terms.tail<6>() << x.cwiseAbs2(), x.x() * x.y(), x.y() * x.z(), x.x() * x.z();
  }
  return terms;
}

// Integration points of all elements: 3 × (points · elements), m.
Eigen::Matrix3Xd SamplePositions(const mesh::TetrahedralMesh& mesh) {
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  Eigen::Matrix3Xd places(3, rule.size() * mesh.tetrahedra.cols());
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    for (std::size_t p = 0; p < rule.size(); ++p) {
      places.col(rule.size() * e + p) = positions * TetrahedronShape(rule[p].barycentric, nodes);
    }
  }
  return places;
}

// The elements round the slot and as many rings of neighbours in its part as give `wanted` samples.
std::vector<int> PatchElements(const PartNodes& nodes, int slot, int points, int wanted) {
  std::vector<int> elements(nodes.begin(slot), nodes.end(slot));
  for (int ring = 1; ring < kRings && points * static_cast<int>(elements.size()) < wanted; ++ring) {
    const std::vector<int> inner = elements;
    for (const int e : inner) {
      for (int k = 0; k < 4; ++k) {
        const int neighbour = nodes.element_slots()(k, e);
        elements.insert(elements.end(), nodes.begin(neighbour), nodes.end(neighbour));
      }
    }
    std::sort(elements.begin(), elements.end());
    elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
  }
  return elements;
}

// Least squares with `terms` terms; false if the samples do not determine them.
bool Fit(const std::vector<int>& elements, int points, const Eigen::Matrix3Xd& places,
         const Stresses& at_points, int terms, Patch& patch) {
  if (points * static_cast<int>(elements.size()) < terms) return false;
  Square normal = Square::Zero(terms, terms);
  Coefficients right = Coefficients::Zero(terms, 6);
  for (const int e : elements) {
    for (int k = points * e; k < points * (e + 1); ++k) {
      const Terms row = Monomials((places.col(k) - patch.centre) / patch.scale, terms);
      normal += row * row.transpose();
      right += row * at_points.col(k).transpose();
    }
  }
  const Eigen::LDLT<Square> solver(normal);
  const auto pivots = solver.vectorD();
  if (!(pivots.minCoeff() > kMinPivot * pivots.maxCoeff())) return false;
  patch.coefficients = solver.solve(right);
  return true;
}

// The samples round a corner, and how to write their places as numbers of about 1.
struct PatchSamples {
  std::vector<int> elements;
  int points = 1;  // of each element
  int terms = kLinearTerms;
  Eigen::Vector3d centre;
  double scale = 1;  // m
};

PatchSamples SamplesOf(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes, int slot,
                       const Eigen::Matrix3Xd& places) {
  const bool quadratic = mesh.IsQuadratic();
  PatchSamples samples;
  samples.points = quadratic ? 4 : 1;
  samples.terms = quadratic ? kQuadraticTerms : kLinearTerms;
  samples.elements =
      PatchElements(nodes, slot, samples.points, quadratic ? kQuadraticSamples : kLinearSamples);
  samples.centre = mesh.nodes.col(nodes.node(slot));
  double size = 0;
  for (const int e : samples.elements) {
    for (int k = samples.points * e; k < samples.points * (e + 1); ++k) {
      size = std::max(size, (places.col(k) - samples.centre).norm());
    }
  }
  samples.scale = size > 0 ? size : 1;
  return samples;
}

Patch FitPatch(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes, int slot,
               const Eigen::Matrix3Xd& places, const Stresses& at_points) {
  const PatchSamples samples = SamplesOf(mesh, nodes, slot, places);
  const std::vector<int>& elements = samples.elements;
  const int points = samples.points;
  Patch patch;
  patch.centre = samples.centre;
  patch.scale = samples.scale;
  for (const int count : {samples.terms, kLinearTerms}) {
    if (Fit(elements, points, places, at_points, count, patch)) return patch;
  }
  patch.coefficients = Coefficients::Zero(1, 6);
  for (const int e : elements) {
    for (int k = points * e; k < points * (e + 1); ++k) {
      patch.coefficients += at_points.col(k).transpose() / (points * double(elements.size()));
    }
  }
  return patch;
}

Eigen::Matrix<double, 6, 1> Evaluate(const Patch& patch, const Eigen::Vector3d& place) {
  const int terms = static_cast<int>(patch.coefficients.rows());
  if (terms == 1) return patch.coefficients.row(0).transpose();
  return patch.coefficients.transpose() * Monomials((place - patch.centre) / patch.scale, terms);
}

using TermsByPlace = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kQuadraticTerms, 3>;

// The derivatives of Monomials.
TermsByPlace MonomialsByPlace(const Eigen::Vector3d& x, int count) {
  TermsByPlace by_place = TermsByPlace::Zero(count, 3);
  if (count == 1) return by_place;
  by_place.block<3, 3>(1, 0).setIdentity();
  if (count == kQuadraticTerms) {
    by_place.block<3, 3>(4, 0).diagonal() = 2 * x;
    by_place.row(7) << x.y(), x.x(), 0;
    by_place.row(8) << 0, x.z(), x.y();
    by_place.row(9) << x.z(), 0, x.x();
  }
  return by_place;
}

Terms TermsAt(const Eigen::Vector3d& x, int count) {
  return count == 1 ? Terms::Ones(1) : Monomials(x, count);
}

// The equations of a fit with as many terms as its samples determine, as FitPatch finds them; of
// one term, their mean, at least.
struct FitEquations {
  int terms = 1;
  Eigen::LDLT<Square> solver;
};

FitEquations EquationsOf(const PatchSamples& samples, const Eigen::Matrix3Xd& places) {
  FitEquations equations;
  const int count = samples.points * static_cast<int>(samples.elements.size());
  for (const int terms : {samples.terms, kLinearTerms, 1}) {
    if (count < terms) continue;
    Square normal = Square::Zero(terms, terms);
    for (const int e : samples.elements) {
      for (int k = samples.points * e; k < samples.points * (e + 1); ++k) {
        const Terms row = TermsAt((places.col(k) - samples.centre) / samples.scale, terms);
        normal += row * row.transpose();
      }
    }
    equations.terms = terms;
    equations.solver.compute(normal);
    const auto pivots = equations.solver.vectorD();
    if (terms == 1 || pivots.minCoeff() > kMinPivot * pivots.maxCoeff()) break;
  }
  return equations;
}

// Adds `share` of what the patch of a corner gives at `place`. With the fit's rows r, values s and
// coefficients c = N⁻¹ Σ r s, N = Σ r rᵀ, the value is m·c, m the terms at `place`, and with
// h = N⁻¹ m its change is Σ (r'·h)(s − r·c) − (r·h)(r'·c) + m'·c. Centre and scale may be taken as
// constant: polynomials are the same about any other.
void AddPatchValue(const PatchSamples& samples, const Eigen::Matrix3Xd& places,
                   const Eigen::VectorXd& at_points, const Eigen::Vector3d& place, double share,
                   RecoveredValue& value) {
  const FitEquations equations = EquationsOf(samples, places);
  const auto local = [&samples](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return (x - samples.centre) / samples.scale;
  };
  std::vector<int> points;
  for (const int e : samples.elements) {
    for (int k = samples.points * e; k < samples.points * (e + 1); ++k) points.push_back(k);
  }
  const Terms at_place = TermsAt(local(place), equations.terms);
  Terms right = Terms::Zero(equations.terms);
  for (const int k : points) right += at_points[k] * TermsAt(local(places.col(k)), equations.terms);
  const Terms coefficients = equations.solver.solve(right);
  const Terms influence = equations.solver.solve(at_place);
  const auto first = static_cast<Eigen::Index>(value.points.size());
  value.by_place.conservativeResize(3, first + static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d at = local(places.col(points[i]));
    const Terms row = TermsAt(at, equations.terms);
    const double weight = row.dot(influence);
    const double rest = at_points[points[i]] - row.dot(coefficients);
    value.points.push_back(points[i]);
    value.weights.push_back(share * weight);
    value.by_place.col(first + static_cast<Eigen::Index>(i)) =
        share / samples.scale * MonomialsByPlace(at, equations.terms).transpose() *
        (rest * influence - weight * coefficients);
  }
  value.value += share * at_place.dot(coefficients);
  value.by_node += share / samples.scale *
                   MonomialsByPlace(local(place), equations.terms).transpose() * coefficients;
}

// Which of an element's nodes a slot is.
int PlaceIn(const PartNodes& nodes, int element, int slot) {
  int place = 0;
  while (nodes.element_slots()(place, element) != slot) ++place;
  return place;
}

// The corners whose patches say what a slot has: itself, or of the middle of an edge its ends; none
// if it or all of them are on the surface.
std::vector<int> PatchCentres(const PartNodes& nodes, const PartSurface& surface, int slot) {
  if (!surface.At(slot).empty()) return {};
  const int e = *nodes.begin(slot);
  const int place = PlaceIn(nodes, e, slot);
  if (place < 4) return {slot};
  std::vector<int> centres;
  for (const int end : mesh::kTetrahedronEdges[place - 4]) {
    const int corner = nodes.element_slots()(end, e);
    if (surface.At(corner).empty()) centres.push_back(corner);
  }
  return centres;
}

struct WeightedPoint {
  int index = 0;  // of an integration point
  double weight = 0;
};

// The mean over the elements round a slot of what each has there: its stress, or of quadratic
// elements what is linear and has the values of its four points at these.
std::vector<WeightedPoint> MeanAt(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes,
                                  int slot) {
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  const int points = static_cast<int>(rule.size());
  const double share = 1.0 / static_cast<double>(nodes.end(slot) - nodes.begin(slot));
  std::vector<WeightedPoint> mean;
  for (const int* e = nodes.begin(slot); e != nodes.end(slot); ++e) {
    if (points == 1) {
      mean.push_back({*e, share});
      continue;
    }
    const int place = PlaceIn(nodes, *e, slot);
    Eigen::Vector4d l = Eigen::Vector4d::Zero();
    if (place < 4) {
      l[place] = 1;
    } else {
      for (const int end : mesh::kTetrahedronEdges[place - 4]) l[end] = 0.5;
    }
    // Of the points' coordinates, one is 1 − 3 a and the others a.
    const double a = rule[0].barycentric[1];
    for (int p = 0; p < points; ++p) {
      mean.push_back({points * *e + p, share * (l[p] - a) / (1 - 4 * a)});
    }
  }
  return mean;
}

}  // namespace

Stresses RecoverByPatches(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes,
                          const PartSurface& surface, const Stresses& at_points, ThreadTeam& team) {
  const Eigen::Matrix3Xd places = SamplePositions(mesh);
  const Eigen::MatrixXi& slots = nodes.element_slots();
  // Which patch belongs to a slot: only corners inside have one.
  std::vector<int> patch_of(nodes.size(), -1), patch_slots;
  for (Eigen::Index e = 0; e < slots.cols(); ++e) {
    for (int k = 0; k < 4; ++k) {
      if (patch_of[slots(k, e)] >= 0 || !surface.At(slots(k, e)).empty()) continue;
      patch_of[slots(k, e)] = static_cast<int>(patch_slots.size());
      patch_slots.push_back(slots(k, e));
    }
  }
  std::vector<Patch> patches(patch_slots.size());
  team.ForRanges(static_cast<int>(patches.size()), [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      patches[p] = FitPatch(mesh, nodes, patch_slots[p], places, at_points);
    }
  });
  Stresses recovered(6, nodes.size());
  team.ForRanges(nodes.size(), [&](int begin, int end) {
    for (int slot = begin; slot < end; ++slot) {
      recovered.col(slot).setZero();
      const std::vector<int> centres = PatchCentres(nodes, surface, slot);
      for (const int centre : centres) {
        recovered.col(slot) +=
            Evaluate(patches[patch_of[centre]], mesh.nodes.col(nodes.node(slot))) /
            static_cast<double>(centres.size());
      }
      if (!centres.empty()) continue;
      for (const WeightedPoint& point : MeanAt(mesh, nodes, slot)) {
        recovered.col(slot) += point.weight * at_points.col(point.index);
      }
    }
  });
  return recovered;
}

RecoveredValue RecoverAt(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes,
                         const PartSurface& surface, int slot, const Eigen::VectorXd& at_points) {
  const Eigen::Matrix3Xd places = SamplePositions(mesh);
  RecoveredValue value;
  const std::vector<int> centres = PatchCentres(nodes, surface, slot);
  for (const int centre : centres) {
    AddPatchValue(SamplesOf(mesh, nodes, centre, places), places, at_points,
                  mesh.nodes.col(nodes.node(slot)), 1.0 / static_cast<double>(centres.size()),
                  value);
  }
  if (!centres.empty()) return value;
  for (const WeightedPoint& point : MeanAt(mesh, nodes, slot)) {
    value.value += point.weight * at_points[point.index];
    value.points.push_back(point.index);
    value.weights.push_back(point.weight);
  }
  value.by_place = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(value.points.size()));
  return value;
}

}  // namespace mortise::simulator
