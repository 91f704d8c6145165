// What every CAD template that ships has to hold, for the tests of collection/cad_templates.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <random>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/files.h"
#include "common/cad/solid_surface.h"
#include "common/templates/features/codec/cad_template_codec.h"
#include "common/templates/features/feature_model.h"

namespace mortise::cad {

struct ShippedTemplate {
  const char* file;  // without .textproto
  int parameters;    // as the thesis has them
};

inline void PrintTo(const ShippedTemplate& shipped, std::ostream* out) { *out << shipped.file; }

// The default, then corners of the parameter box and points inside it by turns; always the same.
inline Eigen::VectorXd PointOf(const CadTemplate& definition, int index, std::mt19937_64& random) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(definition.parameters.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const auto& parameter = definition.parameters[static_cast<std::size_t>(i)];
    double t = static_cast<double>(random() >> 11) * 0x1p-53;
    if (index % 4 == 1) t = t < 0.5 ? 0 : 1;
    q(i) =
        index == 0 ? parameter.default_value : (1 - t) * parameter.minimum + t * parameter.maximum;
  }
  return q;
}

inline double VolumeWithin(const mesh::AssemblySurface& surface) {
  double volume = 0;
  for (Eigen::Index i = 0; i < surface.triangles.cols(); ++i) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, i));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, i));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, i));
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

class ShippedTemplateTest : public testing::TestWithParam<ShippedTemplate> {
 protected:
  static constexpr int kPoints = 12;   // the bench makes 200
  static constexpr int kSurfaces = 5;  // of the first points

  void SetUp() override {
    const char* root = std::getenv("MORTISE_SOURCE_DIR");
    const std::string path = absl::StrCat(
        root == nullptr ? "." : root, "/collection/cad_templates/", GetParam().file, ".textproto");
    const auto text = ReadFile(path);
    ASSERT_TRUE(text.ok()) << text.status();
    auto definition = ParseCadTemplateText(*text, GetParam().file);
    ASSERT_TRUE(definition.ok()) << definition.status();
    definition_ = *std::move(definition);
  }

  CadTemplate definition_;
};

TEST_P(ShippedTemplateTest, HasTheParametersOfTheThesisAndConditions) {
  EXPECT_EQ(definition_.parameters.size(), static_cast<std::size_t>(GetParam().parameters));
  std::string id = GetParam().file;
  for (char& c : id) c = c == '_' ? '-' : c;
  EXPECT_EQ(definition_.name, "templates/" + id);
  for (const auto& parameter : definition_.parameters) {
    EXPECT_FALSE(parameter.title.empty() || parameter.description.empty()) << parameter.name;
  }
  const auto model = FeatureModel::Create(definition_);
  ASSERT_TRUE(model.ok()) << model.status();
  const auto solid = model->Regenerate(model->Defaults());
  ASSERT_TRUE(solid.ok()) << solid.status();
  ASSERT_FALSE(solid->conditions.empty());
  EXPECT_EQ(solid->conditions.front().kind, parametric::BoundaryConditionKind::kFixed);
}

TEST_P(ShippedTemplateTest, IsAValidSolidEverywhere) {
  const auto model = FeatureModel::Create(definition_);
  ASSERT_TRUE(model.ok()) << model.status();
  std::mt19937_64 random(2026);
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::VectorXd q = PointOf(definition_, i, random);
    // Regenerate answers with an error where the kernel's check finds the solid invalid.
    const auto solid = model->Regenerate(q);
    ASSERT_TRUE(solid.ok()) << "point " << i << ", q = " << q.transpose() << ": " << solid.status();
    EXPECT_GT(solid->solid.Volume(), 0) << q.transpose();
    for (const parametric::FaceCondition& condition : solid->conditions) {
      EXPECT_FALSE(condition.faces.empty()) << condition.name << " at " << q.transpose();
    }
    if (i >= kSurfaces) continue;
    const auto surface = SurfaceOf(solid->solid);
    ASSERT_TRUE(surface.ok()) << "q = " << q.transpose() << ": " << surface.status();
    EXPECT_NEAR(VolumeWithin(*surface), solid->solid.Volume(), 0.03 * solid->solid.Volume());
  }
}

inline std::string NameOf(const testing::TestParamInfo<ShippedTemplate>& info) {
  return info.param.file;
}

}  // namespace mortise::cad
