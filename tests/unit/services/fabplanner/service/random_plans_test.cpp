// Designs with choices that ship can be built wherever their parameters are: at random ones, and at
// corners of their ranges, nothing is in anything else, no hole comes out or meets another, each
// step goes along one line, and every part is planned. MORTISE_RANDOM_DESIGNS says how many of each
// are tried; the manual tells what 1,000 gave.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <random>
#include <string>

#include "cli/files/ground_file.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/templates/template_codec.h"
#include "services/fabplanner/planning/planning.h"
#include "services/fabplanner/service/design_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"
#include "tests/unit/services/fabplanner/plan_faults.h"

namespace mortise::fabplanner {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

int DesignsToTry() {
  const char* const wanted = std::getenv("MORTISE_RANDOM_DESIGNS");
  return wanted == nullptr ? 15 : std::atoi(wanted);
}

// Anywhere in the ranges, or at their ends; as a workshop can set it.
Eigen::VectorXd RandomParameters(const std::vector<parametric::Parameter>& parameters, bool at_ends,
                                 std::mt19937_64& random) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const parametric::Parameter& range = parameters[static_cast<std::size_t>(i)];
    if (range.IsChoice()) {
      q(i) = static_cast<double>(random() % range.choices.size());
      continue;
    }
    double share = static_cast<double>(random() >> 11) * 0x1p-53;
    if (at_ends) share = std::round(share);
    q(i) = range.minimum + share * (range.maximum - range.minimum);
    if (range.step > 0) {
      q(i) = range.minimum + std::round((q(i) - range.minimum) / range.step) * range.step;
    }
    q(i) = std::clamp(q(i), range.minimum, range.maximum);
  }
  return q;
}

// A work table and its plan, to be spoilt.
struct Planned {
  Design design;
  FabricationPlan plan;
};

Planned PlannedTable() {
  const v1::TemplateBundle bundle = templates::ShippedTemplate("templates/work-table");
  const auto table = templates::Compile(bundle).value();
  const auto evaluated = table->Evaluate(parametric::Defaults(table->parameters()));
  Planned planned;
  planned.design = DesignFrom(parametric::ToProto(evaluated.value())).value();
  planned.plan = MakePlan(planned.design, ItemsFrom(bundle).value(), 1).value();
  return planned;
}

// These checks would be worth nothing if they found nothing.
TEST(PlanFaultsTest, TellsWhatIsWrong) {
  const Planned sound = PlannedTable();
  ASSERT_THAT(FaultsOf(sound.design, sound.plan), IsEmpty());
  const auto faults_with = [&](const std::function<void(Planned&)>& spoil) {
    Planned spoilt = sound;
    spoil(spoilt);
    return FaultsOf(spoilt.design, spoilt.plan);
  };
  EXPECT_THAT(faults_with([](Planned& table) {
                for (Part& part : table.design.parts) {
                  if (part.name == "slat 1") part.outline[0].x() -= 0.01;
                }
              }),
              Contains("slat 1 reaches into post 1.1"));
  EXPECT_THAT(faults_with([](Planned& table) { table.plan.holes[1].depth = 0.2; }),
              Contains(HasSubstr("comes out of post 1.1")));
  EXPECT_THAT(faults_with([](Planned& table) {
                table.plan.holes[2].position = table.plan.holes[0].position;
              }),
              Contains(HasSubstr("meet in end_rail 1")));
  EXPECT_THAT(faults_with([](Planned& table) { table.plan.boards[0].segments.pop_back(); }),
              Contains(HasSubstr("is not cut once")));
  EXPECT_THAT(faults_with([](Planned& table) {
                for (Peg& peg : table.design.pegs) {
                  if (peg.connection == "slats_rails") peg.priority = 4;
                  if (peg.other_part == "top") peg.priority = 3;
                }
              }),
              Contains("slat 1 passes through top"));
  EXPECT_THAT(faults_with([](Planned& table) {
                std::erase_if(table.design.pegs,
                              [](const Peg& peg) { return peg.part == "slat 2"; });
              }),
              Contains("slat 2 hangs loose"));
}

// Designs of a template at random.
void ExpectBuildable(const v1::TemplateBundle& bundle, const std::string& title) {
  const auto compiled = templates::Compile(bundle);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  const auto items = ItemsFrom(bundle);
  ASSERT_TRUE(items.ok()) << items.status();
  const std::vector<parametric::Parameter>& parameters = (*compiled)->parameters();
  std::mt19937_64 random(39);
  std::size_t pegs = 0;
  for (int i = 0; i < DesignsToTry(); ++i) {
    const Eigen::VectorXd q = RandomParameters(parameters, i % 3 == 2, random);
    const std::string where = parametric::ToText(parameters, q);
    const auto evaluated = (*compiled)->Evaluate(q);
    ASSERT_TRUE(evaluated.ok()) << where << ": " << evaluated.status();
    const auto design = DesignFrom(parametric::ToProto(*evaluated));
    ASSERT_TRUE(design.ok()) << where << ": " << design.status();
    const auto plan = MakePlan(*design, *items, 1);
    ASSERT_TRUE(plan.ok()) << where << ": " << plan.status();
    EXPECT_THAT(FaultsOf(*design, *plan), IsEmpty()) << where;
    pegs += design->pegs.size();
  }
  std::cout << title << ": " << DesignsToTry() << " designs, " << pegs << " pegs\n";
}

class RandomPlansTest : public ::testing::TestWithParam<std::string> {};

TEST_P(RandomPlansTest, CanBeBuilt) {
  ExpectBuildable(templates::ShippedTemplate(GetParam()), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Shipped, RandomPlansTest,
                         ::testing::Values("templates/armchair", "templates/shed",
                                           "templates/work-table", "templates/writing-desk",
                                           "templates/platform-bed", "templates/deck"),
                         [](const auto& each) {
                           std::string name = each.param.substr(each.param.find('/') + 1);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// What ships beside the deck to put it on, and where that has the deck's origin.
struct Terrain {
  std::string file;
  Eigen::Vector2d origin = {0, 0};
};

class RandomPlansOnTerrain : public ::testing::TestWithParam<Terrain> {};

TEST_P(RandomPlansOnTerrain, CanBeBuilt) {
  const char* const source = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path folder =
      std::filesystem::path(source == nullptr ? "." : source) / "collection/designs/deck";
  auto ground = cli::ReadGround(folder / GetParam().file, {.origin = GetParam().origin});
  ASSERT_TRUE(ground.ok()) << ground.status();
  ground->set_name("ground");
  v1::TemplateBundle deck = templates::ShippedTemplate("templates/deck");
  *deck.mutable_template_()->mutable_height_fields(0) = *std::move(ground);
  const absl::Status checked = templates::FillAndCheck(deck, templates::Trial::kThorough);
  ASSERT_TRUE(checked.ok()) << checked;
  ExpectBuildable(deck, "templates/deck on " + GetParam().file);
}

INSTANTIATE_TEST_SUITE_P(Shipped, RandomPlansOnTerrain,
                         ::testing::Values(Terrain{"hillside.asc", {451230, 5411872}},
                                           Terrain{"hollow.csv"}, Terrain{"bank.obj"}),
                         [](const auto& each) {
                           return each.param.file.substr(0, each.param.file.find('.'));
                         });

}  // namespace
}  // namespace mortise::fabplanner
