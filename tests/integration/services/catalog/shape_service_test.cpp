// Real shapes through the catalog as a process: drawn in STEP, kept, stretched, shown, and exported
// in any format and pose.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/catalog/drawn_stool.h"
#include "tests/integration/services/catalog/shape_service_fixture.h"

namespace mortise::catalog {
namespace {

using testing::Call;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

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
    for (const double q : adjusted->q()) {
      absl::StrAppend(&request, "q: ", absl::StrFormat("%.17g ", q));
    }
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

}  // namespace
}  // namespace mortise::catalog
