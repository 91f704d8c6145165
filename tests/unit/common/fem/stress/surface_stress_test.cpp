// Stress at the nodes of a part's surface, from the strain along it and the traction on it.
#include "common/fem/stress/surface_stress.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "common/fem/stress/stress_derivative.h"
#include "common/fem/stress/stress_recovery.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Material Wood() {
  Material wood = Steel();
  wood.orthotropy = Orthotropy{.youngs_modulus = {11e9, 0.9e9, 0.5e9},
                               .poissons_ratio = {0.4, 0.5, 0.45},
                               .shear_modulus = {0.7e9, 0.05e9, 0.6e9},
                               .axes = GrainAxes({1, 0.4, 0.2}, {0, 0, 1})};
  return wood;
}

Eigen::Matrix3Xd RandomField(Eigen::Index count, unsigned seed) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<double> spread(-1, 1);
  Eigen::Matrix3Xd field(3, count);
  for (double& value : field.reshaped()) value = spread(bits);
  return field;
}

double Dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a.array() * b.array()).sum();
}

// A displacement of second order and its stress.
struct QuadraticField {
  Material material;
  Matrix3d linear;
  std::array<Matrix3d, 3> quadratic;  // u_i = linear_i x + x · quadratic_i x

  static QuadraticField Random(const Material& material, bool has_second_order) {
    QuadraticField field{material, 1e-3 * RandomField(3, 1), {}};
    for (int i = 0; i < 3; ++i) {
      const Matrix3d any = 1e-3 * RandomField(3, 2 + i);
      field.quadratic[i] = has_second_order ? Matrix3d(any + any.transpose()) : Matrix3d::Zero();
    }
    return field;
  }

  Vector3d Displacement(const Vector3d& x) const {
    Vector3d u = linear * x;
    for (int i = 0; i < 3; ++i) u[i] += x.dot(quadratic[i] * x);
    return u;
  }

  Vector6d Stress(const Vector3d& x) const {
    Matrix3d g = linear;
    for (int i = 0; i < 3; ++i) g.row(i) += 2 * (quadratic[i] * x).transpose();
    return StiffnessMatrix(material) * StrainOf(g);
  }
};

// A body whose displacements and tractions are those of a field.
struct Body {
  mesh::TetrahedralMesh mesh;
  std::vector<Material> materials;
  Eigen::Matrix3Xd displacement;
  PartNodes nodes;
  PartSurface surface;
  SurfaceTraction traction;
  Eigen::VectorXd cold = {};

  Body(mesh::TetrahedralMesh of, const QuadraticField& field)
      : mesh(std::move(of)),
        materials{field.material},
        displacement(3, mesh.nodes.cols()),
        nodes(mesh),
        surface(mesh, nodes) {
    for (Eigen::Index v = 0; v < mesh.nodes.cols(); ++v) {
      displacement.col(v) = field.Displacement(mesh.nodes.col(v));
    }
    const Eigen::Index places = surface.nodes().rows();
    traction.at_nodes.resize(3, places * surface.size());
    for (int face = 0; face < surface.size(); ++face) {
      const GradientMatrix at = FacePositions(mesh, surface, face);
      for (int k = 0; k < places; ++k) {
        traction.at_nodes.col(places * face + k) =
            StressTensor(field.Stress(at.col(k))) *
            TriangleAreaVector(at, FacePlace(k)).normalized();
      }
    }
  }

  DeformedBody Deformed() const { return {mesh, materials, displacement, cold, traction}; }

  Stresses Recovered() const {
    ThreadTeam alone(1);
    return RecoverAtSlots(Deformed(), nodes, surface, alone);
  }
};

mesh::TetrahedralMesh StraightBox(bool quadratic) {
  mesh::TetrahedralMesh mesh = BoxMesh({0.5, 0.4, 0.3}, {4, 3, 3}, false);
  mesh::Shake(mesh, 0.02, 5);
  return quadratic ? mesh::MakeQuadratic(mesh) : mesh;
}

constexpr double kInner = 0.1, kOuter = 0.15, kHeight = 0.05;

// A quarter of a ring whose facets turn by 18 degrees, and whose quadratic elements are straight.
mesh::TetrahedralMesh FacetedRing(bool quadratic) {
  mesh::MappedBox ring;
  ring.ticks = {mesh::Ticks(2), mesh::Ticks(5), mesh::Ticks(2)};
  ring.place = [](const Vector3d& p) -> Vector3d {
    const double radius = kInner + (kOuter - kInner) * p.x(), angle = p.y() * M_PI / 2;
    return {radius * std::cos(angle), radius * std::sin(angle), kHeight * p.z()};
  };
  const mesh::TetrahedralMesh mesh = mesh::MeshMappedBox(ring, false);
  return quadratic ? mesh::MakeQuadratic(mesh) : mesh;
}

// Takes faces that are in x = 0 or y = 0 for planes of symmetry.
void Mirror(Body& body) {
  const Eigen::Index places = body.surface.nodes().rows();
  body.traction.mirrors.resize(static_cast<std::size_t>(body.surface.size()));
  for (int face = 0; face < body.surface.size(); ++face) {
    const GradientMatrix at = FacePositions(body.mesh, body.surface, face);
    const bool is_mirror =
        at.topRows<2>().cwiseAbs().rowwise().maxCoeff().minCoeff() < 1e-9 * kInner;
    body.traction.mirrors[static_cast<std::size_t>(face)] = is_mirror;
    if (is_mirror) body.traction.at_nodes.middleCols(places * face, places).setConstant(NAN);
  }
}

class RecoveredStress : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Elements, RecoveredStress, ::testing::Bool(),
                         [](const auto& which) { return which.param ? "Quadratic" : "Linear"; });

// What elements represent exactly is recovered exactly at every node: in the middle of faces, on
// edges, in corners and inside.
TEST_P(RecoveredStress, ReproducesTheFieldsOfElements) {
  for (const Material& material : {Steel(), Wood()}) {
    const QuadraticField field = QuadraticField::Random(material, GetParam());
    const Body body(StraightBox(GetParam()), field);
    const Stresses recovered = body.Recovered();
    const double scale = field.Stress({0.5, 0.4, 0.3}).norm();
    for (int slot = 0; slot < body.nodes.size(); ++slot) {
      const Vector3d at = body.mesh.nodes.col(body.nodes.node(slot));
      EXPECT_LT((recovered.col(slot) - field.Stress(at)).norm(), 1e-10 * scale)
          << "at " << at.transpose();
    }
  }
}

// Whatever the displacements, the stress balances the traction: on faces, and on both sides of the
// edges between them.
TEST_P(RecoveredStress, BalancesTheTractionWhateverTheDisplacements) {
  Body body(StraightBox(GetParam()), QuadraticField::Random(Wood(), true));
  body.displacement += 1e-4 * RandomField(body.mesh.nodes.cols(), 9);
  body.traction.at_nodes.setZero();
  const Stresses recovered = body.Recovered();
  const double scale = recovered.cwiseAbs().maxCoeff();
  int on_faces = 0, on_edges = 0;
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    const auto faces = body.surface.At(slot);
    if (faces.empty()) continue;
    // In corners three edges meet, of which each balances two faces.
    const Eigen::Array3d at = body.mesh.nodes.col(body.nodes.node(slot));
    const Eigen::Array3d far = Eigen::Array3d(0.5, 0.4, 0.3) - at;
    const auto sides = (at.min(far) < 1e-9).count();
    if (sides == 3) continue;
    ++(sides == 2 ? on_edges : on_faces);
    for (const FaceNode& face : faces) {
      const Vector3d normal = TriangleAreaVector(FacePositions(body.mesh, body.surface, face.face),
                                                 FacePlace(face.place))
                                  .normalized();
      EXPECT_LT((StressTensor(recovered.col(slot)) * normal).norm(), 1e-9 * scale);
    }
  }
  EXPECT_GT(on_faces, 20);
  EXPECT_GT(on_edges, 10);
}

Matrix3d Turned(const Vector6d& stress, const Matrix3d& turn) {
  return turn * StressTensor(stress) * turn.transpose();
}

void ExpectTheSameTurnedAndInOtherUnits(const Body& body) {
  const Stresses recovered = body.Recovered();
  const double scale = recovered.cwiseAbs().maxCoeff();
  const Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Body turned = body;
  turned.mesh.nodes = turn * body.mesh.nodes;
  turned.displacement = turn * body.displacement;
  turned.traction.at_nodes = turn * body.traction.at_nodes;
  Body larger = body;
  larger.mesh.nodes *= 1000;
  larger.displacement *= 1000;
  const Stresses of_turned = turned.Recovered(), of_larger = larger.Recovered();
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    EXPECT_LT((StressTensor(of_turned.col(slot)) - Turned(recovered.col(slot), turn)).norm(),
              1e-9 * scale);
    EXPECT_LT((of_larger.col(slot) - recovered.col(slot)).norm(), 1e-9 * scale);
  }
}

TEST_P(RecoveredStress, IsTheSameTurnedAndInOtherUnits) {
  const QuadraticField field = QuadraticField::Random(Steel(), true);
  Body box(StraightBox(GetParam()), field), ring(FacetedRing(GetParam()), field);
  Mirror(ring);
  for (Body& body : {std::ref(box), std::ref(ring)}) {
    body.displacement += 1e-5 * RandomField(body.mesh.nodes.cols(), 9);
    ExpectTheSameTurnedAndInOtherUnits(body);
  }
}

// Nodes and elements in another order, and elements that begin with another corner.
TEST_P(RecoveredStress, DoesNotDependOnTheOrderOfNodes) {
  const QuadraticField field = QuadraticField::Random(Steel(), true);
  Body body(StraightBox(GetParam()), field);
  body.displacement += 1e-5 * RandomField(body.mesh.nodes.cols(), 9);
  const auto nodes = static_cast<int>(body.mesh.nodes.cols());
  const auto elements = static_cast<int>(body.mesh.tetrahedra.cols());
  std::vector<int> order(nodes);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(4));
  mesh::TetrahedralMesh other = body.mesh;
  Eigen::Matrix3Xd displacement(3, nodes);
  for (int v = 0; v < nodes; ++v) {
    other.nodes.col(order[v]) = body.mesh.nodes.col(v);
    displacement.col(order[v]) = body.displacement.col(v);
  }
  // Corners 1, 2, 0, 3: the edges 01, 12, 02, 03, 13, 23 become 12, 20, 01, 13, 23, 03.
  constexpr std::array<int, 10> kTurn{1, 2, 0, 3, 5, 6, 4, 8, 9, 7};
  for (int e = 0; e < elements; ++e) {
    for (Eigen::Index k = 0; k < other.tetrahedra.rows(); ++k) {
      other.tetrahedra(k, elements - 1 - e) = order[body.mesh.tetrahedra(kTurn[k], e)];
    }
  }
  Body shuffled(other, field);
  shuffled.displacement = displacement;
  const Stresses recovered = body.Recovered(), again = shuffled.Recovered();
  Stresses at_nodes(6, nodes);
  for (int s = 0; s < nodes; ++s) at_nodes.col(shuffled.nodes.node(s)) = again.col(s);
  const double scale = recovered.cwiseAbs().maxCoeff();
  for (int s = 0; s < nodes; ++s) {
    EXPECT_LT((at_nodes.col(order[body.nodes.node(s)]) - recovered.col(s)).norm(), 1e-9 * scale);
  }
}

// The derivatives of stress at every node, by displacements, places and tractions, are those of
// differences.
void ExpectDerivativesOfDifferences(const Body& body) {
  constexpr double kStep = 1e-6;
  const Eigen::Matrix3Xd move = 0.1 * RandomField(body.mesh.nodes.cols(), 10);
  const Eigen::Matrix3Xd stretch = 1e-3 * RandomField(body.mesh.nodes.cols(), 11);
  const Eigen::Matrix3Xd push = 1e6 * RandomField(body.traction.at_nodes.cols(), 12);
  const auto moved = [&](double time) {
    Body other = body;
    other.mesh.nodes += time * move;
    other.displacement += time * stretch;
    other.traction.at_nodes += time * push;
    return other.Recovered();
  };
  const Stresses rate = (moved(kStep) - moved(-kStep)) / (2 * kStep);
  ThreadTeam alone(1);
  const Stresses at_points =
      StressAtPoints(body.mesh, body.materials, body.displacement, {}, alone);
  const Stresses recovered = body.Recovered();
  const Vector6d direction = Vector6d::LinSpaced(1, -0.7);
  const Eigen::Index places = body.surface.nodes().rows();
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    const StressDerivative derivative = NodalStressDerivative(
        body.Deformed(), body.nodes, body.surface, at_points, slot, direction);
    EXPECT_NEAR(derivative.value, direction.dot(recovered.col(slot)), 1e-9 * recovered.norm());
    double exact = Dot(derivative.by_displacement, stretch) + Dot(derivative.by_position, move);
    for (const ByTraction& change : derivative.by_traction) {
      exact += change.derivative.dot(push.col(places * change.at.face + change.at.place));
    }
    const double difference = direction.dot(rate.col(slot));
    EXPECT_NEAR(exact, difference, 1e-6 * rate.colwise().norm().maxCoeff()) << "slot " << slot;
  }
}

TEST_P(RecoveredStress, HasTheDerivativesOfDifferences) {
  Body body(BoxMesh({0.4, 0.3, 0.2}, {3, 3, 3}, GetParam()), QuadraticField::Random(Wood(), true));
  body.mesh.nodes += 0.002 * RandomField(body.mesh.nodes.cols(), 3);
  body.displacement += 1e-5 * RandomField(body.mesh.nodes.cols(), 9);
  ExpectDerivativesOfDifferences(body);
}

TEST_P(RecoveredStress, HasTheDerivativesOfDifferencesOnFacetsAndPlanesOfSymmetry) {
  Body body(FacetedRing(GetParam()), QuadraticField::Random(Wood(), true));
  Mirror(body);
  body.mesh.nodes += 0.0005 * RandomField(body.mesh.nodes.cols(), 3);
  body.displacement += 1e-5 * RandomField(body.mesh.nodes.cols(), 9);
  ExpectDerivativesOfDifferences(body);
}

// A ring that is widened evenly has the same stress along every facet, and along every chord of its
// edges: so it has at the corners between them, where facets turn, and where planes of symmetry cut
// it.
TEST_P(RecoveredStress, GoesOnAlongFacets) {
  constexpr double kWidening = 1e-4, kModulus = 200e9, kPoisson = 0.3;
  Material steel = Steel();
  steel.youngs_modulus = kModulus;
  steel.poissons_ratio = kPoisson;
  Body body(FacetedRing(GetParam()), QuadraticField::Random(steel, false));
  body.displacement = kWidening * body.mesh.nodes;
  body.displacement.row(2).setZero();
  body.traction.at_nodes.setZero();
  Mirror(body);
  const Stresses recovered = body.Recovered();
  int on_faces = 0, on_edges = 0;
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    const Vector3d at = body.mesh.nodes.col(body.nodes.node(slot));
    const Vector3d out = Vector3d(at.x(), at.y(), 0).normalized();
    const Vector3d hoop = Vector3d::UnitZ().cross(out);
    // Middles of chords lie this much further in than their ends.
    const double chord = std::cos(M_PI / 20), radius = at.head<2>().norm();
    if (radius > 1.0001 * kInner && radius < 0.9999 * kOuter * chord) continue;
    const bool on_edge = at.z() < 1e-9 || at.z() > kHeight - 1e-9;
    ++(on_edge ? on_edges : on_faces);
    Matrix3d expected = kModulus * kWidening * hoop * hoop.transpose();
    if (!on_edge) {
      expected +=
          kPoisson * kModulus * kWidening * Vector3d::UnitZ() * Vector3d::UnitZ().transpose();
      expected /= 1 - kPoisson * kPoisson;
    }
    EXPECT_LT((StressTensor(recovered.col(slot)) - expected).norm(), 1e-9 * expected.norm())
        << "at " << at.transpose();
  }
  EXPECT_EQ(on_edges, GetParam() ? 44 : 24);
  EXPECT_EQ(on_faces, GetParam() ? 66 : 12);
}

// A plane of symmetry that cuts a flat face askew folds it: the stress there is that of the face.
TEST_P(RecoveredStress, IsNotTurnedAcrossAFold) {
  mesh::MappedBox wedge;
  wedge.ticks = {mesh::Ticks(3), mesh::Ticks(3), mesh::Ticks(2)};
  wedge.place = [](const Vector3d& p) -> Vector3d {
    return {0.1 * p.x() + 0.05 * p.y(), 0.1 * p.y(), 0.1 * p.z()};
  };
  // Without shear across the plane of symmetry, y = 0.
  QuadraticField field = QuadraticField::Random(Steel(), false);
  field.linear = Vector3d(1e-4, -2e-4, 3e-4).asDiagonal();
  Body body(mesh::MeshMappedBox(wedge, GetParam()), field);
  Mirror(body);
  const Stresses recovered = body.Recovered();
  const Vector6d expected = field.Stress(Vector3d::Zero());
  for (int slot = 0; slot < body.nodes.size(); ++slot) {
    EXPECT_LT((recovered.col(slot) - expected).norm(), 1e-9 * expected.norm())
        << "at " << body.mesh.nodes.col(body.nodes.node(slot)).transpose();
  }
}

// Tractions of a case, and how they change as nodes move.
TEST_P(RecoveredStress, KnowsTheTractionsOfLoads) {
  constexpr double kStep = 1e-6;
  mesh::TetrahedralMesh mesh = BoxMesh({0.4, 0.3, 0.2}, {3, 3, 3}, GetParam());
  const PartNodes nodes(mesh);
  const PartSurface surface(mesh, nodes);
  LoadCase loads;
  loads.forces = {{{0, "u_max"}, {10, -20, 30}}};
  loads.pressures = {{{0, "v_max"}, 5e3}};
  loads.tractions = {{{0, "v_max"}, [](const Vector3d& x, const Vector3d&) { return x; }}};
  Support clamp{{0, "u_min"}}, plane{{0, "w_min"}, {false, false, true}};
  Support mirror{{0, "v_min"}};
  mirror.symmetric = true;
  const SurfaceTraction traction = TractionOn(mesh, surface, {clamp, plane, mirror}, loads);
  const Eigen::Index places = surface.nodes().rows();
  for (int face = 0; face < surface.size(); ++face) {
    const GradientMatrix at = FacePositions(mesh, surface, face);
    const Vector3d centre = at.leftCols<3>().rowwise().mean();
    const Vector3d here = traction.at_nodes.col(places * face + 1), x = at.col(1);
    const bool is_mirror = traction.mirrors[static_cast<std::size_t>(face)];
    EXPECT_EQ(is_mirror, centre.y() < 1e-9 || centre.z() < 1e-9);
    EXPECT_EQ(here.allFinite(), centre.x() > 1e-9 && !is_mirror);
    if (!here.allFinite()) continue;
    Vector3d expected = Vector3d::Zero();
    if (centre.x() > 0.4 - 1e-9) expected = Vector3d(10, -20, 30) / (0.3 * 0.2);
    if (centre.y() > 0.3 - 1e-9) expected = x - 5e3 * Vector3d::UnitY();
    EXPECT_LT((here - expected).norm(), 1e-9 * (1 + expected.norm()));
  }
  loads.tractions.clear();
  std::vector<ByTraction> changes;
  for (int face = 0; face < surface.size(); ++face) {
    for (int k = 0; k < places; ++k) {
      changes.push_back({{face, k}, RandomField(1, static_cast<unsigned>(places * face + k))});
    }
  }
  const Eigen::Matrix3Xd move = RandomField(mesh.nodes.cols(), 6);
  const auto sum = [&](double time) {
    mesh::TetrahedralMesh moved = mesh;
    moved.nodes += time * move;
    const SurfaceTraction of = TractionOn(moved, surface, {}, loads);
    double total = 0;
    for (const ByTraction& change : changes) {
      total += change.derivative.dot(of.at_nodes.col(places * change.at.face + change.at.place));
    }
    return total;
  };
  const double difference = (sum(kStep) - sum(-kStep)) / (2 * kStep);
  EXPECT_NEAR(Dot(TractionDerivative(mesh, surface, loads, changes), move), difference,
              1e-5 * std::abs(difference));
}

// Where forces stand on nodes nobody knows how they are spread over faces; and where the surface
// has an edge that goes inwards, stress has no limit. There the mean of the elements is given.
TEST_P(RecoveredStress, LeavesForcesOnNodesAndInnerEdgesToTheMean) {
  mesh::MappedBox whole;
  whole.ticks = {mesh::Ticks(4), mesh::Ticks(4), mesh::Ticks(2)};
  whole.place = [](const Vector3d& p) -> Vector3d {
    return p.cwiseProduct(Vector3d(0.4, 0.4, 0.2));
  };
  const mesh::TetrahedralMesh box = mesh::MeshMappedBox(whole, GetParam());
  // An L: what lies beyond the middle in x and y is cut away.
  mesh::TetrahedralMesh mesh = box;
  std::vector<int> kept;
  for (int e = 0; e < box.tetrahedra.cols(); ++e) {
    const Vector3d centre = ElementPositions(box, e).leftCols<4>().rowwise().mean();
    if (centre.x() < 0.2 || centre.y() < 0.2) kept.push_back(e);
  }
  mesh.tetrahedra = box.tetrahedra(Eigen::all, kept);
  mesh.part = box.part(kept);
  const PartNodes nodes(mesh);
  const PartSurface surface(mesh, nodes);
  const Eigen::Matrix3Xd displacement = 1e-5 * RandomField(mesh.nodes.cols(), 1);
  const std::vector<Material> materials{Steel()};
  LoadCase loads;
  const auto loaded = [&] {
    for (int slot = 0; slot < nodes.size(); ++slot) {
      if (mesh.nodes.col(nodes.node(slot)).isApprox(Vector3d(0.2, 0.0, 0.1), 1e-9)) return slot;
    }
    return -1;
  }();
  ASSERT_GE(loaded, 0);
  loads.nodal_forces = {{nodes.node(loaded), {0, 0, 1}}};
  const SurfaceTraction traction = TractionOn(mesh, surface, {}, loads);
  const Eigen::VectorXd cold;
  const SurfaceStress stress({mesh, materials, displacement, cold, traction}, surface);
  int inner_edge = 0, elsewhere = 0;
  for (int slot = 0; slot < nodes.size(); ++slot) {
    const Vector3d at = mesh.nodes.col(nodes.node(slot));
    const bool is_inner_edge = (at.head<2>() - Eigen::Vector2d(0.2, 0.2)).norm() < 1e-9;
    if (is_inner_edge) {
      ++inner_edge;
      EXPECT_FALSE(stress.At(slot, nodes.node(slot)).has_value());
    } else if (slot == loaded) {
      EXPECT_FALSE(stress.At(slot, nodes.node(slot)).has_value());
    } else if (!surface.At(slot).empty() && (at - Vector3d(0.2, 0, 0.1)).norm() > 0.25) {
      ++elsewhere;
      EXPECT_TRUE(stress.At(slot, nodes.node(slot)).has_value()) << at.transpose();
    }
  }
  EXPECT_EQ(inner_edge, GetParam() ? 5 : 3);
  EXPECT_GT(elsewhere, 20);
}

}  // namespace
}  // namespace mortise::simulator
