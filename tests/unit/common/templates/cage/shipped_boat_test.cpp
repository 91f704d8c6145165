// The boat that ships: drawn as described, a closed symmetric surface of sensible size everywhere,
// with exact derivatives.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "common/base/files.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/templates/cage/cage_model.h"
#include "common/templates/cage/codec/cage_template_codec.h"
#include "tools/boat/boat_surface.h"

namespace mortise::parametric {
namespace {

constexpr int kPoints = 1000;

class ShippedBoat : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const char* root = std::getenv("MORTISE_SOURCE_DIR");
    const auto text = ReadFile(std::filesystem::path(root == nullptr ? "." : root) /
                               "collection/cage_templates/boat.textproto");
    ASSERT_TRUE(text.ok()) << text.status();
    const auto boat = ParseCageTemplateText(*text, "boat.textproto");
    ASSERT_TRUE(boat.ok()) << boat.status();
    auto model = CageModel::Create(*boat);
    ASSERT_TRUE(model.ok()) << model.status();
    model_ = new CageModel(*std::move(model));
  }
  static void TearDownTestSuite() {
    delete model_;
    model_ = nullptr;
  }

  void SetUp() override { ASSERT_NE(model_, nullptr); }

  // The default, then corners of the parameter box and points inside it by turns; always the same.
  static Eigen::VectorXd Point(int index, std::mt19937_64& random) {
    Eigen::VectorXd q = model_->Defaults();
    for (Eigen::Index i = 0; i < q.size() && index > 0; ++i) {
      const Parameter& parameter = model_->definition().parameters[static_cast<std::size_t>(i)];
      double t = static_cast<double>(random() >> 11) * 0x1p-53;
      if (index % 4 == 1) t = t < 0.5 ? 0 : 1;
      q(i) = (1 - t) * parameter.minimum + t * parameter.maximum;
    }
    return q;
  }

  static const CageModel* model_;
};

const CageModel* ShippedBoat::model_ = nullptr;

TEST_F(ShippedBoat, HasTwelveParametersAndConditions) {
  const CageTemplate& boat = model_->definition();
  EXPECT_EQ(boat.name, "templates/boat");
  EXPECT_EQ(boat.parameters.size(), 12u);
  for (const Parameter& parameter : boat.parameters) {
    EXPECT_FALSE(parameter.title.empty() || parameter.description.empty()) << parameter.name;
  }
  ASSERT_FALSE(boat.conditions.empty());
  EXPECT_EQ(boat.conditions.front().kind, BoundaryConditionKind::kFixed);
}

TEST_F(ShippedBoat, IsTheSurfaceThatIsDescribed) {
  const CageSurface drawn = DrawBoat();
  const CageSurface& shipped = model_->definition().surface;
  ASSERT_EQ(shipped.vertices.cols(), drawn.vertices.cols());
  // The drawing's functions may differ in their last digit from machine to machine.
  EXPECT_LT((shipped.vertices - drawn.vertices).cwiseAbs().maxCoeff(), 1.5e-5);
  ASSERT_EQ(shipped.faces.size(), drawn.faces.size());
  for (std::size_t face = 0; face < drawn.faces.size(); ++face) {
    EXPECT_EQ(shipped.faces[face].name, drawn.faces[face].name);
    EXPECT_EQ(shipped.faces[face].triangles, drawn.faces[face].triangles);
  }
}

TEST_F(ShippedBoat, IsClosedSymmetricAndOfSensibleSizeEverywhere) {
  const Eigen::Matrix3Xd& written = model_->definition().surface.vertices;
  std::map<std::array<double, 3>, Eigen::Index> places;
  for (Eigen::Index v = 0; v < written.cols(); ++v) {
    places[{written(0, v), written(1, v) + 0.0, written(2, v)}] = v;
  }
  std::vector<Eigen::Index> mirror;
  for (Eigen::Index v = 0; v < written.cols(); ++v) {
    const auto found = places.find({written(0, v), 0.0 - written(1, v), written(2, v)});
    ASSERT_NE(found, places.end()) << written.col(v).transpose();
    mirror.push_back(found->second);
  }
  std::mt19937_64 random(2026);
  for (int k = 0; k < kPoints; ++k) {
    const Eigen::VectorXd q = Point(k, random);
    const auto design = model_->Evaluate(q);
    ASSERT_TRUE(design.ok()) << "point " << k << ": " << design.status();
    const Eigen::Matrix3Xd& vertices = design->surface.vertices;
    if (k % 50 == 0) {
      ASSERT_TRUE(mesh::IsWatertight(design->surface)) << q.transpose();
    }
    Eigen::Matrix3Xd mirrored = vertices(Eigen::all, mirror);
    mirrored.row(1) *= -1;
    ASSERT_LT((mirrored - vertices).cwiseAbs().maxCoeff(), 1e-12) << q.transpose();
    const Eigen::Vector3d size = vertices.rowwise().maxCoeff() - vertices.rowwise().minCoeff();
    ASSERT_NEAR(size.x(), q(0), 0.02 * q(0)) << q.transpose();
    ASSERT_GT(size.y(), 0.9 * q(1)) << q.transpose();
    ASSERT_LT(size.y(), 1.3 * q(1)) << q.transpose();
    ASSERT_GT(size.z(), q(2)) << q.transpose();
    ASSERT_LT(size.z(), q(2) + 0.08) << q.transpose();
    const double volume = mesh::ComputeMassProperties(design->surface).volume;
    ASSERT_GT(volume, 0.4 * q(0) * q(1) * q(2)) << q.transpose();
    ASSERT_LT(volume, 1.2 * q(0) * q(1) * q(2)) << q.transpose();
  }
}

TEST_F(ShippedBoat, HasTheDerivativesOfItsDifferences) {
  constexpr double kStep = 1e-6;
  std::mt19937_64 random(5);
  for (int k = 0; k < 3; ++k) {
    // Away from the ends, so that the steps stay in the box.
    const Eigen::VectorXd q = 0.9 * model_->Defaults() + 0.1 * Point(2, random);
    const auto jacobian = model_->Jacobian(q);
    const auto volume = model_->Volume(q);
    ASSERT_TRUE(jacobian.ok()) << jacobian.status();
    ASSERT_TRUE(volume.ok()) << volume.status();
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      Eigen::VectorXd before = q, after = q;
      before(i) -= kStep;
      after(i) += kStep;
      const auto low = model_->Evaluate(before), high = model_->Evaluate(after);
      ASSERT_TRUE(low.ok() && high.ok()) << low.status() << high.status();
      const Eigen::Matrix3Xd difference =
          (high->surface.vertices - low->surface.vertices) / (2 * kStep);
      EXPECT_LT((difference.reshaped() - jacobian->col(i)).cwiseAbs().maxCoeff(), 1e-8) << i;
      const double change = (mesh::ComputeMassProperties(high->surface).volume -
                             mesh::ComputeMassProperties(low->surface).volume) /
                            (2 * kStep);
      EXPECT_NEAR(volume->gradient(i), change, 1e-9 + 1e-6 * std::abs(change)) << i;
    }
    const auto here = model_->Evaluate(q);
    ASSERT_TRUE(here.ok()) << here.status();
    EXPECT_DOUBLE_EQ(volume->value, mesh::ComputeMassProperties(here->surface).volume);
  }
}

}  // namespace
}  // namespace mortise::parametric
