// What is free to move without deforming: found from the geometry, whatever the mesh.
#include "common/fem/mechanisms/free_motions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>

#include "common/base/errors.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/linear/null_space.h"
#include "common/fem/problems/elasticity.h"
#include "common/fem/problems/heat_conduction.h"
#include "tests/unit/common/fem/problems/clamped_box.h"
#include "tests/unit/common/fem/problems/hinged_bodies.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;

Support Held(const mesh::TetrahedralMesh& mesh, const Region& where) {
  Support support;
  support.nodes = NodesAt(mesh, where);
  return support;
}

int CountMotions(const mesh::TetrahedralMesh& mesh, const std::vector<Support>& supports) {
  const auto constraints = CollectConstraints(mesh, supports);
  EXPECT_TRUE(constraints.ok()) << constraints.status();
  return FindFreeMotions(mesh, *constraints).count;
}

// Five ways to load, of which some do not push the free body round its hinge, and one is none.
std::vector<LoadCase> Loads(const mesh::TetrahedralMesh& mesh, const Hinge& hinge) {
  std::vector<LoadCase> loads(5);
  loads[0].gravity = {1, -9.81, 3};
  loads[1].nodal_forces = {{NodesAt(mesh, hinge.held)[0], {0, 0, 1e4}}};
  loads[2].nodal_forces = {{NodesAt(mesh, hinge.outer).back(), {1e4, -2e4, 3e4}}};
  loads[3].rotation = Rotation{{0.3, 0.1, 0}, {0, 0, 5}};
  return loads;
}

class HingeTest : public testing::TestWithParam<std::tuple<Hinge, bool>> {
 protected:
  const Hinge& hinge() const { return std::get<0>(GetParam()); }
  bool quadratic() const { return std::get<1>(GetParam()); }
};

INSTANTIATE_TEST_SUITE_P(Bodies, HingeTest,
                         testing::Combine(testing::ValuesIn(Hinges()), testing::Bool()),
                         [](const auto& which) {
                           return std::get<0>(which.param).name +
                                  (std::get<1>(which.param) ? "Quadratic" : "Linear");
                         });

TEST_P(HingeTest, IsToldWhateverTheMeshTheSolverAndTheLoad) {
  std::string told;
  for (const int cells : {1, 2, 3}) {
    const mesh::TetrahedralMesh mesh = hinge().mesh(cells, quadratic());
    AnalysisCase analysis;
    analysis.materials = {Steel()};
    analysis.supports = {Held(mesh, hinge().held)};
    EXPECT_EQ(CountMotions(mesh, analysis.supports), hinge().motions);
    for (const LoadCase& loads : Loads(mesh, hinge())) {
      static_cast<LoadCase&>(analysis) = loads;
      for (const SolverKind kind : {SolverKind::kDirect, SolverKind::kIterative}) {
        ElasticityOptions options;
        options.solver.kind = kind;
        const absl::Status status = SolveElasticity(mesh, analysis, options).status();
        EXPECT_EQ(DetailOf(status).reason, "RIGID_MOTION") << status;
        EXPECT_EQ(DetailOf(status).field, "supports");
        EXPECT_THAT(std::string(status.message()), HasSubstr("is free to " + hinge().motion));
      }
    }
  }
}

TEST_P(HingeTest, TakesAsManyMotionsMoreWhereNothingIsHeld) {
  const mesh::TetrahedralMesh mesh = hinge().mesh(2, quadratic());
  EXPECT_EQ(CountMotions(mesh, {}), 6 + hinge().motions);
  // Held by its free end as well it is a sound structure.
  EXPECT_EQ(CountMotions(mesh, {Held(mesh, hinge().held), Held(mesh, hinge().outer)}), 0);
}

// As many eigenvalues of the stiffness itself vanish.
int CountZeroEigenvalues(const mesh::TetrahedralMesh& mesh, const Constraints& constraints) {
  ThreadTeam alone(1);
  const auto stiffness = AssembleStiffness(mesh, {Steel()}, constraints.frames, alone);
  EXPECT_TRUE(stiffness.ok()) << stiffness.status();
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < constraints.fixed.size(); ++k) {
    if (!constraints.fixed.data()[k]) free.push_back(k);
  }
  const Eigen::Index size = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd dense(size, size);
  for (Eigen::Index c = 0; c < size; ++c) {
    Eigen::Matrix3Xd unit = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
    unit.data()[free[c]] = 1;
    const Eigen::Matrix3Xd column = stiffness->Multiply(unit);
    for (Eigen::Index r = 0; r < size; ++r) dense(r, c) = column.data()[free[r]];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(dense, Eigen::EigenvaluesOnly);
  return static_cast<int>(
      (eigen.eigenvalues().array() < 1e-11 * eigen.eigenvalues()[size - 1]).count());
}

// Elements left at random, some of whose nodes are held along some axes.
TEST(FreeMotions, AreTheNullSpaceOfAnyStiffness) {
  std::mt19937 random(5);
  const auto chance = [&](double share) { return random() < share * std::mt19937::max(); };
  int mechanisms = 0, most = 0;
  for (int round = 0; round < 60; ++round) {
    const bool quadratic = round % 3 == 2;
    mesh::TetrahedralMesh mesh =
        Cut(Cubes({2, 2, 2}, 1, quadratic), [&](const Eigen::Vector3d&) { return chance(0.35); });
    // Curved edges hold what straight ones do not.
    if (round % 6 == 5) {
      for (auto node : mesh.nodes.colwise()) {
        node +=
            0.1 * Eigen::Vector3d(node.y() * node.z(), node.x() * node.x(), -node.y() * node.x());
      }
    }
    Constraints constraints;
    constraints.fixed = Eigen::Array3Xi::Zero(3, mesh.nodes.cols());
    constraints.displacement = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
    for (int& fixed : constraints.fixed.reshaped()) fixed = chance(round % 4 == 0 ? 0.03 : 0.25);
    if (round % 5 == 4) {
      constraints.frames.index.assign(mesh.nodes.cols(), 0);
      constraints.frames.axes = {
          Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix()};
    }
    const FreeMotions free = FindFreeMotions(mesh, constraints);
    EXPECT_EQ(free.count, CountZeroEigenvalues(mesh, constraints)) << round;
    mechanisms += free.count > 0;
    most = std::max(most, free.count);
    // None of them strains anything.
    ThreadTeam alone(1);
    const auto stiffness = AssembleStiffness(mesh, {Steel()}, {}, alone);
    ASSERT_TRUE(stiffness.ok());
    for (const Eigen::Matrix3Xd& motion : Displacements(free, mesh)) {
      EXPECT_LT(stiffness->Multiply(motion).norm(), 1e-9 * 210e9 * motion.norm()) << round;
      const Eigen::Matrix3Xd along = constraints.frames.ToFrames(motion);
      EXPECT_LT((constraints.fixed != 0).select(along, 0.0).norm(), 1e-9) << round;
    }
  }
  EXPECT_GT(mechanisms, 10);
  EXPECT_LT(mechanisms, 55);
  EXPECT_GT(most, 6);
}

// Blocks at the middles of the sides of a square of three by three, which share its inner edges.
mesh::TetrahedralMesh FourBars(bool quadratic) {
  return Cut(Cubes({3, 3, 1}, 2, quadratic), [](const Eigen::Vector3d& p) {
    const bool in_middle = p.x() > 1 && p.x()<2, between = p.y()> 1 && p.y() < 2;
    return in_middle != between;
  });
}

TEST(FreeMotions, OfFourBarsInALoopIsOne) {
  for (const bool quadratic : {false, true}) {
    const mesh::TetrahedralMesh mesh = FourBars(quadratic);
    const Region left = [](const Eigen::Vector3d& p) { return p.x() < 1e-9; };
    EXPECT_EQ(CountMotions(mesh, {Held(mesh, left)}), 1);
    EXPECT_EQ(CountMotions(mesh, {}), 7);
    // Two bars that are held leave the others none.
    const Region both = [](const Eigen::Vector3d& p) { return p.x() < 1e-9 || p.x() > 3 - 1e-9; };
    EXPECT_EQ(CountMotions(mesh, {Held(mesh, both)}), 0);
  }
}

TEST(FreeMotions, OfAChainOfHingesAreAsMany) {
  // Blocks along a diagonal, each hinged to the next: the last one is named.
  const int blocks = 5;
  const mesh::TetrahedralMesh mesh = Cut(
      Cubes({blocks, blocks, 1}, 1, true),
      [](const Eigen::Vector3d& p) { return static_cast<int>(p.x()) == static_cast<int>(p.y()); });
  const Support held = Held(mesh, [](const Eigen::Vector3d& p) { return p.x() < 1e-9; });
  EXPECT_EQ(CountMotions(mesh, {held}), blocks - 1);
  const auto constraints = CollectConstraints(mesh, {held});
  EXPECT_THAT(
      std::string(CheckRigidMotion(mesh, *constraints).message()),
      HasSubstr("the piece near (4500, 4500, 500) mm of part 'body' is free to rotate about "
                "z through (4000, 4000, 500) mm"));
}

// A checkerboard of cubes that share vertical edges.
TEST(FreeMotions, OfManyBodiesAreThoseOfTheirStiffness) {
  const mesh::TetrahedralMesh mesh = Cut(Cubes({9, 9, 1}, 1, false), [](const Eigen::Vector3d& p) {
    return (static_cast<int>(p.x()) + static_cast<int>(p.y())) % 2 == 0;
  });
  for (const double height : {0.0, 2.0}) {
    const Support held =
        Held(mesh, [height](const Eigen::Vector3d& p) { return p.x() < 1e-9 && p.y() < height; });
    const auto constraints = CollectConstraints(mesh, {held});
    EXPECT_EQ(FindFreeMotions(mesh, *constraints).count, CountZeroEigenvalues(mesh, *constraints));
  }
}

// Three chains of numbers that must be equal to their neighbours.
TEST(NullSpace, OfASparseMatrixIsFoundToo) {
  const int length = 300;
  std::vector<Eigen::Triplet<double>> entries;
  int rows = 0;
  for (int k = 0; k + 1 < 3 * length; ++k) {
    if (k % length == length - 1) continue;
    entries.emplace_back(rows, k, std::sqrt(0.5));
    entries.emplace_back(rows++, k + 1, -std::sqrt(0.5));
  }
  Eigen::SparseMatrix<double> chains(rows, 3 * length), slips(3 * length, 3 * length);
  chains.setFromTriplets(entries.begin(), entries.end());
  slips.setIdentity();
  const JointRows joints{1e5 * chains, slips};
  const NullSpace space = FindNullSpace(joints, 10);
  EXPECT_EQ(space.dimension, 3);
  ASSERT_EQ(space.basis.cols(), 3);
  EXPECT_LT((chains * space.basis).norm(), 1e-9);
  EXPECT_LT((space.basis.transpose() * space.basis - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_EQ(FindNullSpace(joints, 2).basis.cols(), 2);
  EXPECT_EQ(FindNullSpace(joints, 2).dimension, 3);
}

TEST(FreeMotions, EndWhereASharedEdgeIsCurved) {
  const auto bent = [](mesh::TetrahedralMesh mesh, double sag) {
    for (auto node : mesh.nodes.colwise()) node.x() += sag * node.z() * (1 - node.z());
    return mesh;
  };
  const Hinge hinge = Hinges()[0];
  for (const int cells : {1, 2}) {
    const mesh::TetrahedralMesh straight = hinge.mesh(cells, true);
    const mesh::TetrahedralMesh curved = bent(straight, 0.2);
    EXPECT_EQ(CountMotions(curved, {Held(straight, hinge.held)}), 0);
    // Rounding to the six digits of a file does not curve it.
    mesh::TetrahedralMesh rounded = bent(straight, 3e-7);
    EXPECT_EQ(CountMotions(rounded, {Held(straight, hinge.held)}), 1);
  }
}

TEST(FreeMotions, OfTheSameBodiesAreTheSameInAnyUnitAndPlace) {
  const Hinge hinge = Hinges()[0];
  const mesh::TetrahedralMesh mesh = hinge.mesh(2, false);
  for (const double scale : {1e-4, 1.0, 1e3}) {
    mesh::TetrahedralMesh moved = mesh;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.4, Eigen::Vector3d(3, 1, 2).normalized()).toRotationMatrix();
    moved.nodes = scale * ((turn * mesh.nodes).colwise() + Eigen::Vector3d(40, -70, 10));
    EXPECT_EQ(CountMotions(moved, {Held(mesh, hinge.held)}), 1) << scale;
  }
}

TEST(FreeMotions, OfThinSheetsAndRodsAreNone) {
  const Region at_start = [](const Eigen::Vector3d& p) { return p.x() < 1e-9; };
  for (const Eigen::Vector3d& size : {Eigen::Vector3d(1, 1, 5e-4), Eigen::Vector3d(1, 5e-4, 5e-4),
                                      Eigen::Vector3d(1, 1e-3, 1e-4)}) {
    mesh::TetrahedralMesh mesh = BoxMesh({1, 1, 1}, {6, 2, 1}, false);
    for (auto node : mesh.nodes.colwise()) node = size.cwiseProduct(node).eval();
    EXPECT_EQ(CountMotions(mesh, {Held(mesh, at_start)}), 0);
    EXPECT_EQ(CountMotions(mesh, {}), 6);
  }
}

// A heated cube that shares an edge with a cooled one: its temperature depends on the mesh alone.
TEST(FreeTemperature, IsNamedWhereBodiesShareNoFace) {
  for (const Hinge& hinge : Hinges()) {
    for (const bool quadratic : {false, true}) {
      const mesh::TetrahedralMesh mesh = hinge.mesh(2, quadratic);
      HeatCase heat;
      heat.materials = {Steel()};
      heat.materials[0].conductivity = 50;
      heat.temperatures = {{{}, 20, NodesAt(mesh, hinge.held)}};
      heat.sources = {{0, 100}};
      const absl::Status status = SolveHeat(mesh, heat).status();
      EXPECT_EQ(DetailOf(status).reason, "FREE_TEMPERATURE") << hinge.name << status;
      EXPECT_THAT(std::string(status.message()), HasSubstr("of part 'body' is without"));
      heat.temperatures.push_back({{}, 20, NodesAt(mesh, hinge.outer)});
      EXPECT_TRUE(SolveHeat(mesh, heat).ok()) << hinge.name;
    }
  }
}

}  // namespace
}  // namespace mortise::simulator
