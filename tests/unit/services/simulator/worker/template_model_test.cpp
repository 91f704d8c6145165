// Templates of every kind as finite element models.
#include "services/simulator/worker/template_model.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/substitute.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/base/errors.h"
#include "common/cad/cylinder.h"
#include "common/cad/stretch/solid_shape.h"
#include "common/design/parameter_values.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/templates/template_codec.h"
#include "services/simulator/worker/design_conditions.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::simulator {
namespace {

using parametric::EvaluatedDesign;

struct Subject {
  std::shared_ptr<const templates::Template> design_template;
  Eigen::VectorXd parameters;
  EvaluatedDesign design;

  absl::StatusOr<DesignModel> Model() const {
    return MakeDesignModel(*design_template, parameters, design);
  }
};

Subject At(const Subject& other, const Eigen::VectorXd& parameters) {
  auto design = other.design_template->Evaluate(parameters);
  EXPECT_TRUE(design.ok()) << design.status();
  return {other.design_template, parameters, *std::move(design)};
}

Subject AtDefaults(v1::TemplateBundle bundle) {
  EXPECT_EQ(templates::FillAndCheck(bundle, templates::Trial::kDefaults), absl::OkStatus());
  auto function = templates::Compile(bundle);
  EXPECT_TRUE(function.ok()) << function.status();
  return At({*function, {}, {}}, parametric::Defaults((*function)->parameters()));
}

double ValueOf(const DesignAnalysis& analysis, const std::string& name) {
  for (const Metric& metric : analysis.metrics) {
    if (metric.name == name) return metric.value;
  }
  ADD_FAILURE() << "there is no " << name;
  return 0;
}

TEST(TemplateModelTest, ASolidOfFeaturesBendsUnderItsLoad) {
  const Subject wrench = AtDefaults(templates::ShippedTemplate("templates/wrench"));
  const auto model = wrench.Model();
  ASSERT_TRUE(model.ok()) << model.status();
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.004;
  const auto analysis =
      AnalyzeDesign(*model, {"mass", "max_displacement", "max_von_mises"}, true, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_NEAR(ValueOf(*analysis, "mass"), wrench.design.mass, 0.01 * wrench.design.mass);
  EXPECT_GT(ValueOf(*analysis, "max_displacement"), 1e-5);
  EXPECT_LT(ValueOf(*analysis, "max_displacement"), 5e-3);
  // 250 N at the handle: a force spread over all of its faces together, held at the jaw.
  const ElasticitySummary& summary = analysis->cases[0].solution.summary;
  EXPECT_NEAR(summary.total_load.norm(), 250, 1e-6);
  EXPECT_LT((summary.total_load + summary.total_reaction).norm(), 1e-4);
}

TEST(TemplateModelTest, WhatOnlyConnectsPartsIsLeftOut) {
  const Subject shelf = AtDefaults(templates::ShippedAssembly("assemblies/bookshelf"));
  std::size_t principal = 0;
  for (const parametric::EvaluatedPart& part : shelf.design.parts) principal += !part.connecting;
  ASSERT_LT(principal, shelf.design.parts.size());
  const auto model = shelf.Model();
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(model->surface.part_names.size(), principal);
  EXPECT_EQ(model->analysis.materials.size(), principal);
}

// The headboard of the bed without the bed: held by its cleats, leaned on at the top.
TEST(TemplateModelTest, ASubTreeOfAnAssemblyBendsByItself) {
  v1::TemplateBundle bundle = templates::ShippedAssembly("assemblies/bed");
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      R"(assembly { group: "headboard" }
         boundary_conditions { name: "left" kind: FIXED part: "cleat 1" face: "z_min" }
         boundary_conditions { name: "right" kind: FIXED part: "cleat 2" face: "z_min" }
         boundary_conditions { name: "back" kind: FORCE part: "headboard board 3" face: "z_max"
                               components: "0" components: "300" components: "0" })",
      bundle.mutable_template_()));
  const Subject headboard = AtDefaults(bundle);
  const auto model = headboard.Model();
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(model->surface.part_names.size(), 5U);  // two cleats, three boards
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.05;
  const auto analysis = AnalyzeDesign(*model, {"max_displacement"}, false, options);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_GT(ValueOf(*analysis, "max_displacement"), 1e-5);
  EXPECT_NEAR(analysis->cases[0].solution.summary.total_load.y(), 300, 1e-6);
}

TEST(TemplateModelTest, PartsWithoutMaterialAreNamed) {
  Subject wrench = AtDefaults(templates::ShippedTemplate("templates/wrench"));
  wrench.design.parts[0].material = "materials/none";
  const absl::Status status = wrench.Model().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "NO_MATERIAL");
  EXPECT_EQ(DetailOf(status).field, "part 'wrench'");
}

TEST(TemplateModelTest, WoodHasItsGrainWhereThePartsItemSays) {
  const Subject table = AtDefaults(templates::ShippedTemplate("templates/table"));
  const auto model = table.Model();
  ASSERT_TRUE(model.ok()) << model.status();
  int wooden = 0;
  for (std::size_t i = 0; i < table.design.parts.size(); ++i) {
    const parametric::EvaluatedPart& part = table.design.parts[i];
    const Material& material = model->analysis.materials[i];
    ASSERT_TRUE(material.orthotropy.has_value()) << part.name;
    ++wooden;
    const Eigen::Matrix3d& axes = material.orthotropy->axes;
    // A part as long as its stock's grain: along it, the part is longest, and thin across the
    // rings.
    const Eigen::Vector3d extent = part.maximum - part.minimum;
    EXPECT_NEAR(extent.dot(axes.col(0).cwiseAbs()), part.size.x(), 1e-9) << part.name;
    EXPECT_NEAR(extent.dot(axes.col(1).cwiseAbs()), part.size.z(), 1e-9) << part.name;
    EXPECT_GT(material.orthotropy->youngs_modulus[0], 5 * material.orthotropy->youngs_modulus[2]);
  }
  EXPECT_GE(wooden, 9);
  const auto wrench = AtDefaults(templates::ShippedTemplate("templates/wrench")).Model();
  ASSERT_TRUE(wrench.ok()) << wrench.status();
  EXPECT_FALSE(wrench->analysis.materials[0].orthotropy.has_value());
}

// A solid as the catalog gives it to workers.
v1::Shape ShapeOf(const cad::Solid& solid, const Eigen::Vector3d& size) {
  const auto drawn = cad::ShapeOfSolid(solid, Eigen::Matrix3d::Identity(), {0, 0, 0}, size);
  EXPECT_TRUE(drawn.ok()) << drawn.status();
  v1::Shape message = parametric::ToProto(*drawn);
  message.set_name(parametric::NameOf(message));
  return message;
}

v1::TemplateBundle BundleOf(const std::string& assembly, const std::string& conditions,
                            const std::vector<v1::Shape>& shapes) {
  v1::TemplateBundle bundle = templates::ShippedAssembly("assemblies/bookshelf");
  bundle.clear_assembly();
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(assembly, bundle.mutable_assembly()));
  v1::Template& message = *bundle.mutable_template_();
  message.Clear();
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(conditions, &message));
  message.set_name("templates/drawn");
  message.mutable_assembly()->set_assembly(bundle.assembly().name());
  for (const v1::Shape& shape : shapes) *bundle.add_shapes() = shape;
  return bundle;
}

constexpr double kRadius = 0.02;  // m
constexpr double kHeight = 0.4;   // m

v1::Shape TurnedLeg() {
  cad::CylinderShape leg;
  leg.name = "leg";
  leg.center = {kRadius, kRadius, 0};
  leg.radius_u = leg.radius_v = kRadius;
  leg.height = kHeight;
  return ShapeOf(cad::MakeCylinder(leg).value(), {2 * kRadius, 2 * kRadius, kHeight});
}

// A seat on four turned legs, or `gap` above them, on pads that only connect.
v1::TemplateBundle Stool(const v1::Shape& leg, double gap = 0) {
  const std::string beech = "item: 'items/beech-planed-2400' length_axis: Z thickness_axis: Y";
  std::string assembly = absl::Substitute(
      "name: 'assemblies/stool' parts { name: 'seat' item: 'items/panel-beech' position { z: $0 } "
      "size { x: 0.5 y: 0.4 z: 0.03 } } ",
      kHeight + gap);
  std::string conditions;
  for (int i = 0; i < 4; ++i) {
    const double x = i % 2 == 0 ? 0.05 : 0.41, y = i < 2 ? 0.05 : 0.31;
    absl::StrAppend(&assembly,
                    absl::Substitute("parts { name: 'leg $0' $1 shape: '$2' position { x: $3 y: $4 "
                                     "} size { x: 0.04 y: 0.04 z: 0.4 } } ",
                                     i, beech, leg.name(), x, y));
    absl::StrAppend(
        &conditions,
        absl::Substitute(
            "boundary_conditions { name: 'foot $0' kind: FIXED part: 'leg $0' face: 'z_min' } ",
            i));
    if (gap == 0) continue;
    absl::StrAppend(&assembly,
                    absl::Substitute("parts { name: 'pad $0' role: CONNECTING position { x: $1 y: "
                                     "$2 z: 0.4 } size { x: 0.04 y: 0.04 z: $3 } } ",
                                     i, x, y, gap));
  }
  absl::StrAppend(&conditions,
                  "boundary_conditions { name: 'load' kind: FORCE part: 'seat' face: 'z_max' "
                  "components: '0' components: '0' components: '-1000' }");
  return BundleOf(assembly, conditions, {leg});
}

double VolumeOf(const mesh::AssemblySurface& surface, std::size_t part) {
  return mesh::ComputeMassProperties(mesh::PartSurface(surface, static_cast<int>(part))).volume;
}

// At any parameters: legs become oval, but stay glued, and conditions find their faces.
TEST(TemplateModelTest, PartsWithShapesAreGluedWhereTheyTouch) {
  const Subject drawn = AtDefaults(Stool(TurnedLeg()));
  const auto& parameters = drawn.design_template->parameters();
  for (const double share : {-1.0, 0.3, 0.7}) {
    SCOPED_TRACE(share);
    Eigen::VectorXd q = drawn.parameters;
    if (share >= 0) {
      const auto last = parameters.size() - 1;
      for (const std::size_t i : {std::size_t{0}, last}) {
        q(static_cast<Eigen::Index>(i)) =
            (1 - share) * parameters[i].minimum + share * parameters[i].maximum;
      }
    }
    const Subject stool = At(drawn, q);
    const auto model = stool.Model();
    ASSERT_TRUE(model.ok()) << model.status();
    int glued = 0;
    for (const mesh::AssemblyFace& face : model->surface.faces) glued += face.front_part >= 0;
    EXPECT_EQ(glued, 4);
    for (std::size_t i = 0; i < stool.design.parts.size(); ++i) {
      const double exact = stool.design.parts[i].volume;
      EXPECT_NEAR(VolumeOf(model->surface, i), exact, 0.05 * exact) << stool.design.parts[i].name;
    }
    DesignAnalysisOptions options;
    options.mesh.quadratic = false;
    const auto analysis = AnalyzeDesign(*model, {"mass", "max_displacement"}, true, options);
    ASSERT_TRUE(analysis.ok()) << analysis.status();
    EXPECT_NEAR(ValueOf(*analysis, "mass"), stool.design.mass, 0.01 * stool.design.mass);
    const ElasticitySummary& summary = analysis->cases[0].solution.summary;
    EXPECT_NEAR(summary.total_load.z(), -1000, 1e-6);
    EXPECT_LT((summary.total_load + summary.total_reaction).norm(), 1e-3);
  }
}

// A bar of one piece, and the same bar of a shaped piece and a box let into it.
TEST(TemplateModelTest, ABarOfTwoPiecesBendsAsOneOfOnePiece) {
  mesh::PartShape step;
  step.name = "step";
  step.u = Eigen::Vector3d::UnitX();
  step.v = -Eigen::Vector3d::UnitZ();
  step.origin = {0, 0, 0.04};
  step.outline.resize(2, 6);
  step.outline << 0, 0, 0.4, 0.4, 0.2, 0.2,  //
      0, 0.04, 0.04, 0.02, 0.02, 0;
  // Seen along the outline's own normal it must run counter-clockwise.
  step.outline = step.outline.rowwise().reverse().eval();
  step.origin.y() = 0;
  step.height = 0.03;
  for (int i = 0; i < 8; ++i) step.face_names.push_back(absl::StrCat("face", i));
  const auto solid = cad::Solid::FromPart(step);
  ASSERT_TRUE(solid.ok()) << solid.status();
  const std::string conditions =
      "boundary_conditions { name: 'wall' kind: FIXED part: '$0' face: 'x_min' } "
      "boundary_conditions { name: 'pull' kind: FORCE part: '$0' face: '$1' components: '0' "
      "components: '0' components: '-10' }";
  const std::string item = "item: 'items/beech-planed-2400'";
  const v1::Shape shape = ShapeOf(*solid, {0.4, 0.03, 0.04});
  const Subject two = AtDefaults(BundleOf(
      absl::Substitute("name: 'assemblies/bar' parts { name: 'step' $0 shape: '$1' size { x: 0.4 "
                       "y: 0.03 z: 0.04 } } parts { name: 'inlay' $0 position { x: 0.2 z: 0.02 } "
                       "size { x: 0.2 y: 0.03 z: 0.02 } }",
                       item, shape.name()),
      absl::Substitute(conditions, "step", "z_min"), {shape}));
  const Subject one = AtDefaults(BundleOf(
      absl::Substitute(
          "name: 'assemblies/bar' parts { name: 'bar' $0 size { x: 0.4 y: 0.03 z: 0.04 } }", item),
      absl::Substitute(conditions, "bar", "z_min"), {}));
  double sinks[2];
  const Subject* const subjects[] = {&two, &one};
  for (int i = 0; i < 2; ++i) {
    const auto model = subjects[i]->Model();
    ASSERT_TRUE(model.ok()) << model.status();
    DesignAnalysisOptions options;
    options.mesh.element_size = 0.02;
    const auto analysis = AnalyzeDesign(*model, {"mass", "max_displacement"}, true, options);
    ASSERT_TRUE(analysis.ok()) << analysis.status();
    sinks[i] = ValueOf(*analysis, "max_displacement");
    EXPECT_NEAR(ValueOf(*analysis, "mass"), one.design.mass, 1e-9);
  }
  EXPECT_NEAR(sinks[0], sinks[1], 0.005 * sinks[1]);
}

TEST(TemplateModelTest, SaysWhatWasLeftOutWhereAPartIsFree) {
  const Subject stool = AtDefaults(Stool(TurnedLeg(), 0.01));
  const auto model = stool.Model();
  ASSERT_TRUE(model.ok()) << model.status();
  DesignAnalysisOptions options;
  options.mesh.quadratic = false;
  const auto analysis = AnalyzeDesign(*model, {"max_displacement"}, false, options);
  EXPECT_EQ(DetailOf(analysis.status()).reason, "RIGID_MOTION");
  const absl::Status told = WithLeftOutParts(analysis.status(), stool.design);
  EXPECT_EQ(told.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(told.message()),
              ::testing::AllOf(::testing::HasSubstr("'seat'"), ::testing::HasSubstr("'pad 0'"),
                               ::testing::HasSubstr("left out")));
  const absl::Status other = absl::InternalError("else");
  EXPECT_EQ(WithLeftOutParts(other, stool.design), other);
}

TEST(TemplateModelTest, SaysWhatToAddWhereNothingHolds) {
  const Subject bench = AtDefaults(templates::ShippedAssembly("assemblies/garden-bench"));
  const absl::Status status = CheckSupported(bench.design);
  EXPECT_EQ(DetailOf(status).reason, "NO_SUPPORTS");
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("FIXED"));
  EXPECT_EQ(CheckSupported(AtDefaults(Stool(TurnedLeg())).design), absl::OkStatus());
}

TEST(TemplateModelTest, SaysWhatToAddWhereNothingLoads) {
  Subject stool = AtDefaults(Stool(TurnedLeg()));
  EXPECT_EQ(CheckLoaded(stool.design), absl::OkStatus());
  std::erase_if(stool.design.boundary_conditions, [](const auto& condition) {
    return condition.kind != parametric::BoundaryConditionKind::kFixed;
  });
  const absl::Status status = CheckLoaded(stool.design);
  EXPECT_EQ(DetailOf(status).reason, "NO_LOADS");
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("FORCE"));
}

TEST(TemplateModelTest, DamagedSurfacesAreNamed) {
  v1::Shape leg = TurnedLeg();
  leg.set_brep("no surface");
  const absl::Status status = AtDefaults(Stool(leg)).Model().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  EXPECT_THAT(DetailOf(status).field, ::testing::HasSubstr("part 'leg"));
}

// A screw that cannot be made matters to nobody who leaves it out.
TEST(TemplateModelTest, ConnectingPartsNeedNoSurfaces) {
  v1::Shape pad = TurnedLeg();
  pad.set_brep("no surface");
  pad.set_name(parametric::NameOf(pad));
  v1::TemplateBundle bundle = Stool(TurnedLeg(), 0.01);
  for (v1::AssemblyPart& part : *bundle.mutable_assembly()->mutable_parts()) {
    if (part.role() == v1::AssemblyPart::CONNECTING) part.set_shape(pad.name());
  }
  *bundle.add_shapes() = pad;
  const auto model = AtDefaults(bundle).Model();
  EXPECT_TRUE(model.ok()) << model.status();
}

// What needs no mesh and no joined parts is there for every kind of template that ships.
TEST(TemplateModelTest, GeometryMetricsOfWhatShips) {
  std::vector<std::string> names;
  for (const MetricDescription& metric : GeometryMetrics::Offered()) names.push_back(metric.name);
  DesignAnalysisOptions options;
  options.leave_out_inapplicable = true;
  for (const v1::Template& message : templates::ShippedCollection().templates) {
    SCOPED_TRACE(message.name());
    v1::TemplateBundle bundle = templates::ShippedTemplate(message.name());
    for (const v1::Assembly& assembly : templates::ShippedCollection().assemblies) {
      if (assembly.name() == message.assembly().assembly()) *bundle.mutable_assembly() = assembly;
    }
    const Subject subject = AtDefaults(bundle);
    const auto model = MakeDesignModel(*subject.design_template, subject.parameters, subject.design,
                                       {.is_wanted = false});
    ASSERT_TRUE(model.ok()) << model.status();
    EXPECT_EQ(model->surface.triangles.cols(), 0);
    const auto analysis = AnalyzeDesign(*model, names, false, options);
    ASSERT_TRUE(analysis.ok()) << analysis.status();
    // Steel sinks, wood floats.
    EXPECT_TRUE(analysis->notes.empty() || analysis->notes.size() == 4) << analysis->notes[0];
    Eigen::AlignedBox3d box;
    double mass = 0;
    for (const auto& part : subject.design.parts) {
      if (part.connecting) continue;
      box.extend(part.minimum).extend(part.maximum);
      mass += part.mass;
    }
    EXPECT_NEAR(ValueOf(*analysis, "mass"), mass, 1e-6 * mass);
    const Eigen::Vector3d size = box.sizes();
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      const double center = ValueOf(*analysis, "center_of_mass_" + name);
      EXPECT_TRUE(box.min()[axis] < center && center < box.max()[axis]) << name;
      const double area = ValueOf(*analysis, "projected_area_" + name);
      const double frame = size[(axis + 1) % 3] * size[(axis + 2) % 3];
      EXPECT_TRUE(area > 0.01 * frame && area < 1.001 * frame) << name << " " << area / frame;
      EXPECT_GT(ValueOf(*analysis, "inertia_" + name + name), 0);
    }
  }
}

TEST(TemplateModelTest, ABoatOfWoodFloatsUpright) {
  const Subject boat = AtDefaults(templates::ShippedTemplate("templates/boat"));
  const auto model =
      MakeDesignModel(*boat.design_template, boat.parameters, boat.design, {.is_wanted = false});
  ASSERT_TRUE(model.ok()) << model.status();
  const auto analysis =
      AnalyzeDesign(*model, {"draught", "metacentric_height", "displaced_volume", "mass"}, false);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_GT(ValueOf(*analysis, "draught"), 0.01);
  EXPECT_LT(ValueOf(*analysis, "draught"), 0.1);
  EXPECT_GT(ValueOf(*analysis, "metacentric_height"), 0);
  EXPECT_NEAR(1000 * ValueOf(*analysis, "displaced_volume"), ValueOf(*analysis, "mass"), 1e-9);
}

TEST(TemplateModelTest, TheCostHasTheItemsCurrency) {
  const Subject table = AtDefaults(templates::ShippedTemplate("templates/table"));
  const std::vector<MetricDescription> metrics = MetricsOf(*table.design_template);
  const auto cost = std::find_if(metrics.begin(), metrics.end(),
                                 [](const auto& metric) { return metric.name == "cost"; });
  ASSERT_NE(cost, metrics.end());
  EXPECT_EQ(cost->unit, "EUR");
  const auto model =
      MakeDesignModel(*table.design_template, table.parameters, table.design, {.is_wanted = false});
  ASSERT_TRUE(model.ok()) << model.status();
  const auto analysis = AnalyzeDesign(*model, {"cost"}, false);
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_EQ(analysis->metrics[0].unit, "EUR");
  const Subject wrench = AtDefaults(templates::ShippedTemplate("templates/wrench"));
  EXPECT_EQ(DetailOf(wrench.Model()->cost.status()).reason, "NO_PRICE");
}

}  // namespace
}  // namespace mortise::simulator
