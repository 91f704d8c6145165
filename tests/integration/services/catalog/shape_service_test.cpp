// Real shapes through the catalog as a process: drawn in STEP, kept, stretched, shown, exported in
// any format and pose, given to items, and refused with places where they bound no solid.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/cad/cylinder.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::catalog {
namespace {

using testing::Call;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Prepare;
using testing::ReadChunks;
using ::testing::UnorderedElementsAre;

template <typename Message>
Message Parse(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

cad::Solid Prism(const std::string& name, const Eigen::Matrix2Xd& outline, double height) {
  mesh::PartShape shape;
  shape.name = name;
  shape.outline = outline;
  shape.height = height;
  for (Eigen::Index i = 0; i < outline.cols() + 2; ++i) {
    shape.face_names.push_back(absl::StrCat("face", i));
  }
  return *cad::Solid::FromPart(shape);
}

cad::Solid Box(const std::string& name, const Eigen::Vector3d& size) {
  Eigen::Matrix2Xd outline(2, 4);
  outline << 0, size.x(), size.x(), 0, 0, 0, size.y(), size.y();
  return Prism(name, outline, size.z());
}

// An L of 40 × 40 mm, 4 mm thick.
cad::Solid Bracket(double length) {
  Eigen::Matrix2Xd outline(2, 6);
  outline << 0, 0.04, 0.04, 0.004, 0.004, 0, 0, 0, 0.004, 0.004, 0.04, 0.04;
  return Prism("bracket", outline, length);
}

cad::Solid Leg() {
  cad::CylinderShape leg;
  leg.name = "leg";
  leg.radius_u = leg.radius_v = 0.02;
  leg.center = Eigen::Vector3d(0.02, 0.02, 0);
  leg.height = 0.4;
  return *cad::MakeCylinder(leg);
}

void Place(cad::StepAssembly& assembly, const std::string& name, int group, int product,
           const Eigen::Vector3d& at) {
  cad::StepPart part;
  part.name = name;
  part.group = group;
  part.product = product;
  part.placement.translation() = at;
  assembly.parts.push_back(std::move(part));
}

// A board on two round legs; against one leg's top a bracket that the board lies on, and in the
// bracket's corner a block that it touches nowhere, though its box holds it.
std::string Stool() {
  cad::StepAssembly stool;
  stool.name = "stool";
  stool.groups = {{"stool", -1}, {"legs", 0}};
  stool.products = {{"board", Box("board", {0.5, 0.04, 0.02}), Eigen::Vector3d(0.5, 0.25, 0.125)},
                    {"leg", Leg(), std::nullopt},
                    {"bracket", Bracket(0.03), std::nullopt},
                    {"block", Box("block", {0.03, 0.03, 0.03}), std::nullopt}};
  Place(stool, "board", 0, 0, {0, 0, 0.4});
  Place(stool, "left leg", 1, 1, {0, 0, 0});
  Place(stool, "right leg", 1, 1, {0.46, 0, 0});
  Place(stool, "bracket", 0, 2, {0.2, 0, 0.37});
  Place(stool, "block", 0, 3, {0.206, 0.006, 0.37});
  return *cad::WriteStep(stool);
}

class ShapeServiceTest : public ::testing::Test {
 protected:
  absl::StatusOr<v1::ImportAssemblyStepResponse> ImportStep(const std::string& step,
                                                            const std::string& annotations) {
    v1::ImportAssemblyStepRequest request;
    request.set_request_id(NextId());
    request.set_step(step);
    *request.mutable_annotations() = Parse<v1::AssemblyAnnotations>(annotations);
    return Call(*assemblies_, &v1::AssemblyService::Stub::ImportAssemblyStep, request);
  }

  absl::StatusOr<v1::Shape> ImportShape(const std::string& file,
                                        v1::ImportShapeRequest::Format format) {
    v1::ImportShapeRequest request;
    request.set_request_id(NextId());
    request.set_file(file);
    request.set_format(format);
    return Call(*catalog_, &v1::CatalogService::Stub::ImportShape, request);
  }

  v1::Shape Shape(const std::string& name) {
    v1::GetShapeRequest request;
    request.set_name(name);
    const auto shape = Call(*catalog_, &v1::CatalogService::Stub::GetShape, request);
    EXPECT_TRUE(shape.ok()) << shape.status();
    return shape.value_or(v1::Shape());
  }

  absl::StatusOr<std::string> Export(const std::string& text) {
    grpc::ClientContext context;
    Prepare(context);
    return ReadChunks(
        *assemblies_->ExportAssembly(&context, Parse<v1::ExportAssemblyRequest>(text)));
  }

  absl::StatusOr<std::string> ExportTemplate(const std::string& text) {
    grpc::ClientContext context;
    Prepare(context);
    return ReadChunks(*catalog_->ExportDesign(&context, Parse<v1::ExportDesignRequest>(text)));
  }

  std::string NextId() { return absl::StrCat("shapes-", ++requests_); }

  int requests_ = 0;
  testing::ServiceUnderTest process_{"mortise-catalog", {}};
  std::unique_ptr<v1::AssemblyService::Stub> assemblies_ =
      v1::AssemblyService::NewStub(process_.channel());
  std::unique_ptr<v1::CatalogService::Stub> catalog_ =
      v1::CatalogService::NewStub(process_.channel());
};

const cad::StepPart& PartOf(const cad::StepAssembly& assembly, const std::string& name) {
  static const cad::StepPart none;
  for (const cad::StepPart& part : assembly.parts) {
    if (part.name == name) return part;
  }
  ADD_FAILURE() << "no part " << name;
  return none;
}

std::vector<std::string> FieldsOf(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(status)) fields.push_back(violation.field);
  if (fields.empty() && !status.ok()) fields.push_back(DetailOf(status).field);
  return fields;
}

TEST_F(ShapeServiceTest, KeepsWhatIsDrawnAtAnyParameters) {
  const std::string step = Stool();
  const auto imported = ImportStep(step, "name: 'assemblies/stool'");
  ASSERT_TRUE(imported.ok()) << imported.status();
  std::map<std::string, v1::AssemblyPart> parts;
  for (const v1::AssemblyPart& part : imported->assembly().parts()) parts[part.name()] = part;
  EXPECT_EQ(parts["board"].shape(), "") << "a box is a box";
  EXPECT_NEAR(parts["board"].color().x(), 0.5, 1e-4);
  EXPECT_EQ(parts["left leg"].shape(), parts["right leg"].shape());
  const v1::Shape leg = Shape(parts["left leg"].shape());
  EXPECT_TRUE(leg.exact());
  EXPECT_TRUE(leg.brep().empty()) << "exact surfaces are the service's own";
  EXPECT_NEAR(leg.volume(), std::acos(-1.0) * 0.02 * 0.02 * 0.4, 1e-9);
  EXPECT_EQ(leg.vertices().size(), 24u * static_cast<std::size_t>(leg.vertex_count()));

  v1::ParametrizeAssemblyRequest parametrize;
  parametrize.set_name("assemblies/stool");
  const auto found =
      Call(*assemblies_, &v1::AssemblyService::Stub::ParametrizeAssembly, parametrize);
  ASSERT_TRUE(found.ok()) << found.status();
  std::vector<std::string> contacts;
  for (const v1::ElementContact& contact : found->contacts()) {
    contacts.push_back(std::min(contact.first(), contact.second()) + "|" +
                       std::max(contact.first(), contact.second()));
  }
  EXPECT_THAT(contacts, UnorderedElementsAre("board|left leg", "board|right leg", "board|bracket",
                                             "block|board"))
      << "the block stands in the bracket's box and does not touch it";

  const auto read = cad::ReadStep(step);
  ASSERT_TRUE(read.ok()) << read.status();
  for (const double length : {0.5, 0.4, 0.8}) {
    v1::AdjustAssemblyRequest adjust;
    adjust.set_name("assemblies/stool");
    v1::MeasureDemand& demand = *adjust.add_demands();
    demand.mutable_measure()->set_element("board");
    demand.mutable_measure()->set_axis(v1::X);
    demand.set_value(length);
    const auto adjusted = Call(*assemblies_, &v1::AssemblyService::Stub::AdjustAssembly, adjust);
    ASSERT_TRUE(adjusted.ok()) << adjusted.status();
    std::string request = "name: 'assemblies/stool' format: STEP ";
    for (const double q : adjusted->q())
      absl::StrAppend(&request, "q: ", absl::StrFormat("%.17g ", q));
    const auto exported = Export(request);
    ASSERT_TRUE(exported.ok()) << exported.status();
    const auto again = cad::ReadStep(*exported);
    ASSERT_TRUE(again.ok()) << again.status();
    ASSERT_EQ(again->parts.size(), read->parts.size());
    EXPECT_EQ(again->groups.size(), read->groups.size());
    for (const v1::PlacedPart& placed : adjusted->parts()) {
      const cad::StepPart& part = PartOf(*again, placed.name());
      const cad::StepPart& drawn = PartOf(*read, placed.name());
      const Eigen::Vector3d minimum(placed.minimum().x(), placed.minimum().y(),
                                    placed.minimum().z());
      const Eigen::Vector3d maximum(placed.maximum().x(), placed.maximum().y(),
                                    placed.maximum().z());
      EXPECT_LT((part.minimum - minimum).norm(), 1e-6) << placed.name();
      EXPECT_LT((part.maximum - maximum).norm(), 1e-6) << placed.name();
      const double stretched =
          drawn.volume * (maximum - minimum).prod() / (drawn.maximum - drawn.minimum).prod();
      EXPECT_NEAR(part.volume, stretched, 1e-6 * stretched) << placed.name();
      EXPECT_EQ(cad::PathOf(*again, part.group, part.name),
                cad::PathOf(*read, drawn.group, drawn.name));
    }
  }
}

TEST_F(ShapeServiceTest, ComesBackFromItsOwnFile) {
  ASSERT_TRUE(ImportStep(Stool(), "name: 'assemblies/stool'").ok());
  const auto first = Export("name: 'assemblies/stool' format: STEP");
  ASSERT_TRUE(first.ok()) << first.status();
  const auto copied = ImportStep(*first, "name: 'assemblies/copy'");
  ASSERT_TRUE(copied.ok()) << copied.status();
  const auto second = Export("name: 'assemblies/copy' format: STEP");
  ASSERT_TRUE(second.ok()) << second.status();
  const auto before = cad::ReadStep(*first);
  const auto after = cad::ReadStep(*second);
  ASSERT_TRUE(before.ok() && after.ok());
  ASSERT_EQ(before->parts.size(), after->parts.size());
  for (const cad::StepPart& part : before->parts) {
    const cad::StepPart& again = PartOf(*after, part.name);
    EXPECT_LT((again.minimum - part.minimum).norm(), 1e-6) << part.name;
    EXPECT_LT((again.maximum - part.maximum).norm(), 1e-6) << part.name;
    EXPECT_NEAR(again.volume, part.volume, 1e-6 * part.volume) << part.name;
    EXPECT_EQ(again.is_box, part.is_box) << part.name;
  }
}

TEST_F(ShapeServiceTest, ExportsTrianglesAndPoses) {
  const auto imported = ImportStep(
      Stool(),
      "name: 'assemblies/stool' joints { name: 'fold' kind: HINGE group: 'legs' center { z: 0.4 } "
      "axis { y: 1 } lower: 0 upper: 1.6 rest_poses { name: 'flat' amount: 1.5707963267948966 } }");
  ASSERT_TRUE(imported.ok()) << imported.status();
  const auto obj = Export("name: 'assemblies/stool' format: OBJ");
  ASSERT_TRUE(obj.ok()) << obj.status();
  EXPECT_THAT(*obj, HasSubstr("o left leg\n"));
  const auto stl = Export("name: 'assemblies/stool' format: STL");
  ASSERT_TRUE(stl.ok()) << stl.status();
  EXPECT_EQ((stl->size() - 84) % 50, 0u);
  const auto posed = Export("name: 'assemblies/stool' format: STEP rest_pose: 'fold: flat'");
  ASSERT_TRUE(posed.ok()) << posed.status();
  const auto read = cad::ReadStep(*posed);
  ASSERT_TRUE(read.ok()) << read.status();
  const cad::StepPart& leg = PartOf(*read, "left leg");
  EXPECT_NEAR(leg.maximum.x() - leg.minimum.x(), 0.4, 1e-6) << "it lies now";
  EXPECT_NEAR(leg.volume, std::acos(-1.0) * 0.02 * 0.02 * 0.4, 1e-9);
  EXPECT_NEAR(PartOf(*read, "board").minimum.z(), 0.4, 1e-6);
  const auto unknown = Export("name: 'assemblies/stool' format: GLB rest_pose: 'fold: open'");
  EXPECT_EQ(DetailOf(unknown.status()).field, "rest_pose");
  EXPECT_THAT(std::string(unknown.status().message()), HasSubstr("fold: flat"));
}

TEST_F(ShapeServiceTest, IsATemplateLikeAnyOther) {
  ASSERT_TRUE(ImportStep(Stool(), "name: 'assemblies/stool'").ok());
  v1::ImportTemplateRequest request;
  request.set_request_id(NextId());
  *request.mutable_template_() = Parse<v1::Template>(
      "name: 'templates/stool' assembly { assembly: 'assemblies/stool' handles { parameter: "
      "'width' "
      "measure { element: 'board' axis: X } } } boundary_conditions { name: 'stand' kind: FIXED "
      "part: 'left leg' face: 'z_min' }");
  const auto stored = Call(*catalog_, &v1::CatalogService::Stub::ImportTemplate, request);
  ASSERT_TRUE(stored.ok()) << stored.status();
  v1::GetTemplateBundleRequest bundle_request;
  bundle_request.set_name("templates/stool");
  const auto bundle = Call(*catalog_, &v1::CatalogService::Stub::GetTemplateBundle, bundle_request);
  ASSERT_TRUE(bundle.ok()) << bundle.status();
  ASSERT_EQ(bundle->shapes_size(), 2);
  EXPECT_TRUE(bundle->shapes(0).brep().empty());
  const auto evaluate = Parse<v1::EvaluateTemplateRequest>(
      "name: 'templates/stool' parameters { name: 'width' value: 0.6 }");
  const auto design = Call(*catalog_, &v1::CatalogService::Stub::EvaluateTemplate, evaluate);
  ASSERT_TRUE(design.ok()) << design.status();
  int faceted = 0;
  for (const v1::EvaluatedPart& part : design->parts()) faceted += part.has_faceted() ? 1 : 0;
  EXPECT_EQ(faceted, 3);
  const auto step = ExportTemplate(
      "name: 'templates/stool' format: STEP parameters { name: 'width' value: 0.6 }");
  ASSERT_TRUE(step.ok()) << step.status();
  const auto read = cad::ReadStep(*step);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(cad::PathOf(*read, PartOf(*read, "left leg").group, "left leg"), "legs/left leg");
  for (const v1::EvaluatedPart& part : design->parts()) {
    EXPECT_NEAR(PartOf(*read, part.name()).volume, part.volume(), 1e-6 * part.volume());
  }
}

// What was placed as one product, turned, is one again.
TEST_F(ShapeServiceTest, ExportsTurnedPartsOfADrawingAsOneProduct) {
  Eigen::Matrix2Xd angle(2, 6);
  angle << 0, 0.04, 0.04, 0.004, 0.004, 0, 0, 0, 0.004, 0.004, 0.06, 0.06;
  cad::StepAssembly drawing;
  drawing.name = "hooks";
  drawing.groups.push_back({"hooks", -1});
  drawing.products.push_back({"plate", Box("plate", {0.5, 0.2, 0.02}), {}});
  drawing.products.push_back({"hook", Prism("hook", angle, 0.03), {}});
  cad::StepPart plate;
  plate.name = "plate";
  plate.placement.translation() << -0.05, -0.1, -0.02;
  drawing.parts.push_back(plate);
  const double turns[] = {0, std::acos(0.0), std::acos(-1.0), 0.5};
  for (int i = 0; i < 4; ++i) {
    cad::StepPart hook;
    hook.name = absl::StrCat("hook ", i + 1);
    hook.product = 1;
    hook.placement.linear() =
        Eigen::AngleAxisd(turns[i], Eigen::Vector3d::UnitZ()).toRotationMatrix();
    hook.placement.translation() << 0.1 * i, 0, 0;
    drawing.parts.push_back(hook);
  }
  ASSERT_TRUE(ImportStep(*cad::WriteStep(drawing), "name: 'assemblies/hooks'").ok());
  const auto step = Export("name: 'assemblies/hooks' format: STEP");
  ASSERT_TRUE(step.ok()) << step.status();
  const auto read = cad::ReadStep(*step);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->parts.size(), 5u);
  std::map<std::string, std::string> products;
  for (const cad::StepPart& part : read->parts) {
    products[part.name] = read->products[static_cast<std::size_t>(part.product)].name;
  }
  EXPECT_EQ(products, (std::map<std::string, std::string>{{"plate", "plate"},
                                                          {"hook 1", "hook"},
                                                          {"hook 2", "hook"},
                                                          {"hook 3", "hook"},
                                                          {"hook 4", "hook 2"}}));
  // Where they were, corner by corner: no mirror image, no other turn.
  const auto drawn = cad::ReadStep(*cad::WriteStep(drawing));
  ASSERT_TRUE(drawn.ok()) << drawn.status();
  for (const cad::StepPart& part : read->parts) {
    SCOPED_TRACE(part.name);
    const cad::StepPart& before = PartOf(*drawn, part.name);
    const auto center = [](const cad::StepAssembly& of, const cad::StepPart& at) {
      return at.placement * of.products[static_cast<std::size_t>(at.product)].solid->CentreOfMass();
    };
    EXPECT_LT((center(*read, part) - center(*drawn, before)).norm(), 1e-6);
    EXPECT_LT((part.minimum - before.minimum).norm(), 1e-6);
    EXPECT_LT((part.maximum - before.maximum).norm(), 1e-6);
    EXPECT_NEAR(part.volume, before.volume, 1e-6 * before.volume);
  }
}

// Solids of one form that were each drawn where they stand, and so differ by rounding.
TEST_F(ShapeServiceTest, SeesARowInPartsThatWereEachDrawnInTheirPlace) {
  cad::StepAssembly rack;
  rack.name = "rack";
  rack.groups = {{"rack", -1}};
  rack.products = {{"board", Box("board", {0.5, 0.04, 0.02}), std::nullopt}};
  Place(rack, "board", 0, 0, {0, 0, -0.02});
  std::set<double> widths;
  for (int i = 0; i < 3; ++i) {
    const double place = 0.07 + i * 0.4 / 3;
    Eigen::Matrix2Xd outline(2, 6);
    outline << 0, 0.04, 0.04, 0.004, 0.004, 0, 0, 0, 0.004, 0.004, 0.04, 0.04;
    outline.row(0).array() += place;
    widths.insert(outline(0, 1) - outline(0, 0));
    const std::string name = absl::StrCat("bracket ", i + 1);
    rack.products.push_back({name, Prism(name, outline, 0.03), std::nullopt});
    Place(rack, name, 0, i + 1, {0, 0, 0});
  }
  ASSERT_GT(widths.size(), 1U) << "none of them is rounded otherwise";
  const auto drawn = ImportStep(*cad::WriteStep(rack), "name: 'assemblies/rack'");
  ASSERT_TRUE(drawn.ok()) << drawn.status();
  std::set<std::string> shapes;
  for (const v1::AssemblyPart& part : drawn->assembly().parts()) shapes.insert(part.shape());
  EXPECT_EQ(shapes.size(), 2U) << "the brackets' and none";
  v1::ParametrizeAssemblyRequest request;
  request.set_name("assemblies/rack");
  const auto parametrized =
      Call(*assemblies_, &v1::AssemblyService::Stub::ParametrizeAssembly, request);
  ASSERT_TRUE(parametrized.ok()) << parametrized.status();
  ASSERT_EQ(parametrized->elements_size(), 2);
  const v1::ParametricElement& brackets =
      parametrized->elements(parametrized->elements(0).name() == "board" ? 1 : 0);
  EXPECT_THAT(brackets.parts(), ElementsAre("bracket 1", "bracket 2", "bracket 3"));
  EXPECT_EQ(brackets.rows_size(), 1);
}

// A tetrahedron as text, in millimetres; `faces` of its four corners, and of one beside it.
std::string Tetrahedron(const std::vector<std::array<int, 3>>& faces) {
  const char* const corners[] = {"0 0 0", "40 0 0", "0 40 0", "0 0 40", "30 -20 10"};
  std::string text = "solid t\n";
  for (const auto& face : faces) {
    absl::StrAppend(&text, "facet normal 0 0 0\nouter loop\n");
    for (const int corner : face) absl::StrAppend(&text, "vertex ", corners[corner], "\n");
    absl::StrAppend(&text, "endloop\nendfacet\n");
  }
  return text + "endsolid t\n";
}

TEST_F(ShapeServiceTest, IsOfItemsToo) {
  const auto shape = ImportShape(Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}),
                                 v1::ImportShapeRequest::STL);
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_NEAR(shape->volume(), 0.04 * 0.04 * 0.04 / 6, 1e-12);
  EXPECT_FALSE(shape->exact());
  v1::CreateMaterialRequest material;
  material.set_request_id(NextId());
  *material.mutable_material() = Parse<v1::Material>(
      "name: 'materials/steel' density: 7850 youngs_modulus: 2e11 poissons_ratio: 0.3 strength: "
      "2e8");
  ASSERT_TRUE(Call(*catalog_, &v1::CatalogService::Stub::CreateMaterial, material).ok());
  v1::CreateItemRequest item;
  item.set_request_id(NextId());
  *item.mutable_item() = Parse<v1::Item>(absl::StrCat(
      "name: 'items/gusset' kind: BRACKET material: 'materials/steel' shape: '", shape->name(),
      "' dimensions { axis: X size: 0.04 } dimensions { axis: Y size: 0.04 } dimensions { axis: Z "
      "size: 0.03 } price { currency: 'EUR' amount: 1 } price_basis: PER_PIECE price_date: "
      "'2026-01-15' supplier: 'Example' price_is_example: true"));
  EXPECT_THAT(FieldsOf(Call(*catalog_, &v1::CatalogService::Stub::CreateItem, item).status()),
              UnorderedElementsAre("item.shape"))
      << "another thickness";
  item.mutable_item()->mutable_dimensions(2)->set_size(0.04);
  item.set_request_id(NextId());
  const auto created = Call(*catalog_, &v1::CatalogService::Stub::CreateItem, item);
  ASSERT_TRUE(created.ok()) << created.status();
  v1::ImportAssemblyRequest import;
  import.set_request_id(NextId());
  *import.mutable_assembly() = Parse<v1::Assembly>(
      "name: 'assemblies/corner' parts { name: 'gusset' item: 'items/gusset' length_axis: Y "
      "thickness_axis: Z position { x: 0 y: 0 z: 0 } } parts { name: 'plate' position { z: -0.01 } "
      "size { x: 0.04 y: 0.04 z: 0.01 } }");
  const auto assembly = Call(*assemblies_, &v1::AssemblyService::Stub::ImportAssembly, import);
  ASSERT_TRUE(assembly.ok()) << assembly.status();
  const auto step = Export("name: 'assemblies/corner' format: STEP");
  ASSERT_TRUE(step.ok()) << step.status();
  const auto read = cad::ReadStep(*step);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_NEAR(PartOf(*read, "gusset").volume, shape->volume(), 1e-6 * shape->volume());
  import.mutable_assembly()->mutable_parts(1)->set_shape("shapes/none");
  import.set_request_id(NextId());
  import.set_expected_revision(1);
  EXPECT_THAT(
      FieldsOf(Call(*assemblies_, &v1::AssemblyService::Stub::ImportAssembly, import).status()),
      UnorderedElementsAre("assembly.parts[1].shape"));
}

TEST_F(ShapeServiceTest, RepairsStlAndSaysWhat) {
  using Request = v1::ImportShapeRequest;
  const auto good =
      ImportShape(Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}), Request::STL);
  ASSERT_TRUE(good.ok()) << good.status();
  EXPECT_EQ(good->notes_size(), 0);
  // Without a face, inside out, and with a face twice, it is the same solid.
  const std::map<std::string, std::string> damaged = {
      {"filled 1 hole, up to 69.28 mm across", Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}})},
      {"turned 4 triangles around", Tetrahedron({{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}})},
      {"dropped 1 triangle drawn more than once",
       Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 3}})}};
  for (const auto& [note, file] : damaged) {
    const auto repaired = ImportShape(file, Request::STL);
    ASSERT_TRUE(repaired.ok()) << repaired.status();
    EXPECT_NEAR(repaired->volume(), good->volume(), 1e-12);
    ASSERT_EQ(repaired->notes_size(), 1) << note;
    EXPECT_EQ(repaired->notes(0), note);
    EXPECT_EQ(Shape(repaired->name()).notes_size(), 0) << "they are of the file";
  }
}

TEST_F(ShapeServiceTest, RefusesWhatIsNoSolidAndStoresNothing) {
  using Request = v1::ImportShapeRequest;
  // Two of its four faces: a hole as large as what is left.
  const std::string open = Tetrahedron({{0, 2, 1}, {0, 1, 3}});
  const std::string fin = Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 4}});
  const absl::Status not_closed = ImportShape(open, Request::STL).status();
  EXPECT_THAT(std::string(not_closed.message()), HasSubstr(" mm")) << "the place";
  EXPECT_THAT(std::string(ImportShape(fin, Request::STL).status().message()),
              HasSubstr("more than two triangles meet at an edge at ("));
  for (const std::string& file :
       {open, fin, std::string("solid t\n"), std::string("no file"), std::string(84, '\0'),
        std::string(), std::string("\x1f\x8b no gzip"), std::string("solid\nvertex 1 x 2")}) {
    const absl::Status status = ImportShape(file, Request::STL).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    for (const std::string& field : FieldsOf(status)) EXPECT_EQ(field, "file");
  }
  EXPECT_EQ(DetailOf(ImportShape("x", Request::FORMAT_UNSPECIFIED).status()).field, "format");
  EXPECT_EQ(DetailOf(ImportShape(Stool(), Request::STEP).status()).field, "file") << "five solids";
  EXPECT_EQ(DetailOf(ImportShape("ISO-10303-21;", Request::STEP).status()).field, "file");
  // The first shape that the catalog tells of is the first that is good.
  const auto good =
      ImportShape(Tetrahedron({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}), Request::STL);
  ASSERT_TRUE(good.ok()) << good.status();
  const auto events = v1::EventService::NewStub(process_.channel());
  v1::FollowEventsRequest follow;
  follow.add_type_prefixes("shape.");
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto reader = events->FollowEvents(&context, follow);
  v1::Event event;
  ASSERT_TRUE(reader->Read(&event));
  EXPECT_EQ(event.subject(), good->name());
  context.TryCancel();
  v1::GetShapeRequest get;
  get.set_name("shapes/" + std::string(64, '0'));
  EXPECT_EQ(Call(*catalog_, &v1::CatalogService::Stub::GetShape, get).status().code(),
            absl::StatusCode::kNotFound);
  get.set_name("shapes/../x");
  EXPECT_EQ(DetailOf(Call(*catalog_, &v1::CatalogService::Stub::GetShape, get).status()).field,
            "name");
}

}  // namespace
}  // namespace mortise::catalog
