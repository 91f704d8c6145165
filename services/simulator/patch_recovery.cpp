#include "services/simulator/patch_recovery.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "common/mesh/element_faces.h"
#include "services/simulator/shape_functions.h"

namespace mortise::simulator {
namespace {

constexpr int kLinearTerms = 4;
constexpr int kQuadraticTerms = 10;
constexpr int kRings = 3;  // of neighbours that may join a patch

// Samples wanted: enough to average out what is not smooth. A node inside a mesh of linear elements
// has about 24 elements; with the half of them that a node on a side has, the extrapolation to the
// surface amplifies the differences between neighbours.
constexpr int kLinearSamples = 24;
constexpr int kQuadraticSamples = 30;

using Terms = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kQuadraticTerms, 1>;
using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kQuadraticTerms, 6>;

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
  using Square =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kQuadraticTerms, kQuadraticTerms>;
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
  if (!(pivots.minCoeff() > 1e-7 * pivots.maxCoeff())) return false;
  patch.coefficients = solver.solve(right);
  return true;
}

Patch FitPatch(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes, int slot,
               const Eigen::Matrix3Xd& places, const Stresses& at_points) {
  const bool quadratic = mesh.IsQuadratic();
  const int points = quadratic ? 4 : 1, terms = quadratic ? kQuadraticTerms : kLinearTerms;
  const std::vector<int> elements =
      PatchElements(nodes, slot, points, quadratic ? kQuadraticSamples : kLinearSamples);
  Patch patch;
  patch.centre = mesh.nodes.col(nodes.node(slot));
  double size = 0;
  for (const int e : elements) {
    for (int k = points * e; k < points * (e + 1); ++k) {
      size = std::max(size, (places.col(k) - patch.centre).norm());
    }
  }
  patch.scale = size > 0 ? size : 1;
  for (const int count : {terms, kLinearTerms}) {
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

}  // namespace

PartNodes::PartNodes(const mesh::TetrahedralMesh& mesh) {
  const int nodes = static_cast<int>(mesh.nodes.cols());
  const int corners = static_cast<int>(mesh.tetrahedra.rows());
  const int elements = static_cast<int>(mesh.tetrahedra.cols());
  // The slots of a node form a chain, in the order in which its parts are met.
  std::vector<int> head(nodes, -1), next;
  element_slots_.resize(corners, elements);
  for (int e = 0; e < elements; ++e) {
    for (int k = 0; k < corners; ++k) {
      const int node = mesh.tetrahedra(k, e);
      int slot = head[node];
      while (slot >= 0 && part_[slot] != mesh.part[e]) slot = next[slot];
      if (slot < 0) {
        slot = size();
        node_.push_back(node);
        part_.push_back(mesh.part[e]);
        next.push_back(head[node]);
        head[node] = slot;
      }
      element_slots_(k, e) = slot;
    }
  }
  first_.assign(size() + 1, 0);
  for (Eigen::Index k = 0; k < element_slots_.size(); ++k) ++first_[element_slots_.data()[k] + 1];
  for (int slot = 0; slot < size(); ++slot) first_[slot + 1] += first_[slot];
  around_.resize(element_slots_.size());
  std::vector<int> place(first_.begin(), first_.end() - 1);
  for (int e = 0; e < elements; ++e) {
    for (int k = 0; k < corners; ++k) around_[place[element_slots_(k, e)]++] = e;
  }
}

Stresses RecoverByPatches(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes,
                          const Stresses& at_points, ThreadTeam& team) {
  const Eigen::Matrix3Xd places = SamplePositions(mesh);
  const Eigen::MatrixXi& slots = nodes.element_slots();
  // Which patch belongs to a slot: only corners have one.
  std::vector<int> patch_of(nodes.size(), -1), corner_slots;
  for (Eigen::Index e = 0; e < slots.cols(); ++e) {
    for (int k = 0; k < 4; ++k) {
      if (patch_of[slots(k, e)] >= 0) continue;
      patch_of[slots(k, e)] = static_cast<int>(corner_slots.size());
      corner_slots.push_back(slots(k, e));
    }
  }
  std::vector<Patch> patches(corner_slots.size());
  team.ForRanges(static_cast<int>(patches.size()), [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      patches[p] = FitPatch(mesh, nodes, corner_slots[p], places, at_points);
    }
  });
  Stresses recovered(6, nodes.size());
  team.ForRanges(nodes.size(), [&](int begin, int end) {
    for (int slot = begin; slot < end; ++slot) {
      const Eigen::Vector3d place = mesh.nodes.col(nodes.node(slot));
      if (patch_of[slot] >= 0) {
        recovered.col(slot) = Evaluate(patches[patch_of[slot]], place);
        continue;
      }
      const int e = *nodes.begin(slot);
      int edge = 0;
      while (slots(4 + edge, e) != slot) ++edge;
      const auto [a, b] = mesh::kTetrahedronEdges[edge];
      recovered.col(slot) = 0.5 * (Evaluate(patches[patch_of[slots(a, e)]], place) +
                                   Evaluate(patches[patch_of[slots(b, e)]], place));
    }
  });
  return recovered;
}

}  // namespace mortise::simulator
