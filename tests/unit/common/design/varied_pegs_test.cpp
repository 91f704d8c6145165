// The pegs of copies: which are joined, rows of pegs, and pegs that may meet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/contact.h"
#include "common/design/template_validation.h"
#include "tests/unit/common/design/varied_designs.h"
#include "tests/unit/common/design/varied_shelf.h"

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(VariedPegs, PairsCopiesOneWithAnotherByNumberOrWhereTheyTouch) {
  TemplateBundle bundle = VariedShelf();
  TemplateDefinition& row = bundle.definition;
  row.boundary_conditions.clear();
  row.parts = {BoxPart("post", {"0", "0.1"}, {"0", "0.1"}, {"0", "0.5"}),
               BoxPart("cap", {"0", "0.1"}, {"0", "0.1"}, {"0.5", "0.6"}),
               BoxPart("beam", {"0", "2"}, {"0", "0.1"}, {"0.6", "0.7"})};
  row.parts[0].repeat = {{"shelves", "0.2", "", ""}};
  row.parts[1].repeat = {{"3", "0.2", "", ""}};
  const auto pairs = [&](Pairing pairing, const std::string& part, const std::string& face,
                         const std::string& other, double shelves) {
    row.connections = {Pegs("c", part, face, other)};
    row.connections[0].pairing = pairing;
    const EvaluatedDesign design = At(bundle, {{"shelves", shelves}});
    std::vector<std::string> found;
    for (const EvaluatedConnector& peg : design.connectors) {
      found.push_back(absl::StrCat(peg.part, "-", peg.other_part));
    }
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  };
  EXPECT_THAT(pairs(Pairing::kUnspecified, "cap", "z_max", "beam", 1),
              ElementsAre("cap 1-beam", "cap 2-beam", "cap 3-beam"));
  EXPECT_THAT(pairs(Pairing::kUnspecified, "post", "z_max", "cap", 3),
              ElementsAre("post 1-cap 1", "post 2-cap 2", "post 3-cap 3"));
  EXPECT_THAT(pairs(Pairing::kByNumber, "post", "z_max", "cap", 3), SizeIs(3));
  EXPECT_THAT(pairs(Pairing::kTouching, "post", "z_max", "cap", 5), SizeIs(3));
  EXPECT_THAT(pairs(Pairing::kUnspecified, "post 2", "z_max", "cap 2", 5),
              ElementsAre("post 2-cap 2"));
  row.connections[0] = Pegs("c", "post", "z_max", "cap");
  EXPECT_EQ(DetailOf(FaultAt(bundle, {{"shelves", 4}})).field, "connections[0].pairing");
  row.connections[0] = Pegs("c", "post 4", "z_max", "beam");
  EXPECT_THAT(FaultAt(bundle, {{"shelves", 3}}).message(),
              HasSubstr("there is no 'post 4': 'post' is there 3 times"));
  row.connections[0] = Pegs("c", "post", "z_max", "beam");
  EXPECT_THAT(FaultAt(bundle, {}).message(), HasSubstr("'post 1' does not touch 'beam'"));
  row.connections[0].pairing = Pairing::kTouching;
  EXPECT_THAT(FaultAt(bundle, {}).message(), HasSubstr("touches any 'beam'"));
  // A part's own copies, side by side.
  row.parts[0].repeat[0].x = "0.1";
  row.connections[0] = Pegs("c", "post", "x_max", "post");
  row.connections[0].pairing = Pairing::kTouching;
  row.connections[0].item = "items/thin-peg";
  EXPECT_THAT(pairs(Pairing::kTouching, "post", "x_max", "post", 3),
              ElementsAre("post 1-post 2", "post 2-post 3"));
}

TEST(VariedPegs, PegsStandInRowsOnWidePatches) {
  TemplateBundle bundle = VariedShelf();
  TemplateDefinition& slab = bundle.definition;
  slab.boundary_conditions.clear();
  slab.parts = {BoxPart("below", {"0", "1"}, {"0", "0.5"}, {"0", "0.1"}),
                BoxPart("above", {"0", "1"}, {"0", "0.5"}, {"0.1", "0.2"})};
  slab.connections = {Pegs("grid", "above", "z_min", "below")};
  slab.connections[0].spacing = 0.2;
  slab.connections[0].end_distance = 0.1;
  EXPECT_THAT(At(bundle, {}).connectors, SizeIs(5));  // 0.1, 0.3 … 0.9, in the middle
  slab.connections[0].row_spacing = 0.15;
  // Across 0.5 m, 0.1 m from the sides: 0.1, 0.2, 0.3, 0.4.
  EvaluatedDesign design = At(bundle, {});
  ASSERT_THAT(design.connectors, SizeIs(15));
  std::set<double> across, along;
  for (const EvaluatedConnector& peg : design.connectors) {
    across.insert(std::round(1e6 * peg.position.y()) / 1e6);
    along.insert(std::round(1e6 * peg.position.x()) / 1e6);
  }
  EXPECT_THAT(along, ElementsAre(0.1, 0.3, 0.5, 0.7, 0.9));
  EXPECT_THAT(across, ElementsAre(0.1, 0.25, 0.4));
  slab.connections[0].side_distance = 0.05;
  EXPECT_THAT(At(bundle, {}).connectors, SizeIs(20));
  EXPECT_THAT(ValidateTemplate(bundle), IsEmpty());
}

// Pegs that may meet are found in a grid as they are among all pairs.
TEST(VariedPegs, NearOnesAreThoseOfAllPairs) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> uniform(-0.12, 0.12), size(0.01, 0.08);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<EvaluatedConnector> pegs(150);
    for (EvaluatedConnector& peg : pegs) {
      peg.position = {uniform(random), uniform(random), uniform(random)};
      peg.direction =
          Eigen::Vector3d(uniform(random), uniform(random), uniform(random) + 0.5).normalized();
      peg.length = size(random);
      peg.diameter = size(random) / 4;
      peg.depth_in_part = peg.length / 3;
    }
    std::set<std::pair<std::size_t, std::size_t>> meeting, near;
    for (std::size_t i = 0; i < pegs.size(); ++i) {
      for (std::size_t j = i + 1; j < pegs.size(); ++j) {
        if (PenetrationDepth(pegs[i], pegs[j]) > 0) meeting.insert({i, j});
      }
    }
    ForNearPegs(pegs, [&](std::size_t i, std::size_t j) {
      EXPECT_TRUE(near.insert({i, j}).second);
      return true;
    });
    EXPECT_FALSE(meeting.empty());
    EXPECT_LT(near.size(), pegs.size() * (pegs.size() - 1) / 2);
    EXPECT_TRUE(std::includes(near.begin(), near.end(), meeting.begin(), meeting.end()));
  }
  ForNearPegs({}, [](std::size_t, std::size_t) {
    ADD_FAILURE() << "there are no pegs";
    return true;
  });
}

}  // namespace
}  // namespace mortise::parametric
