#include "services/retrieval/fit/family_member.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

FitFamily Chairs(int* made = nullptr) {
  FitFamily family;
  family.surfaces.lower = Eigen::Vector4d(0.35, 0.35, 0.35, 0.3);
  family.surfaces.upper = Eigen::Vector4d(0.6, 0.6, 0.55, 0.6);
  family.surfaces.surface = [made](const VectorXd& q) {
    if (made != nullptr) ++*made;
    return Chair(Eigen::Vector4d(q[0], q[1], q[2], q[3]));
  };
  return family;
}

TEST(FamilyMemberTest, KnowsHowLinearSurfacesMove) {
  int made = 0;
  const FitFamily family = Chairs(&made);
  const Eigen::Vector4d q(0.45, 0.5, 0.42, 0.4), other(0.6, 0.35, 0.5, 0.3);
  const auto member = MakeMember(family, q, 1);
  ASSERT_TRUE(member.ok()) << member.status();
  EXPECT_TRUE(member->At(other).vertices.isApprox(Chair(other).vertices, 1e-9));
  EXPECT_EQ(made, 5);
  const auto moved = MoveMember(family, *member, other, 1);
  ASSERT_TRUE(moved.ok()) << moved.status();
  EXPECT_EQ(made, 6) << "the velocities still hold";
  EXPECT_TRUE(moved->At(q).vertices.isApprox(Chair(q).vertices, 1e-9));
}

TEST(FamilyMemberTest, LooksAlongWhatIsFeasible) {
  FitFamily family = Chairs();
  family.cuts.normals = Eigen::RowVector4d(1, 1, 0, 0);
  family.cuts.bounds = VectorXd::Constant(1, 0.9);
  family.surfaces.surface = [](const VectorXd& q) -> absl::StatusOr<mesh::SurfaceMesh> {
    if (q[0] + q[1] > 0.9) return InvalidField("q", "is too large");
    return Chair(Eigen::Vector4d(q[0], q[1], q[2], q[3]));
  };
  const auto corner = NearestFeasible(family, family.surfaces.upper);
  ASSERT_TRUE(corner.ok()) << corner.status();
  EXPECT_NEAR((*corner)[0] + (*corner)[1], 0.9, 1e-6);
  const auto member = MakeMember(family, *corner, 2);
  ASSERT_TRUE(member.ok()) << member.status();
  const Eigen::Vector4d inside(0.4, 0.4, 0.4, 0.4);
  EXPECT_TRUE(member->At(inside).vertices.isApprox(Chair(inside).vertices, 1e-6));
  family.cuts.bounds[0] = 0.1;
  EXPECT_EQ(DetailOf(NearestFeasible(family, inside).status()).reason, "NOTHING_FEASIBLE");
}

TEST(FamilyMemberTest, KnowsHowFacesMoveWhoseTrianglesChange) {
  FitFamily family = Chairs();
  family.surfaces.surface = [](const VectorXd& q) {
    const mesh::SurfaceMesh chair = Chair(Eigen::Vector4d(q[0], q[1], q[2], q[3]));
    const int splits = static_cast<int>(std::floor(q.sum() * 1e5)) % 3;
    return splits == 0 ? chair : splits == 1 ? Split(chair) : Split(Split(chair));
  };
  const Eigen::Vector4d q(0.45, 0.5, 0.42, 0.4), other(0.46, 0.5, 0.42, 0.4);
  const auto member = MakeMember(family, q, 1);
  ASSERT_TRUE(member.ok()) << member.status();
  EXPECT_NEAR(member->At(other).vertices.row(0).maxCoeff(), 0.46, 1e-4);
  EXPECT_NEAR(member->At(other).vertices.row(1).maxCoeff(), 0.5, 1e-4);
}

// Solids take long to make: one design for each parameter is enough, and few that are not far away
// need others beside them.
TEST(FamilyMemberTest, MakesFewDesignsWhoseTrianglesChange) {
  FitFamily family = Chairs();
  int made = 0;
  family.surfaces.surface = [&made](const VectorXd& q) {
    mesh::SurfaceMesh chair = Chair(Eigen::Vector4d(q[0], q[1], q[2], q[3]));
    const Eigen::Index count = chair.triangles.cols();
    chair.triangles.conservativeResize(3, count + ++made);
    for (int i = 0; i < made; ++i) chair.triangles.col(count + i) = chair.triangles.col(i);
    return chair;
  };
  const Eigen::Vector4d q(0.45, 0.5, 0.42, 0.4);
  const auto member = MakeMember(family, q, 1);
  ASSERT_TRUE(member.ok()) << member.status();
  EXPECT_TRUE(member->meshed_anew);
  EXPECT_EQ(made, 6) << "one, one beside it to see what it is like, and one for each parameter";
  const auto moved = MoveMember(family, *member, q + Eigen::Vector4d(0.01, 0.02, 0, -0.01), 1);
  ASSERT_TRUE(moved.ok()) << moved.status();
  EXPECT_TRUE(moved->meshed_anew);
  EXPECT_EQ(made, 7);
}

TEST(FamilyMemberTest, FailsWhereNothingCanBeMade) {
  FitFamily family = Chairs();
  family.surfaces.surface = [](const VectorXd&) -> absl::StatusOr<mesh::SurfaceMesh> {
    return InvalidField("parts[0]", "is empty");
  };
  EXPECT_FALSE(MakeMember(family, family.surfaces.lower, 1).ok());
}

}  // namespace
}  // namespace mortise::retrieval
