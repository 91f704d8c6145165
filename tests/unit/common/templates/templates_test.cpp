// One interface to all kinds of templates: parts and features here, assemblies in their own file.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "common/base/errors.h"
#include "common/cad/faceted_solid.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/mesh/mass_properties.h"
#include "common/templates/template_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::templates {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

v1::TemplateBundle Completed(const std::string& name) {
  v1::TemplateBundle bundle = ShippedTemplate(name);
  EXPECT_EQ(FillAndCheck(bundle, Trial::kDefaults), absl::OkStatus());
  return bundle;
}

TEST(TemplatesTest, FeaturesFillInWhatTheServiceSays) {
  const v1::TemplateBundle bundle = Completed("templates/wrench");
  const v1::Template& message = bundle.template_();
  EXPECT_EQ(message.title(), message.cad().title());
  EXPECT_EQ(message.parameters_size(), 3);
  EXPECT_EQ(message.parameters(0).name(), "handle_length");
  EXPECT_EQ(message.digest().size(), 64U);
  // Completing again what was completed changes nothing.
  v1::TemplateBundle again = bundle;
  ASSERT_EQ(FillAndCheck(again, Trial::kThorough), absl::OkStatus());
  EXPECT_EQ(again.SerializeAsString(), bundle.SerializeAsString());
}

TEST(TemplatesTest, ASolidOfFeaturesIsOnePartWithItsSurface) {
  const v1::TemplateBundle bundle = Completed("templates/wrench");
  const auto wrench = Compile(bundle);
  ASSERT_TRUE(wrench.ok()) << wrench.status();
  const Eigen::VectorXd q = parametric::Defaults((*wrench)->parameters());
  const auto design = (*wrench)->Evaluate(q);
  ASSERT_TRUE(design.ok()) << design.status();
  EXPECT_EQ(design->template_name, "templates/wrench");
  EXPECT_EQ(design->parameters.size(), 3U);
  ASSERT_EQ(design->parts.size(), 1U);
  const parametric::EvaluatedPart& part = design->parts[0];
  ASSERT_TRUE(part.faceted.has_value());
  EXPECT_EQ(part.material, "materials/steel");
  // Steel weighs 7.8 to 7.9 t/m³; the facets enclose what the solid does but for its curves.
  EXPECT_NEAR(part.mass / part.volume, 7850, 60);
  const double enclosed = mesh::ComputeMassProperties(part.faceted->surface).volume;
  EXPECT_NEAR(enclosed, part.volume, 0.005 * part.volume);
  // Every triangle is on a face, and every condition has one.
  EXPECT_EQ(part.faceted->triangle_face.size(), part.faceted->surface.triangles.cols());
  ASSERT_FALSE(design->boundary_conditions.empty());
  for (const auto& condition : design->boundary_conditions) {
    EXPECT_THAT(part.faceted->face_names, Contains(Contains(condition.face)));
  }
  const auto solids = (*wrench)->Solids(q);
  ASSERT_TRUE(solids.ok()) << solids.status();
  ASSERT_EQ(solids->size(), 1U);
  EXPECT_DOUBLE_EQ(solids->front().Volume(), part.volume);
}

// Who evaluates a design often asks for its solid next; others may ask for another meanwhile.
TEST(TemplatesTest, SolidsAreThoseOfTheirOwnParameters) {
  const auto wrench = Compile(Completed("templates/wrench"));
  ASSERT_TRUE(wrench.ok()) << wrench.status();
  const auto check = [&](double share) {
    Eigen::VectorXd q = parametric::Defaults((*wrench)->parameters());
    q(0) += share * ((*wrench)->parameters()[0].maximum - q(0));
    for (int i = 0; i < 3; ++i) {
      const auto design = (*wrench)->Evaluate(q);
      const auto solids = (*wrench)->Solids(q);
      ASSERT_TRUE(design.ok() && solids.ok());
      EXPECT_NEAR(solids->front().Volume(), design->parts[0].volume,
                  1e-9 * design->parts[0].volume);
    }
  };
  std::vector<std::thread> threads;
  for (const double share : {0.0, 0.3, 0.6}) {
    threads.emplace_back([&check, share] { check(share); });
  }
  for (std::thread& thread : threads) thread.join();
  const Eigen::VectorXd defaults = parametric::Defaults((*wrench)->parameters());
  Eigen::VectorXd longer = defaults;
  longer(0) = (*wrench)->parameters()[0].maximum;
  const auto before = (*wrench)->Solids(defaults), other = (*wrench)->Solids(longer);
  ASSERT_TRUE(before.ok() && other.ok());
  EXPECT_GT(other->front().Volume(), 1.1 * before->front().Volume());
}

TEST(TemplatesTest, ADesignOfFeaturesSurvivesItsMessage) {
  const auto wrench = Compile(Completed("templates/wrench"));
  ASSERT_TRUE(wrench.ok()) << wrench.status();
  const auto design = (*wrench)->Evaluate(parametric::Defaults((*wrench)->parameters()));
  ASSERT_TRUE(design.ok()) << design.status();
  const v1::EvaluatedDesign message = parametric::ToProto(*design);
  const auto back = parametric::FromProto(message);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(parametric::ToProto(*back).SerializeAsString(), message.SerializeAsString());
}

TEST(TemplatesTest, MessagesWithTrianglesOfNoVertexAreRefused) {
  const auto wrench = Compile(Completed("templates/wrench"));
  ASSERT_TRUE(wrench.ok()) << wrench.status();
  const auto design = (*wrench)->Evaluate(parametric::Defaults((*wrench)->parameters()));
  ASSERT_TRUE(design.ok()) << design.status();
  v1::EvaluatedDesign message = parametric::ToProto(*design);
  message.mutable_parts(0)->mutable_faceted()->set_triangles(4, 1 << 20);
  EXPECT_EQ(DetailOf(parametric::FromProto(message).status()).field, "parts[0].faceted");
  message = parametric::ToProto(*design);
  message.mutable_parts(0)->mutable_faceted()->set_triangle_faces(0, -1);
  EXPECT_EQ(DetailOf(parametric::FromProto(message).status()).field, "parts[0].faceted");
}

TEST(TemplatesTest, PartsOfferGradientsAndFeaturesDoNot) {
  const auto table = Compile(Completed("templates/table"));
  ASSERT_TRUE(table.ok()) << table.status();
  const Eigen::VectorXd q = parametric::Defaults((*table)->parameters());
  ASSERT_TRUE((*table)->OffersMassGradient());
  const auto mass = (*table)->Mass(q);
  ASSERT_TRUE(mass.ok()) << mass.status();
  const auto design = (*table)->Evaluate(q);
  ASSERT_TRUE(design.ok()) << design.status();
  EXPECT_NEAR(mass->mass, design->mass, 1e-9 * design->mass);
  const auto solids = (*table)->Solids(q);
  ASSERT_TRUE(solids.ok()) << solids.status();
  ASSERT_EQ(solids->size(), design->parts.size());
  for (std::size_t i = 0; i < solids->size(); ++i) {
    EXPECT_NEAR((*solids)[i].Volume(), design->parts[i].volume, 1e-9);
  }
  const auto wrench = Compile(Completed("templates/wrench"));
  ASSERT_TRUE(wrench.ok()) << wrench.status();
  EXPECT_FALSE((*wrench)->OffersMassGradient());
  EXPECT_EQ((*wrench)->Mass(parametric::Defaults((*wrench)->parameters())).status().code(),
            absl::StatusCode::kFailedPrecondition);
}

TEST(TemplatesTest, AMeshInACageHasExactGradients) {
  const auto boat = Compile(Completed("templates/boat"));
  ASSERT_TRUE(boat.ok()) << boat.status();
  ASSERT_EQ((*boat)->parameters().size(), 12U);
  const Eigen::VectorXd q = parametric::Defaults((*boat)->parameters());
  const auto design = (*boat)->Evaluate(q);
  ASSERT_TRUE(design.ok()) << design.status();
  ASSERT_EQ(design->parts.size(), 1U);
  ASSERT_TRUE(design->parts[0].faceted.has_value());
  // The facets are the shape.
  EXPECT_NEAR(mesh::ComputeMassProperties(design->parts[0].faceted->surface).volume,
              design->parts[0].volume, 1e-9 * design->parts[0].volume);
  ASSERT_TRUE((*boat)->OffersMassGradient());
  const auto mass = (*boat)->Mass(q);
  ASSERT_TRUE(mass.ok()) << mass.status();
  EXPECT_NEAR(mass->mass, design->mass, 1e-12);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const parametric::Parameter& parameter = (*boat)->parameters()[static_cast<std::size_t>(i)];
    const double step = 1e-5 * (parameter.maximum - parameter.minimum);
    Eigen::VectorXd more = q, less = q;
    more(i) += step;
    less(i) -= step;
    const double slope = ((*boat)->Mass(more)->mass - (*boat)->Mass(less)->mass) / (2 * step);
    EXPECT_NEAR(mass->mass_gradient(i), slope, 1e-6 * mass->mass_gradient.norm());
  }
}

// Planes, however the cage bends what was drawn, that bound one solid which the kernel finds sound:
// else it would be refused.
TEST(TemplatesTest, AMeshInACageIsASolidOfItsFacets) {
  const auto boat = Compile(Completed("templates/boat"));
  ASSERT_TRUE(boat.ok()) << boat.status();
  const std::vector<parametric::Parameter>& parameters = (*boat)->parameters();
  for (const double share : {0.0, 0.4, 1.0}) {
    SCOPED_TRACE(share);
    Eigen::VectorXd q(static_cast<Eigen::Index>(parameters.size()));
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const parametric::Parameter& parameter = parameters[static_cast<std::size_t>(i)];
      q(i) = parameter.minimum + share * (parameter.maximum - parameter.minimum);
    }
    const auto design = (*boat)->Evaluate(q);
    ASSERT_TRUE(design.ok()) << design.status();
    const auto solids = (*boat)->Solids(q);
    ASSERT_TRUE(solids.ok()) << solids.status();
    ASSERT_EQ(solids->size(), 1U);
    EXPECT_EQ(solids->front().name(), "boat");
    EXPECT_NEAR(solids->front().Volume(), design->parts[0].volume, 1e-6 * design->parts[0].volume);
  }
}

// A cube's surface; `outward` or, of a hollow, inward.
void AddCube(double lower, double upper, bool outward, v1::CageSurface& surface) {
  const int first = surface.vertices_size() / 3;
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      surface.add_vertices((corner >> axis & 1) != 0 ? upper : lower);
    }
  }
  const int triangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  v1::CageFace& face = *surface.add_faces();
  face.set_name("cube" + std::to_string(first));
  for (const auto& [a, b, c] : triangles) {
    for (const int corner : {a, outward ? b : c, outward ? c : b}) {
      face.add_triangles(first + corner);
    }
  }
}

// Cubes in a cage that is a cube itself and grows in width.
v1::TemplateBundle Cubes(const v1::CageSurface& surface) {
  v1::TemplateBundle bundle = ShippedTemplate("templates/boat");
  v1::CageTemplate& cubes = *bundle.mutable_template_()->mutable_cage();
  cubes.clear_parameters();
  cubes.clear_definitions();
  cubes.clear_conditions();
  cubes.clear_cage();
  v1::Parameter& width = *cubes.add_parameters();
  width.set_name("width");
  width.set_unit("m");
  width.set_minimum(1);
  width.set_maximum(2);
  width.set_default_value(1);
  *cubes.mutable_surface() = surface;
  v1::CageSurface cube;
  AddCube(0, 1, true, cube);
  for (int i = 0; i < cube.vertices_size(); i += 3) {
    v1::SpacePoint& point = *cubes.mutable_cage()->add_vertices();
    point.set_x(cube.vertices(i) > 0 ? "width" : "0");
    point.set_y(cube.vertices(i + 1) > 0 ? "1" : "0");
    point.set_z(cube.vertices(i + 2) > 0 ? "1" : "0");
  }
  *cubes.mutable_cage()->mutable_triangles() = cube.faces(0).triangles();
  EXPECT_EQ(FillAndCheck(bundle, Trial::kDefaults), absl::OkStatus());
  return bundle;
}

TEST(TemplatesTest, AMeshInACageMayHaveHollows) {
  v1::CageSurface surface;
  AddCube(0.1, 0.9, true, surface);
  AddCube(0.3, 0.5, false, surface);
  const auto hollow = Compile(Cubes(surface));
  ASSERT_TRUE(hollow.ok()) << hollow.status();
  const auto solids = (*hollow)->Solids(Eigen::VectorXd::Constant(1, 1.5));
  ASSERT_TRUE(solids.ok()) << solids.status();
  EXPECT_NEAR(solids->front().Volume(), 1.5 * (0.512 - 0.008), 1e-9);
  EXPECT_TRUE(cad::IsSound(solids->front()));
}

// They can be weighed and looked at, but are no solid.
TEST(TemplatesTest, SeveralMeshesInACageAreNoSolid) {
  v1::CageSurface surface;
  AddCube(0.1, 0.3, true, surface);
  AddCube(0.5, 0.9, true, surface);
  const auto two = Compile(Cubes(surface));
  ASSERT_TRUE(two.ok()) << two.status();
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 1.5);
  EXPECT_TRUE((*two)->Evaluate(q).ok());
  const absl::Status refused = (*two)->Solids(q).status();
  EXPECT_EQ(DetailOf(refused).reason, "NO_SOLID");
  EXPECT_THAT(std::string(refused.message()),
              AllOf(HasSubstr("2 solids"), HasSubstr("GLB, OBJ or STL")));
}

TEST(TemplatesTest, ParametersOutOfRangeAreNamedWhateverTheKind) {
  for (const char* name : {"templates/table", "templates/wrench", "templates/boat"}) {
    const auto compiled = Compile(Completed(name));
    ASSERT_TRUE(compiled.ok()) << compiled.status();
    Eigen::VectorXd q = parametric::Defaults((*compiled)->parameters());
    q(1) = 1e6;
    EXPECT_EQ(DetailOf((*compiled)->Evaluate(q).status()).field, "parameters[1].value") << name;
    q(1) = std::nan("");
    EXPECT_EQ(DetailOf((*compiled)->Solids(q).status()).field, "parameters[1].value") << name;
    EXPECT_EQ(DetailOf((*compiled)->Evaluate(q.head(1)).status()).field, "parameters") << name;
  }
}

TEST(TemplatesTest, WhatIsWrongIsToldAtOnceWithItsPlace) {
  v1::TemplateBundle bundle = ShippedTemplate("templates/wrench");
  v1::Template& message = *bundle.mutable_template_();
  message.mutable_cad()->mutable_parameters(0)->set_minimum(1);
  message.mutable_cad()->mutable_definitions(0)->set_value("1 / (");
  const absl::Status status = FillAndCheck(bundle, Trial::kDefaults);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("cad.parameters[0]"));
  EXPECT_THAT(status.message(), HasSubstr("cad.definitions[0]"));
}

TEST(TemplatesTest, MaterialsThatAreNotThereAreNamed) {
  v1::TemplateBundle bundle = ShippedTemplate("templates/wrench");
  bundle.mutable_template_()->mutable_cad()->set_material("materials/unobtainium");
  const absl::Status status = FillAndCheck(bundle, Trial::kDefaults);
  EXPECT_EQ(DetailOf(status).field, "cad.material");
  EXPECT_THAT(status.message(), HasSubstr("materials/unobtainium"));
}

TEST(TemplatesTest, AKindSaysWhatItIsByItself) {
  v1::TemplateBundle bundle = ShippedTemplate("templates/wrench");
  bundle.mutable_template_()->add_parts()->set_name("stray");
  EXPECT_EQ(DetailOf(FillAndCheck(bundle, Trial::kDefaults)).field, "parts");
  bundle = ShippedTemplate("templates/wrench");
  bundle.mutable_template_()->set_title("Spanner");
  EXPECT_EQ(DetailOf(FillAndCheck(bundle, Trial::kDefaults)).field, "title");
  bundle = ShippedTemplate("templates/wrench");
  bundle.mutable_template_()->add_parameters()->set_name("other");
  EXPECT_EQ(DetailOf(FillAndCheck(bundle, Trial::kDefaults)).field, "parameters");
  bundle = ShippedTemplate("templates/wrench");
  bundle.mutable_template_()->mutable_cad()->set_name("templates/spanner");
  EXPECT_EQ(DetailOf(FillAndCheck(bundle, Trial::kDefaults)).field, "cad.name");
}

TEST(TemplatesTest, NothingMoreIsTriedForWhoHasGivenUp) {
  v1::TemplateBundle bundle = ShippedTemplate("templates/wrench");
  int asked = 0;
  const absl::Status status =
      FillAndCheck(bundle, Trial::kThorough, [&asked] { return ++asked >= 2; });
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << status;
  EXPECT_LE(asked, 3) << "of six ends of parameters";
}

TEST(TemplatesTest, DesignsThatCannotBeMadeAtTheEndsAreRefused) {
  v1::TemplateBundle bundle = ShippedTemplate("templates/wrench");
  v1::CadTemplate& cad = *bundle.mutable_template_()->mutable_cad();
  // A chamfer wider than the head: the kernel cannot make it, which only trying shows.
  for (v1::Feature& feature : *cad.mutable_features()) {
    if (!feature.has_chamfer()) continue;
    feature.mutable_chamfer()->set_distance("max(0.0008, handle_length - 0.18)");
  }
  const absl::Status status = FillAndCheck(bundle, Trial::kThorough);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("at handle_length = 0.24"));
  EXPECT_THAT(DetailOf(status).field, HasSubstr("cad.features["));
}

// A bore that crosses the rounded edge, as deep as the fillet is wide: the kernel crashes over it.
TEST(TemplatesTest, DesignsThatTheKernelCrashesOverAreRefused) {
  v1::TemplateBundle bundle = ShippedTemplate("templates/wrench");
  v1::CadTemplate& cad = *bundle.mutable_template_()->mutable_cad();
  cad.clear_features();
  cad.clear_metric_definitions();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      "features { name: 'outline' sketch { plane { normal { x: '1' } } profiles { name: 'section' "
      "rectangle { center { x: '0.02' y: '0.02' } width: '0.04' height: '0.04' } } } } "
      "features { name: 'bar' extrude { sketch: 'outline' to: '0.4' } } "
      "features { name: 'bore' hole { face: 'bar.section.top' position { x: '0.2' y: '0' z: "
      "'0.04' } diameter: '0.008' } } "
      "features { name: 'round' fillet { edges: 'bar.section.bottom & bar.section.left' radius: "
      "'0.004' } }",
      &cad));
  const absl::Status status = FillAndCheck(bundle, Trial::kThorough);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(status).field, "cad.features[3].fillet.radius") << status;
  EXPECT_THAT(status.message(), AllOf(HasSubstr("'round'"), HasSubstr("0.004 m"),
                                      HasSubstr("bar.section.bottom & bar.section.left")));
}

TEST(TemplatesTest, SummariesTellTheKindAndNoMore) {
  const v1::Template wrench = SummaryOf(Completed("templates/wrench").template_());
  EXPECT_TRUE(wrench.has_cad());
  EXPECT_EQ(wrench.cad().features_size(), 0);
  EXPECT_EQ(wrench.parameters_size(), 3);
  EXPECT_EQ(SummaryOf(Completed("templates/table").template_()).parts_size(), 0);
}

}  // namespace
}  // namespace mortise::templates
