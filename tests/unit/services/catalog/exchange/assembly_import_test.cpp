// Assemblies of STEP files and annotations: what is made of them, and all that can be wrong.
#include "services/catalog/exchange/assembly_import.h"

#include <gmock/gmock.h>
#include <google/protobuf/io/gzip_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "services/catalog/exchange/drawn_coordinates.h"
#include "services/catalog/exchange/item_fit.h"
#include "services/catalog/exchange/part_annotations.h"

namespace mortise::catalog {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr double kNoise = 8e-8;  // m, as drawings have it

parametric::Item Board() {
  parametric::Item board;
  board.name = "items/board";
  board.kind = parametric::ItemKind::kBoard;
  board.dimensions = {{{2.4, parametric::Process::kChopSaw, 0.04, 2.4}, {0.089}, {0.038}}};
  return board;
}

void AddPart(cad::StepAssembly& drawing, const std::string& name, const std::string& drawn_name,
             int group, int product, const Eigen::Vector3d& low, const Eigen::Vector3d& size) {
  cad::StepPart part;
  part.name = name;
  part.drawn_name = drawn_name;
  part.group = group;
  part.product = product;
  part.minimum = low;
  part.maximum = low + size;
  part.volume = size.prod();
  part.is_box = true;
  drawing.parts.push_back(part);
}

// Two boards on edge and a shelf upon them, with noise; a bolt that is no box, and a person.
cad::StepAssembly Trestle() {
  cad::StepAssembly drawing;
  drawing.name = "Trestle 3000";
  drawing.groups = {{"Trestle 3000", -1}, {"legs", 0}, {"left", 1}, {"right", 1}, {"people", 0}};
  drawing.products = {{"leg", {}, {}}, {"top", {}, {}}, {"bolt", {}, {}}, {"person", {}, {}}};
  AddPart(drawing, "leg 1", "leg", 2, 0, {kNoise, 0, 0}, {0.038, 0.089 + kNoise, 0.7});
  AddPart(drawing, "leg 2", "leg", 3, 0, {0.9, kNoise, -kNoise}, {0.038 - kNoise, 0.089, 0.7});
  AddPart(drawing, "top", "top", 0, 1, {0, 0, 0.7 + kNoise}, {0.938, 0.089, 0.02});
  AddPart(drawing, "bolt", "bolt", 0, 2, {0.01, 0.02, 0.69}, {0.01, 0.01, 0.05});
  drawing.parts.back().is_box = false;
  AddPart(drawing, "Ann", "Ann", 4, 3, {2, 2, 0}, {0.5, 0.5, 1.8});
  return drawing;
}

v1::AssemblyAnnotations Annotations(const std::string& text) {
  v1::AssemblyAnnotations annotations;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &annotations)) << text;
  return annotations;
}

constexpr char kGood[] =
    "name: 'assemblies/trestle' "
    "parts { product: 'leg' item: 'items/board' } "
    "parts { parts: 'bolt' role: CONNECTING title: 'Bolt' } "
    "parts { parts: 'people/Ann' left_out: true } ";

DrawnAssembly Made(const std::string& text, const cad::StepAssembly& drawing = Trestle()) {
  return MakeAssembly(drawing, Annotations(text), {Board()});
}

// The fields at fault of a drawing with these annotations.
std::vector<std::string> Fields(const std::string& text,
                                const cad::StepAssembly& drawing = Trestle()) {
  const v1::AssemblyAnnotations annotations = Annotations(text);
  const DrawnAssembly drawn = MakeAssembly(drawing, annotations, {Board()});
  const absl::Status status =
      AtRequest(drawn, annotations, parametric::FromProto(drawn.assembly, {Board()}).status());
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(status)) fields.push_back(violation.field);
  if (fields.empty() && !status.ok()) fields.push_back(DetailOf(status).field);
  return fields;
}

const v1::AssemblyPart& PartOf(const DrawnAssembly& drawn, const std::string& name) {
  for (const v1::AssemblyPart& part : drawn.assembly.parts()) {
    if (part.name() == name) return part;
  }
  ADD_FAILURE() << "no part " << name;
  return v1::AssemblyPart::default_instance();
}

TEST(AssemblyImport, TakesTheTagsOfAnnotations) {
  const DrawnAssembly drawn =
      Made(std::string(kGood) + "external_ids: '100-4711/A' labels { key: 'site' value: 'B' }");
  EXPECT_THAT(drawn.findings, IsEmpty());
  EXPECT_THAT(drawn.assembly.external_ids(), ElementsAre("100-4711/A"));
  ASSERT_EQ(drawn.assembly.labels_size(), 1);
  EXPECT_EQ(drawn.assembly.labels().at("site"), "B");
}

// Of all parts of a product, too; what it may not be is told at the annotation, drawn or not.
TEST(AssemblyImport, TakesThePrioritiesOfAnnotations) {
  const std::string name = "name: 'assemblies/trestle' parts { parts: 'Ann' left_out: true } ";
  const DrawnAssembly drawn = Made(name +
                                   "parts { product: 'leg' priority: 2 } "
                                   "parts { parts: 'bolt' role: CONNECTING priority: 3 }");
  EXPECT_THAT(drawn.findings, IsEmpty());
  EXPECT_EQ(PartOf(drawn, "leg 1").priority(), 2);
  EXPECT_EQ(PartOf(drawn, "leg 2").priority(), 2);
  EXPECT_EQ(PartOf(drawn, "bolt").priority(), 3);
  EXPECT_EQ(PartOf(drawn, "top").priority(), 0);
  EXPECT_THAT(Fields(name + "parts { parts: 'top' priority: 1001 }"),
              ElementsAre("annotations.parts[1].priority"));
  EXPECT_THAT(
      Fields("name: 'assemblies/a' parts { parts: 'nobody' priority: -1 }"),
      UnorderedElementsAre("annotations.parts[0].parts[0]", "annotations.parts[0].priority"));
}

TEST(AssemblyImport, MakesPartsGroupsAndNotes) {
  const DrawnAssembly drawn = Made(kGood);
  EXPECT_THAT(drawn.findings, IsEmpty());
  EXPECT_EQ(drawn.assembly.name(), "assemblies/trestle");
  EXPECT_EQ(drawn.assembly.title(), "Trestle 3000");
  ASSERT_EQ(drawn.assembly.parts_size(), 4);
  std::vector<std::string> groups;
  for (const v1::AssemblyGroup& group : drawn.assembly.groups()) {
    groups.push_back(group.parent() + "/" + group.name());
  }
  EXPECT_THAT(groups, ElementsAre("/legs", "legs/left", "legs/right")) << "nobody is in 'people'";
  const v1::AssemblyPart& leg = PartOf(drawn, "leg 2");
  EXPECT_EQ(leg.group(), "right");
  EXPECT_EQ(leg.item(), "items/board");
  EXPECT_EQ(leg.length_axis(), v1::Z);
  EXPECT_EQ(leg.thickness_axis(), v1::X);
  EXPECT_EQ(PartOf(drawn, "bolt").role(), v1::AssemblyPart::CONNECTING);
  EXPECT_EQ(PartOf(drawn, "top").item(), "");
  EXPECT_THAT(drawn.notes, ElementsAre(HasSubstr("without an item")));
}

TEST(AssemblyImport, TakesTheNoiseOut) {
  const DrawnAssembly drawn = Made(kGood);
  const auto assembly = parametric::FromProto(drawn.assembly, {Board()});
  ASSERT_TRUE(assembly.ok()) << assembly.status();
  const parametric::BoundingBox leg = assembly->parts[0].box;
  const parametric::BoundingBox other = assembly->parts[1].box;
  const parametric::BoundingBox top = assembly->parts[2].box;
  EXPECT_EQ(leg.minimum, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(leg.maximum, Eigen::Vector3d(0.038, 0.089, 0.7));
  EXPECT_EQ(other.minimum, Eigen::Vector3d(0.9, 0, 0));
  EXPECT_EQ(top.minimum.z(), 0.7);
  EXPECT_NEAR(top.maximum.x(), other.maximum.x(), 1e-15);
}

TEST(AssemblyImport, LetsPartsWithoutItemBeHalfToTwiceAsLarge) {
  const auto assembly = parametric::FromProto(Made(kGood).assembly, {Board()});
  ASSERT_TRUE(assembly.ok()) << assembly.status();
  EXPECT_DOUBLE_EQ(assembly->parts[2].limits[0].minimum, 0.469);
  EXPECT_DOUBLE_EQ(assembly->parts[2].limits[0].maximum, 1.876);
  EXPECT_EQ(assembly->parts[3].limits[2].minimum, assembly->parts[3].limits[2].maximum)
      << "a connecting part";
}

TEST(AssemblyImport, SaysOneThingOfAProductAndAnotherOfOneOfIt) {
  const DrawnAssembly drawn = Made(
      "name: 'assemblies/trestle' parts { product: 'leg' item: 'items/board' } "
      "parts { parts: 'leg 2' title: 'Right leg' }");
  EXPECT_THAT(drawn.findings, IsEmpty());
  EXPECT_EQ(PartOf(drawn, "leg 1").item(), "items/board");
  EXPECT_EQ(PartOf(drawn, "leg 2").item(), "");
  EXPECT_EQ(PartOf(drawn, "leg 2").title(), "Right leg");
  const DrawnAssembly by_drawn_name =
      Made("name: 'assemblies/trestle' parts { parts: 'leg' item: 'items/board' }");
  EXPECT_EQ(PartOf(by_drawn_name, "leg 1").item(), "items/board");
  EXPECT_EQ(PartOf(by_drawn_name, "leg 2").item(), "items/board");
}

TEST(AssemblyImport, PutsOtherGroupsInThePlaceOfTheFiles) {
  const DrawnAssembly drawn =
      Made(absl::StrCat(kGood,
                        "groups { name: 'legs' } groups { name: 'upper' parent: 'legs' } "
                        "parts { parts: 'top' group: 'upper' }"));
  EXPECT_THAT(drawn.findings, IsEmpty());
  EXPECT_EQ(PartOf(drawn, "leg 1").group(), "legs") << "'left' is not among them";
  EXPECT_EQ(PartOf(drawn, "top").group(), "upper");
  EXPECT_EQ(PartOf(drawn, "bolt").group(), "");
  EXPECT_TRUE(parametric::FromProto(drawn.assembly, {Board()}).ok());
}

TEST(AssemblyImport, TakesJoints) {
  const std::string joint =
      "joints { name: 'fold' kind: HINGE group: 'left' center { z: 0.7 } axis { y: 1 } lower: 0 "
      "upper: 1.5 rest_poses { name: 'folded' amount: 1.5 } }";
  EXPECT_THAT(Fields(kGood + joint), IsEmpty());
  const std::string crossed =
      "joints { name: 'fold' kind: HINGE group: 'left' axis { y: 1 } lower: 1 upper: 0.5 }"
      "joints { name: 'turn' kind: HINGE group: 'people' axis { y: 2 } }";
  EXPECT_THAT(Fields(kGood + crossed),
              UnorderedElementsAre("annotations.joints[0].lower", "annotations.joints[1].group",
                                   "annotations.joints[1].axis"));
}

TEST(AssemblyImport, TellsEveryFaultAtOnce) {
  EXPECT_THAT(
      Fields("name: 'Trestle!' tolerance: 1 "
             "parts { parts: 'leg 1' parts: 'leg' item: 'items/none' } "
             "parts { parts: 'nobody' } "
             "parts { product: 'no product' } "
             "parts { parts: 'top' item: 'items/board' } "
             "parts { item: 'items/board' } "
             "parts { parts: 'bolt' product: 'bolt' } "
             "parts { parts: 'Ann' left_out: true item: 'items/board' } "
             "parts { parts: 'legs/right/leg 2' group: 'nowhere' }"),
      UnorderedElementsAre("annotations.name", "annotations.tolerance", "annotations.parts[0].item",
                           "annotations.parts[0].item", "annotations.parts[0].parts[1]",
                           "annotations.parts[1].parts[0]", "annotations.parts[2].product",
                           "annotations.parts[3].item", "annotations.parts[4].parts",
                           "annotations.parts[5].product", "annotations.parts[6].left_out",
                           "annotations.parts[7].parts[0]", "annotations.parts[7].group"));
  // Also of what is about nothing in the file.
  EXPECT_THAT(Fields("name: 'assemblies/a' parts { parts: 'nobody' item: 'items/none' "
                     "group: 'legs' length_axis: X thickness_axis: X } "
                     "parts { parts: 'no one' item: 'items/board' group: 'nowhere' "
                     "prominent_planes { name: '' axis: X position: 3 } }"),
              UnorderedElementsAre("annotations.parts[0].parts[0]", "annotations.parts[0].item",
                                   "annotations.parts[0].thickness_axis",
                                   "annotations.parts[1].parts[0]", "annotations.parts[1].group",
                                   "annotations.parts[1].prominent_planes[0].name"));
  EXPECT_THAT(Fields(absl::StrCat(kGood,
                                  "parts { parts: 'top' group: 'nowhere' "
                                  "prominent_planes { name: '' axis: X } }")),
              UnorderedElementsAre("annotations.parts[3].group",
                                   "annotations.parts[3].prominent_planes[0].name"));
  EXPECT_THAT(Fields("name: 'assemblies/a' parts { parts: 'leg 1' parts: 'leg 2' parts: 'top' "
                     "parts: 'bolt' parts: 'Ann' left_out: true }"),
              Contains("annotations.parts"));
}

TEST(AssemblyImport, ChecksAnnotationsOfFilesThatCannotBeRead) {
  std::vector<std::string> fields;
  for (const FieldViolation& finding : CheckWithoutDrawing(
           Annotations("name: 'Trestle!' parts { parts: 'nobody' item: 'items/none' } "
                       "parts { parts: 'top' item: 'items/board' group: 'of the file' }"),
           {Board()})) {
    fields.push_back(finding.field);
  }
  EXPECT_THAT(fields, UnorderedElementsAre("annotations.name", "annotations.parts[0].item"));
}

TEST(AssemblyImport, SaysWhyAnItemDoesNotFit) {
  const DrawnAssembly drawn =
      Made("name: 'assemblies/a' parts { parts: 'top' item: 'items/board' }");
  ASSERT_EQ(drawn.findings.size(), 1u);
  EXPECT_EQ(drawn.findings[0].field, "annotations.parts[0].item");
  EXPECT_EQ(drawn.findings[0].message,
            "'top' measures 938 × 89 × 20 mm, in which 'items/board' (40 to 2400 × 89 × 38 mm) "
            "does not fit");
}

TEST(AssemblyImport, WantsSurfacesClosedOrLeftOut) {
  cad::StepAssembly drawing = Trestle();
  drawing.leaves = {{"skin", "skin", "skin", 1, true}, {"axis", "axis", "axis", 0, false}};
  EXPECT_THAT(Fields(kGood, drawing), ElementsAre("step"));
  EXPECT_THAT(Fields(absl::StrCat(kGood, "parts { parts: 'skin' left_out: true }"), drawing),
              IsEmpty());
  EXPECT_THAT(
      Fields(absl::StrCat(kGood, "parts { parts: 'legs/skin' item: 'items/board' }"), drawing),
      ElementsAre("annotations.parts[3]"));
  EXPECT_THAT(Made(kGood, drawing).notes, Contains(HasSubstr("'axis' has no solid")));
}

TEST(AssemblyImport, RefusesPartsThinnerThanTheTolerance) {
  cad::StepAssembly drawing = Trestle();
  drawing.parts[2].maximum.z() = drawing.parts[2].minimum.z() + 1e-5;
  EXPECT_THAT(Fields(kGood, drawing), IsEmpty());
  EXPECT_THAT(Fields(absl::StrCat(kGood, "tolerance: 2e-5"), drawing), ElementsAre("step"));
}

TEST(DrawnCoordinates, AreEqualWithinTheTolerance) {
  const std::vector<double> snapped =
      SnapCoordinates({0.30000004, 1.2, 0.29999996, 0.30000195, -3e-8, 0.00079375}, 1e-6);
  EXPECT_THAT(snapped, ElementsAre(0.3, 1.2, 0.3, 0.30000195, 0.0, 0.00079375));
  EXPECT_THAT(SnapCoordinates({0, 0.9e-6, 1.8e-6}, 1e-6), ElementsAre(0.0, 0.0, 1.8e-6))
      << "a chain does not pull all together";
  EXPECT_THAT(SnapCoordinates({}, 1e-6), IsEmpty());
}

TEST(DrawnCoordinates, AreTheRoundestOfThoseThatAreEqual) {
  EXPECT_THAT(SnapCoordinates({0.0569993, 0.057, 0.3}, 1e-6), ElementsAre(0.057, 0.057, 0.3));
}

// What is in proportion as drawn stays so: the halves of a hexagon and of a right angle.
TEST(DrawnCoordinates, AreNotMadeRoundByChance) {
  const double hexagon = 0.05 * std::sqrt(3.0) / 2, diagonal = 0.03 * std::sqrt(2.0);
  EXPECT_THAT(SnapCoordinates({hexagon, diagonal, 0.1234500004}, 1e-6),
              ElementsAre(::testing::DoubleNear(hexagon, 1e-11),
                          ::testing::DoubleNear(diagonal, 1e-11), 0.12345));
}

TEST(ItemFit, LaysTheLengthAlongTheLongest) {
  parametric::Item sheet = Board();
  sheet.dimensions = {{{2.5, parametric::Process::kJigsaw, 0.05, 2.5},
                       {1.25, parametric::Process::kJigsaw, 0.05, 1.25},
                       {0.018}}};
  const auto fit =
      FindFit(sheet, {0.4, 0.018, 0.9}, v1::AXIS_UNSPECIFIED, v1::AXIS_UNSPECIFIED, 1e-6);
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(fit->length_axis, v1::Z);
  EXPECT_EQ(fit->thickness_axis, v1::Y);
  const auto asked = FindFit(sheet, {0.4, 0.018, 0.9}, v1::X, v1::AXIS_UNSPECIFIED, 1e-6);
  ASSERT_TRUE(asked.has_value());
  EXPECT_EQ(asked->length_axis, v1::X);
  EXPECT_FALSE(FindFit(sheet, {0.4, 0.018, 0.9}, v1::Y, v1::AXIS_UNSPECIFIED, 1e-6).has_value());
  EXPECT_FALSE(FindFit(sheet, {0.4, 0.019, 0.9}, v1::AXIS_UNSPECIFIED, v1::AXIS_UNSPECIFIED, 1e-6));
}

// `size` bytes of x, packed by gzip.
std::string Packed(std::size_t size) {
  std::string packed;
  google::protobuf::io::StringOutputStream sink(&packed);
  google::protobuf::io::GzipOutputStream gzip(&sink);
  while (size > 0) {
    void* room = nullptr;
    int free = 0;
    EXPECT_TRUE(gzip.Next(&room, &free));
    const std::size_t count = std::min(size, static_cast<std::size_t>(free));
    std::fill_n(static_cast<char*>(room), count, 'x');
    gzip.BackUp(free - static_cast<int>(count));
    size -= count;
  }
  EXPECT_TRUE(gzip.Close());
  return packed;
}

TEST(UnpackStep, TakesGzipOrNone) {
  const std::string text(200'000, 'x');
  EXPECT_EQ(UnpackStep(text).value_or(""), text);
  EXPECT_EQ(UnpackStep(Packed(text.size())).value_or(""), text);
  EXPECT_EQ(UnpackStep("").value_or("x"), "");
  EXPECT_EQ(UnpackStep(Packed(0)).status().message(), "step: is empty");
  const absl::Status bomb = UnpackStep(Packed(std::size_t{70} << 20)).status();
  EXPECT_TRUE(absl::IsResourceExhausted(bomb)) << bomb;
  const absl::Status nonsense = UnpackStep("\x1f\x8bnonsense").status();
  EXPECT_TRUE(absl::IsInvalidArgument(nonsense)) << nonsense;
  EXPECT_EQ(DetailOf(nonsense).field, "step");
}

TEST(AssemblyImport, NotesSizesThatTheDesignHolds) {
  EXPECT_EQ(NoteOnHeldSizes({}), "");
  std::vector<parametric::Measure> held{{"board", parametric::Axis::kX},
                                        {"board", parametric::Axis::kY}};
  EXPECT_THAT(NoteOnHeldSizes(held), HasSubstr(": 'board' x, 'board' y"));
  for (int post = 0; post < 50; ++post) held.push_back({"post", parametric::Axis::kZ});
  EXPECT_THAT(NoteOnHeldSizes(held), HasSubstr(" more"));
}

}  // namespace
}  // namespace mortise::catalog
