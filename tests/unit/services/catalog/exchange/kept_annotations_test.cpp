// A drawing that is imported again without annotations keeps those of the revision before.
#include "services/catalog/exchange/kept_annotations.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "services/catalog/exchange/assembly_import.h"

namespace mortise::catalog {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

v1::AssemblyAnnotations Annotations(const std::string& text) {
  v1::AssemblyAnnotations annotations;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &annotations)) << text;
  return annotations;
}

parametric::Item Board() {
  parametric::Item board;
  board.name = "items/board";
  board.kind = parametric::ItemKind::kBoard;
  board.dimensions = {{{2.4, parametric::Process::kChopSaw, 0.04, 2.4}, {0.089}, {0.038}}};
  return board;
}

void AddPart(cad::StepAssembly& drawing, const std::string& name, const Eigen::Vector3d& low,
             const Eigen::Vector3d& size, int group = 0) {
  cad::StepPart part;
  part.name = part.drawn_name = name;
  part.group = group;
  part.minimum = low;
  part.maximum = low + size;
  part.volume = size.prod();
  part.is_box = true;
  drawing.parts.push_back(part);
}

// Two legs under a top, and a bolt.
cad::StepAssembly Trestle() {
  cad::StepAssembly drawing;
  drawing.name = "Trestle 3000";
  drawing.groups = {{"Trestle 3000", -1}, {"legs", 0}};
  drawing.products = {{"leg", {}, {}}};
  AddPart(drawing, "leg 1", {0, 0, 0}, {0.038, 0.089, 0.7}, 1);
  AddPart(drawing, "leg 2", {0.9, 0, 0}, {0.038, 0.089, 0.7}, 1);
  AddPart(drawing, "top", {0, 0, 0.7}, {0.938, 0.089, 0.02});
  AddPart(drawing, "bolt", {0.01, 0.02, 0.69}, {0.01, 0.01, 0.05});
  return drawing;
}

constexpr char kAnnotated[] =
    "name: 'assemblies/trestle' title: 'Trestle' "
    "parts { parts: 'leg 1' parts: 'leg 2' item: 'items/board' priority: 3 } "
    "parts { parts: 'bolt' role: CONNECTING title: 'Bolt' } "
    "joints { name: 'fold' group: 'legs' kind: HINGE axis { y: 1 } upper: 1 }";

// The revision that the annotations make of the drawing.
v1::Assembly Before(const std::string& text = kAnnotated) {
  v1::Assembly before = MakeAssembly(Trestle(), Annotations(text), {Board()}).assembly;
  before.set_revision(3);
  return before;
}

KeptAnnotations Kept(const cad::StepAssembly& drawing, const v1::Assembly& before = Before(),
                     const std::vector<parametric::Item>& items = {Board()}) {
  return KeepAnnotations(before, drawing, Annotations("name: 'assemblies/trestle'"), items);
}

v1::Assembly Again(const cad::StepAssembly& drawing, const KeptAnnotations& kept) {
  DrawnAssembly drawn = MakeAssembly(drawing, kept.annotations, {Board()});
  EXPECT_THAT(drawn.findings, IsEmpty());
  return drawn.assembly;
}

TEST(KeptAnnotations, TheSameDrawingIsTheSameDesign) {
  const KeptAnnotations kept = Kept(Trestle());
  v1::Assembly before = Before();
  before.clear_revision();
  EXPECT_EQ(Again(Trestle(), kept).DebugString(), before.DebugString());
  EXPECT_THAT(kept.notes, Contains(AllOf(HasSubstr("revision 3"), HasSubstr("leg 1, leg 2, bolt"),
                                         HasSubstr("--drop-annotations"))));
}

TEST(KeptAnnotations, ThoseOfPartsThatAreGoneAreTold) {
  cad::StepAssembly drawing = Trestle();
  drawing.parts[1].name = drawing.parts[1].drawn_name = "post";
  const KeptAnnotations kept = Kept(drawing);
  EXPECT_THAT(kept.notes, Contains(AllOf(HasSubstr("not in the drawing"), HasSubstr("leg 2"))));
  EXPECT_THAT(kept.notes, Contains(HasSubstr("parts that revision 3 does not have: post")));
  const v1::Assembly again = Again(drawing, kept);
  EXPECT_EQ(again.parts(0).item(), "items/board");
  EXPECT_EQ(again.parts(1).item(), "");
}

TEST(KeptAnnotations, AnItemThatNoLongerFitsIsToldAndLeftOut) {
  cad::StepAssembly drawing = Trestle();
  drawing.parts[1].maximum.x() += 0.01;
  const KeptAnnotations kept = Kept(drawing);
  EXPECT_THAT(kept.notes, Contains(AllOf(HasSubstr("no longer fit"), HasSubstr("'leg 2'"))));
  const v1::Assembly again = Again(drawing, kept);
  EXPECT_EQ(again.parts(0).item(), "items/board");
  EXPECT_EQ(again.parts(1).item(), "");
  EXPECT_EQ(again.parts(1).priority(), 3) << "what still holds is kept";
}

TEST(KeptAnnotations, AnItemThatIsGoneIsTold) {
  const KeptAnnotations kept = Kept(Trestle(), Before(), {});
  EXPECT_THAT(kept.notes, Contains(HasSubstr("there is no 'items/board'")));
  EXPECT_EQ(Again(Trestle(), kept).parts(0).item(), "");
}

TEST(KeptAnnotations, GroupsOfTheirOwnStayAndThoseOfTheDrawingFollowIt) {
  const v1::Assembly own = Before(
      "name: 'assemblies/trestle' groups { name: 'stand' } "
      "parts { parts: 'leg 1' parts: 'leg 2' group: 'stand' item: 'items/board' }");
  EXPECT_EQ(Again(Trestle(), Kept(Trestle(), own)).parts(0).group(), "stand");
  cad::StepAssembly regrouped = Trestle();
  regrouped.groups.push_back({"tops", 0});
  regrouped.parts[2].group = 2;
  EXPECT_EQ(Again(regrouped, Kept(regrouped)).parts(2).group(), "tops");
}

TEST(KeptAnnotations, OfADrawingThatNeverHadAnyNothingIsKept) {
  const KeptAnnotations kept = Kept(Trestle(), Before("name: 'assemblies/trestle'"));
  EXPECT_THAT(kept.notes, IsEmpty());
  EXPECT_TRUE(KeepFormer(kept.annotations));
  EXPECT_EQ(Again(Trestle(), kept).title(), "Trestle 3000");
}

TEST(KeptAnnotations, AreDroppedWhereThatIsSaid) {
  EXPECT_TRUE(KeepFormer(Annotations("name: 'assemblies/trestle' title: 'T' tolerance: 1e-5")));
  const v1::AssemblyAnnotations dropping = Annotations("name: 'assemblies/a' parts { parts: '*' }");
  EXPECT_FALSE(KeepFormer(dropping));
  EXPECT_TRUE(WithoutDropping(dropping).parts().empty());
  for (const char* other :
       {"parts { parts: '*' item: 'items/board' }", "parts { parts: '*' } parts { parts: 'top' }",
        "parts { parts: 'top' }", "parts { parts: '*' parts: 'top' }"}) {
    EXPECT_EQ(WithoutDropping(Annotations(other)).DebugString(), Annotations(other).DebugString());
  }
}

}  // namespace
}  // namespace mortise::catalog
