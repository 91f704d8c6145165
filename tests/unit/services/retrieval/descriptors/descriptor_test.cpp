#include "services/retrieval/descriptors/descriptor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/round_solids.h"
#include "tests/unit/services/retrieval/descriptors/furniture.h"

namespace mortise::retrieval {
namespace {

using mesh::SurfaceMesh;
using ::testing::HasSubstr;

// What holds of each of them.
class EveryDescriptor : public ::testing::TestWithParam<std::string> {
 protected:
  EveryDescriptor() : descriptor_(*MakeDescriptor(GetParam())) {}

  Eigen::VectorXd Vector(const SurfaceMesh& surface) const {
    const absl::StatusOr<Eigen::VectorXd> vector = descriptor_->Describe(surface);
    EXPECT_TRUE(testing::IsOk(vector));
    return vector.ok() ? *vector : Eigen::VectorXd();
  }

  // The distance without turning.
  double Apart(const SurfaceMesh& a, const SurfaceMesh& b) const {
    return (Vector(a) - Vector(b)).norm();
  }

  double noise() const { return descriptor_->properties().sampling_noise; }

  std::unique_ptr<Descriptor> descriptor_;
};

INSTANTIATE_TEST_SUITE_P(All, EveryDescriptor, ::testing::ValuesIn(DescriptorNames()),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

TEST_P(EveryDescriptor, HasItsNameAndDimension) {
  EXPECT_EQ(descriptor_->properties().name, GetParam());
  const Eigen::VectorXd vector = Vector(Chair());
  EXPECT_EQ(vector.size(), descriptor_->properties().dimension);
  EXPECT_TRUE(vector.allFinite());
}

TEST_P(EveryDescriptor, GivesTheSameBitsAgain) { EXPECT_EQ(Vector(Chair()), Vector(Chair())); }

TEST_P(EveryDescriptor, TellsUnlikeShapesApart) {
  const double scale = descriptor_->properties().natural_scale;
  const double apart = descriptor_->Distance(Vector(Chair()), Vector(mesh::Sphere(1, 16)));
  EXPECT_GT(apart, 0.3 * scale);
  EXPECT_LT(apart, 4 * scale);
  EXPECT_LT(noise(), 0.05 * scale);
}

TEST_P(EveryDescriptor, IgnoresOrderAndOrientationOfTriangles) {
  SurfaceMesh shuffled = Chair();
  std::vector<int> order(static_cast<std::size_t>(shuffled.triangles.cols()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  shuffled.triangles = shuffled.triangles(Eigen::all, order).eval();
  for (Eigen::Index t = 0; t < shuffled.triangles.cols(); t += 3) {
    std::swap(shuffled.triangles(0, t), shuffled.triangles(1, t));
  }
  EXPECT_EQ(Vector(Chair()), Vector(shuffled));
}

TEST_P(EveryDescriptor, IgnoresDuplicatesPointsOfTrianglesAndUnusedVertices) {
  const SurfaceMesh chair = Chair();
  SurfaceMesh untidy =
      Joined({chair, SurfaceMesh{chair.vertices, chair.triangles.leftCols(20)},
              SurfaceMesh{chair.vertices, chair.triangles.topRows(1).replicate(3, 1)}});
  untidy.vertices.conservativeResize(3, untidy.vertices.cols() + 1);
  untidy.vertices.rightCols(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(Vector(chair), Vector(untidy));
}

TEST_P(EveryDescriptor, IgnoresPlaceAndUnit) {
  SurfaceMesh inches = Chair();
  inches.vertices = (inches.vertices / 0.0254).colwise() + Eigen::Vector3d(300, -20, 7);
  EXPECT_LT(Apart(Chair(), inches), noise());
  SurfaceMesh tiny = Chair(), huge = Chair();
  tiny.vertices *= 1e-30;
  huge.vertices *= 1e30;
  EXPECT_LT(Apart(tiny, huge), noise());
}

TEST_P(EveryDescriptor, ChangesByNoMoreThanItsNoiseIfTrianglesAreSplit) {
  const SurfaceMesh split = Split(Chair());
  EXPECT_LT(Apart(Chair(), split), noise());
  EXPECT_LT(Apart(Chair(), Split(split)), noise());
}

TEST_P(EveryDescriptor, TurnsAsTheShapeTurns) {
  const Eigen::MatrixXd turns = descriptor_->QuarterTurns(Vector(Chair()));
  ASSERT_EQ(turns.cols(), descriptor_->properties().compares_turns ? 4 : 1);
  for (int turn = 0; turn < turns.cols(); ++turn) {
    EXPECT_LT((turns.col(turn) - Vector(QuarterTurned(Chair(), turn))).norm(), noise());
  }
  for (int turn = 0; turn < 4; ++turn) {
    const Eigen::VectorXd turned = Vector(QuarterTurned(Chair(), turn));
    EXPECT_LT(descriptor_->Distance(turned, Vector(Chair())), noise());
    EXPECT_LT(descriptor_->Distance(Vector(Chair()), turned), noise());
  }
}

TEST_P(EveryDescriptor, KeepsDistancesUnderTurns) {
  const Eigen::VectorXd chair = Vector(Chair()), torus = Vector(mesh::Torus(1, 0.3, 20));
  const Eigen::MatrixXd a = descriptor_->QuarterTurns(chair), b = descriptor_->QuarterTurns(torus);
  for (Eigen::Index turn = 0; turn < a.cols(); ++turn) {
    EXPECT_NEAR((a.col(turn) - b.col(turn)).norm(), (chair - torus).norm(), 1e-12);
  }
  EXPECT_EQ(a.col(0), chair);
  EXPECT_NEAR(descriptor_->Distance(chair, torus), descriptor_->Distance(torus, chair), 1e-12);
}

TEST_P(EveryDescriptor, DescribesFlatSurfacesAndSingleTriangles) {
  const SurfaceMesh sheet{(Eigen::Matrix3Xd(3, 4) << 0, 2, 2, 0, 0, 0, 1, 1, 0, 0, 0, 0).finished(),
                          (Eigen::Matrix3Xi(3, 2) << 0, 0, 1, 2, 2, 3).finished()};
  EXPECT_TRUE(Vector(sheet).allFinite());
  const SurfaceMesh triangle{sheet.vertices, sheet.triangles.leftCols(1)};
  EXPECT_TRUE(Vector(triangle).allFinite());
  SurfaceMesh upright = sheet;
  upright.vertices.row(2).swap(upright.vertices.row(1));
  EXPECT_TRUE(Vector(upright).allFinite());
  SurfaceMesh needle = triangle;
  needle.vertices.row(1) *= 1e-8;
  EXPECT_TRUE(Vector(needle).allFinite());
}

TEST_P(EveryDescriptor, RefusesWhatHasNoAreaOrIsBroken) {
  const auto fault = [this](const SurfaceMesh& surface) {
    const absl::Status status = descriptor_->Describe(surface).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field + ": " + std::string(status.message());
  };
  EXPECT_THAT(fault({}), HasSubstr("surface: "));
  EXPECT_THAT(fault({Eigen::Matrix3Xd::Zero(3, 3), Eigen::Vector3i(0, 1, 2)}),
              HasSubstr("no area"));
  SurfaceMesh line{Eigen::Matrix3Xd::Zero(3, 3), Eigen::Vector3i(0, 1, 2)};
  line.vertices.row(0) << 0, 1, 3;
  EXPECT_THAT(fault(line), HasSubstr("no area"));
  SurfaceMesh broken = Chair();
  broken.vertices(1, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(fault(broken), HasSubstr("surface.vertices[5]"));
  broken.vertices(1, 5) = 1e200;
  EXPECT_THAT(fault(broken), HasSubstr("surface.vertices[5]"));
  broken = Chair();
  broken.triangles(2, 4) = static_cast<int>(broken.vertices.cols());
  EXPECT_THAT(fault(broken), HasSubstr("surface.triangles[4]"));
  broken.triangles(2, 4) = -1;
  EXPECT_THAT(fault(broken), HasSubstr("surface.triangles[4]"));
}

TEST_P(EveryDescriptor, RefusesOtherVerticesOnceBound) {
  const SurfaceMesh chair = Chair();
  const auto bound = descriptor_->Bind(chair);
  ASSERT_TRUE(testing::IsOk(bound));
  const auto fault = [&](const Eigen::Matrix3Xd& vertices,
                         const std::vector<Eigen::Matrix3Xd>& velocities) {
    const absl::Status status = (*bound)->Differentiate(vertices, velocities).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  EXPECT_EQ(fault(chair.vertices.leftCols(7), {}), "vertices");
  Eigen::Matrix3Xd broken = chair.vertices;
  broken(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fault(broken, {}), "vertices");
  EXPECT_EQ(fault(0 * chair.vertices, {}), "vertices");
  EXPECT_EQ(fault(chair.vertices, {chair.vertices, broken}), "velocities[1]");
  EXPECT_EQ(fault(chair.vertices, {chair.vertices.leftCols(7)}), "velocities[0]");
}

TEST(DescriptorTest, KnowsItsNames) {
  for (const std::string& name : DescriptorNames())
    EXPECT_TRUE(testing::IsOk(MakeDescriptor(name)));
  const absl::Status status = MakeDescriptor("d3").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(status).field, "descriptor");
  EXPECT_THAT(std::string(status.message()), HasSubstr("d2, voxel, light-field"));
}

}  // namespace
}  // namespace mortise::retrieval
