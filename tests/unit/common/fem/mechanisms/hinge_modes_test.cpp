// How bodies on hinges vibrate: what is free to turn at 0 Hz, and after it what deforms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "common/base/errors.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/problems/modal_analysis.h"
#include "tests/unit/common/fem/problems/clamped_box.h"
#include "tests/unit/common/fem/problems/hinged_bodies.h"

namespace mortise::simulator {
namespace {

using ::testing::HasSubstr;

Eigen::MatrixXd Dense(const BlockMatrix& matrix, const std::vector<Eigen::Index>& free) {
  const Eigen::Index size = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd dense(size, size);
  for (Eigen::Index c = 0; c < size; ++c) {
    Eigen::Matrix3Xd unit = Eigen::Matrix3Xd::Zero(3, matrix.nodes());
    unit.data()[free[c]] = 1;
    const Eigen::Matrix3Xd column = matrix.Multiply(unit);
    for (Eigen::Index r = 0; r < size; ++r) dense(r, c) = column.data()[free[r]];
  }
  return dense;
}

// All frequencies, ascending, by a dense solver. Those of rigid motions are not quite 0.
Eigen::VectorXd AllFrequencies(const mesh::TetrahedralMesh& mesh, const std::vector<int>& held) {
  ThreadTeam alone(1);
  const auto stiffness = AssembleStiffness(mesh, {Steel()}, {}, alone);
  const auto mass = AssembleMass(mesh, {Steel()}, {}, stiffness->pattern(), alone);
  Eigen::Array3Xi fixed = Eigen::Array3Xi::Zero(3, mesh.nodes.cols());
  for (const int v : held) fixed.col(v).setOnes();
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < fixed.size(); ++k) {
    if (!fixed.data()[k]) free.push_back(k);
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Dense(*stiffness, free), Dense(*mass, free), Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().cwiseMax(0).cwiseSqrt() / (2 * M_PI);
}

class HingeModes : public testing::TestWithParam<Hinge> {};

INSTANTIATE_TEST_SUITE_P(Bodies, HingeModes, testing::ValuesIn(Hinges()),
                         [](const auto& which) { return which.param.name; });

TEST_P(HingeModes, AreThoseOfTheWholeSpectrum) {
  for (const bool is_held : {true, false}) {
    const mesh::TetrahedralMesh mesh = GetParam().mesh(1, false);
    std::vector<Support> supports;
    if (is_held) supports.emplace_back().nodes = NodesAt(mesh, GetParam().held);
    const auto solution = FindModes(mesh, {Steel()}, supports, {.count = 5});
    ASSERT_TRUE(solution.ok()) << solution.status();
    const int rigid = GetParam().motions + (is_held ? 0 : 6);
    ASSERT_EQ(solution->rigid_motions, rigid);
    const Eigen::VectorXd all =
        AllFrequencies(mesh, is_held ? supports[0].nodes : std::vector<int>{});
    for (int m = 0; m < rigid; ++m) {
      EXPECT_EQ(solution->modes[m].frequency, 0);
      EXPECT_TRUE(solution->modes[m].rigid);
    }
    for (int m = rigid; m < rigid + 5; ++m) {
      EXPECT_NEAR(solution->modes[m].frequency, all[m], 1e-6 * all[m]) << m;
      EXPECT_FALSE(solution->modes[m].rigid);
      EXPECT_LT(solution->modes[m].residual, 1e-4);
    }
    EXPECT_THAT(NoteOnRigidMotions(*solution), HasSubstr(" at 0 Hz move"));
    if (is_held) {
      EXPECT_THAT(NoteOnRigidMotions(*solution), HasSubstr(GetParam().motion));
    }
  }
}

// Finer meshes come nearer to the same frequencies, and have no others between them.
TEST_P(HingeModes, DoNotDependOnTheMesh) {
  double before = 0;
  for (const int cells : {2, 3}) {
    const mesh::TetrahedralMesh mesh = GetParam().mesh(cells, true);
    Support support;
    support.nodes = NodesAt(mesh, GetParam().held);
    const auto solution = FindModes(mesh, {Steel()}, {support}, {.count = 2});
    ASSERT_TRUE(solution.ok()) << solution.status();
    ASSERT_EQ(solution->rigid_motions, GetParam().motions);
    const double lowest = solution->modes[solution->rigid_motions].frequency;
    if (before > 0) {
      EXPECT_NEAR(lowest, before, 0.2 * before);
    }
    before = lowest;
  }
}

// A body that weighs next to nothing moves as freely as one that is heavy.
TEST(Modes, OfBodiesOfVeryDifferentMassAreAllFound) {
  mesh::TetrahedralMesh mesh = Hinges()[0].mesh(1, false);
  mesh.part_names = {"heavy", "light"};
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    double x = 0;
    for (const int v : mesh.tetrahedra.col(e)) x += mesh.nodes(0, v) / 4;
    mesh.part[e] = x > 1 ? 1 : 0;
  }
  for (const double share : {1e-6, 1e-12, 1e-15}) {
    std::vector<Material> materials = {Steel(), Steel()};
    materials[1].density *= share;
    const auto solution = FindModes(mesh, materials, {}, {.count = 1});
    ASSERT_TRUE(solution.ok()) << share << solution.status();
    EXPECT_EQ(solution->rigid_motions, 7) << share;
    // Each strains less than a millionth of what the motion of a single node would.
    ThreadTeam alone(1);
    const auto stiffness = AssembleStiffness(mesh, materials, {}, alone);
    for (int m = 0; m < solution->rigid_motions; ++m) {
      const Eigen::Matrix3Xd& shape = solution->modes[m].shape;
      EXPECT_LT(stiffness->Multiply(shape).norm(), 1e-6 * 210e9 * shape.norm()) << share;
    }
  }
}

TEST(Modes, OfManyFreeMotionsStayWithinTheMemory) {
  // Eight cubes that share nothing: 48 motions of 64 nodes.
  const mesh::TetrahedralMesh mesh = Cut(Cubes({3, 3, 3}, 1, false), [](const Eigen::Vector3d& p) {
    const Eigen::Vector3i cube = p.cast<int>();
    return cube.x() % 2 == 0 && cube.y() % 2 == 0 && cube.z() % 2 == 0;
  });
  ModalOptions options{.count = 2};
  options.cholesky.memory_limit = 1e6;
  EXPECT_TRUE(FindModes(mesh, {Steel()}, {}, options).ok());
  options.cholesky.memory_limit = 1e5;
  const auto solution = FindModes(mesh, {Steel()}, {}, options);
  EXPECT_EQ(solution.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(solution.status().message()), HasSubstr("48 free motions"));
}

TEST(Modes, OfMoreFreeMotionsThanAnybodyLooksAtAreRefused) {
  // 64 cubes that share nothing.
  const mesh::TetrahedralMesh mesh = Cut(Cubes({7, 7, 7}, 1, false), [](const Eigen::Vector3d& p) {
    const Eigen::Vector3i cube = p.cast<int>();
    return cube.x() % 2 == 0 && cube.y() % 2 == 0 && cube.z() % 2 == 0;
  });
  const auto solution = FindModes(mesh, {Steel()}, {}, {.count = 2});
  EXPECT_EQ(solution.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(solution.status().message()), HasSubstr("384 free motions"));
}

TEST(Modes, OfAHeldBodyHaveNoNote) {
  const mesh::TetrahedralMesh mesh = Cubes({1, 1, 1}, 2, false);
  Support support;
  support.nodes = NodesAt(mesh, [](const Eigen::Vector3d& p) { return p.x() == 0; });
  const auto solution = FindModes(mesh, {Steel()}, {support}, {.count = 2});
  ASSERT_TRUE(solution.ok()) << solution.status();
  EXPECT_EQ(NoteOnRigidMotions(*solution), "");
}

}  // namespace
}  // namespace mortise::simulator
