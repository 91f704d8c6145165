#include "common/templates/analysis_needs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/unit/common/templates/conditioned_bars.h"

namespace mortise::templates {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr char kHeld[] =
    "boundary_conditions { name: 'foot' kind: FIXED part: 'bar' face: 'x_min' } ";
constexpr char kLoaded[] =
    "boundary_conditions { name: 'weight' kind: GRAVITY components: '0' components: '0' "
    "components: '-9.81' } ";

TEST(AnalysisNeeds, TellsWhatPartsAndAssembliesLack) {
  const std::map<std::string, v1::TemplateBundle (*)(const std::string&)> kinds{
      {"parts", [](const std::string& text) { return PartsBar(text); }},
      {"assembly", [](const std::string& text) { return AssemblyBar(text); }}};
  for (const auto& [kind, bar] : kinds) {
    SCOPED_TRACE(kind);
    EXPECT_THAT(AnalysisLacks(bar("")), ElementsAre("supports", "loads"));
    EXPECT_THAT(AnalysisLacks(bar(kHeld)), ElementsAre("loads"));
    EXPECT_THAT(AnalysisLacks(bar(kLoaded)), ElementsAre("supports"));
    EXPECT_THAT(AnalysisLacks(bar(std::string(kHeld) + kLoaded)), IsEmpty());
  }
}

TEST(AnalysisNeeds, TellsWhatFeaturesLack) {
  EXPECT_THAT(AnalysisLacks(CadBar("")), ElementsAre("supports", "loads"));
  EXPECT_THAT(AnalysisLacks(CadBar("features { name: 'a' fixed { faces: 'bar.start' } } "
                                   "features { name: 'b' pressure { faces: 'bar.end' "
                                   "pressure: '10' } } ")),
              IsEmpty());
}

TEST(AnalysisNeeds, HeatMakesSupportsAndLoadsUnnecessary) {
  EXPECT_THAT(AnalysisLacks(PartsBar("boundary_conditions { name: 'in' kind: TEMPERATURE "
                                     "part: 'bar' face: 'x_min' components: '300' } ")),
              IsEmpty());
}

TEST(AnalysisNeeds, EveryPartThatBearsNeedsAMaterial) {
  v1::TemplateBundle bundle = AssemblyBar(std::string(kHeld) + kLoaded);
  v1::AssemblyPart& part = *bundle.mutable_assembly()->mutable_parts(0);
  part.clear_item();
  EXPECT_THAT(AnalysisLacks(bundle), ElementsAre("materials"));
  part.set_role(v1::AssemblyPart::CONNECTING);
  EXPECT_THAT(AnalysisLacks(bundle), IsEmpty());
}

}  // namespace
}  // namespace mortise::templates
