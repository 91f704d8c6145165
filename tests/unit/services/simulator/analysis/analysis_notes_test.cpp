// What is said of numbers that cannot be meant, and of coarse meshes.
#include "services/simulator/analysis/analysis_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/units.h"
#include "tests/unit/services/simulator/analysis/test_cases.h"

namespace mortise::simulator {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Material Steel(double modulus, double density) { return {"steel", density, modulus, 0.3, 0}; }

TEST(AnalysisNotes, OrdinaryMaterialsNeedNone) {
  EXPECT_THAT(NotesOnMaterials({Spruce(), Steel(210 * kGigapascal, 7850)}), IsEmpty());
  EXPECT_THAT(NotesOnMaterials({Steel(5 * kMegapascal, 1)}), IsEmpty()) << "rubber, an aerogel";
}

TEST(AnalysisNotes, ModuliInOtherUnitsAreNamed) {
  EXPECT_THAT(NotesOnMaterials({Steel(210, 7850)}),
              ElementsAre(AllOf(HasSubstr("'steel'"), HasSubstr("youngs_modulus of 210 Pa"),
                                HasSubstr("were 210 GPa meant?"))));
  EXPECT_THAT(NotesOnMaterials({Steel(210000, 7850)}),
              ElementsAre(HasSubstr("were 210000 MPa meant?")));
  EXPECT_THAT(NotesOnMaterials({Steel(210e12, 7850)}),
              ElementsAre(HasSubstr("is the number in SI units?")));
  Material wood = Spruce();
  wood.orthotropy.emplace().youngs_modulus = {11e9, 0.8, 0.4e9};
  EXPECT_THAT(NotesOnMaterials({wood}), ElementsAre(HasSubstr("along direction 2 of 0.8 Pa")));
}

TEST(AnalysisNotes, DensitiesInOtherUnitsAreNamed) {
  EXPECT_THAT(NotesOnMaterials({Steel(210e9, 0.00785)}),
              ElementsAre(AllOf(HasSubstr("a density of 0.00785 kg/m³"),
                                HasSubstr("were 0.00785 g/mm³ meant?"))));
  EXPECT_THAT(NotesOnMaterials({Steel(210e9, 7.85e-9)}), ElementsAre(HasSubstr("t/mm³ meant?")));
  EXPECT_THAT(NotesOnMaterials({Steel(210e9, 0)}), IsEmpty()) << "not known";
}

TEST(AnalysisNotes, AMaterialOfManyPartsIsNamedOnce) {
  EXPECT_EQ(NotesOnMaterials({Steel(210, 7850), Spruce(), Steel(210, 7850)}).size(), 1u);
}

TEST(AnalysisNotes, DesignsTellOfWhatCannotBeMeant) {
  DesignModel model = Cantilever(1, 0.1, 1000, 0.3);
  const auto sound = AnalyzeDesign(model, {"max_displacement"}, false, {});
  ASSERT_TRUE(sound.ok()) << sound.status();
  EXPECT_THAT(sound->notes, IsEmpty());
  model.analysis.materials[0].youngs_modulus = 210;
  const auto soft = AnalyzeDesign(model, {"max_displacement"}, false, {});
  ASSERT_TRUE(soft.ok()) << soft.status();
  EXPECT_THAT(soft->notes, ElementsAre(HasSubstr("were 210 GPa meant?"),
                                       HasSubstr("exceeds the size of all that is there, 1.01 m")));
}

TEST(AnalysisNotes, ACoarserMeshSaysHowToRefineIt) {
  mesh::BudgetedMesh budgeted;
  budgeted.wanted_size = 0.011;
  EXPECT_EQ(NoteOnBudget(budgeted, {}), "");
  budgeted.chosen_size = 0.024;
  budgeted.mesh.tetrahedra.resize(10, 500);
  EXPECT_THAT(
      NoteOnBudget(budgeted, {}),
      AllOf(HasSubstr("up to 24 mm wide"), HasSubstr("500 of them"), HasSubstr("budget of 60000"),
            HasSubstr("--element-size 11mm"), HasSubstr("--relative-error")));
  budgeted.mesh.tetrahedra.resize(4, 500);
  EXPECT_THAT(NoteOnBudget(budgeted, {}), HasSubstr("leave out `linear`"));
}

}  // namespace
}  // namespace mortise::simulator
