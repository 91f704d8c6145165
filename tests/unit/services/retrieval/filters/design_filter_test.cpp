// Which designs somebody can use.
#include "services/retrieval/filters/design_filter.h"

#include <gtest/gtest.h>

#include <memory>

#include "common/design/costs/design_cost.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::retrieval {
namespace {

using parametric::EvaluatedDesign;
using parametric::EvaluatedPart;
using parametric::Item;

// The table that ships, at its default: all of wood, with pegs.
class DesignFilterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_OK_AND_ASSIGN(table_, templates::Compile(templates::ShippedTemplate("templates/table")));
    ASSERT_OK_AND_ASSIGN(design_, table_->Evaluate(parametric::Defaults(table_->parameters())));
    Eigen::Vector3d lower = design_.parts.front().minimum, upper = design_.parts.front().maximum;
    for (const EvaluatedPart& part : design_.parts) {
      lower = lower.cwiseMin(part.minimum);
      upper = upper.cwiseMax(part.maximum);
    }
    size_ = upper - lower;
  }

  const std::vector<Item>& items() const { return table_->head().items; }
  bool Met(const DesignFilter& filter) const { return Meets(filter, FactsOf(design_, items())); }

  // Exactly what the table takes.
  std::map<std::string, double> Needed() const {
    std::map<std::string, double> available;
    const auto needs = parametric::NeedsOf(design_, items());
    EXPECT_OK(needs);
    for (const auto& need : *needs) available[need.item] = need.pieces;
    return available;
  }

  std::shared_ptr<const templates::Template> table_;
  EvaluatedDesign design_;
  Eigen::Vector3d size_;
};

TEST_F(DesignFilterTest, EveryDesignMeetsAnEmptyOne) {
  EXPECT_TRUE(IsEmpty({}));
  EXPECT_TRUE(Met({}));
  EXPECT_TRUE(Meets({}, FactsOf(EvaluatedDesign(), {})));
}

TEST_F(DesignFilterTest, ComparesTheBoxAxisByAxis) {
  DesignFilter filter;
  filter.min_size = filter.max_size = size_;
  EXPECT_FALSE(IsEmpty(filter));
  EXPECT_TRUE(Met(filter));
  for (int axis = 0; axis < 3; ++axis) {
    DesignFilter smaller, larger;
    smaller.max_size[axis] = size_[axis] - 1e-6;
    larger.min_size[axis] = size_[axis] + 1e-6;
    EXPECT_FALSE(Met(smaller)) << axis;
    EXPECT_FALSE(Met(larger)) << axis;
  }
  EXPECT_FALSE(Meets(filter, FactsOf(EvaluatedDesign(), {})));
}

TEST_F(DesignFilterTest, KnowsWhatPartsAreMadeOf) {
  std::set<std::string> materials;
  for (const EvaluatedPart& part : design_.parts) materials.insert(part.material);
  EXPECT_TRUE(Met({.materials = materials}));
  EXPECT_FALSE(Met({.materials = std::set<std::string>{"materials/other"}}));
  for (const std::string& each : materials) {
    std::set<std::string> others = materials;
    others.erase(each);
    EXPECT_FALSE(Met({.materials = others})) << each;
  }
  // Screws may be of steel in a design of wood, but are not what it is made of.
  design_.parts.push_back(design_.parts.front());
  design_.parts.back().connecting = true;
  design_.parts.back().material = "materials/steel";
  EXPECT_TRUE(Met({.materials = materials}));
  EXPECT_FALSE(Met({.materials = std::set<std::string>{"materials/steel"}}));
  design_.parts.erase(design_.parts.begin(), design_.parts.end() - 1);
  EXPECT_FALSE(Met({.materials = std::set<std::string>{"materials/steel"}}));
}

TEST_F(DesignFilterTest, ComparesPricesInOneCurrency) {
  ASSERT_OK_AND_ASSIGN(const parametric::Cost cost, parametric::CostOf(design_, items()));
  EXPECT_TRUE(Met({.max_price = cost}));
  EXPECT_FALSE(Met({.max_price = parametric::Cost{0.99 * cost.amount, cost.currency}}));
  EXPECT_FALSE(Met({.max_price = parametric::Cost{9 * cost.amount, "XTS"}}));
  design_.parts.front().item = "";  // nobody knows what it costs
  EXPECT_FALSE(Met({.max_price = parametric::Cost{9 * cost.amount, cost.currency}}));
}

TEST_F(DesignFilterTest, CountsWhatThereIsToBuildFrom) {
  const std::map<std::string, double> needed = Needed();
  EXPECT_TRUE(Met({.items = needed}));
  for (const auto& [item, pieces] : needed) {
    std::map<std::string, double> available = needed;
    available[item] = 0.999 * pieces;
    EXPECT_FALSE(Met({.items = available})) << item;
    available[item] = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(Met({.items = available})) << item;
    available.erase(item);
    EXPECT_FALSE(Met({.items = available})) << item;
  }
  design_.parts.front().item = "";
  EXPECT_FALSE(Met({.items = needed}));
}

TEST_F(DesignFilterTest, TellsFromATemplatesListsWhereNoDesignCan) {
  const std::vector<std::string> items = {"items/board", "items/dowel"};
  const std::vector<std::string> materials = {"materials/pine"};
  EXPECT_TRUE(MayMeet({}, items, materials));
  EXPECT_TRUE(MayMeet({}, {}, {}));
  EXPECT_TRUE(MayMeet({.materials = std::set<std::string>{"materials/pine", "materials/oak"}},
                      items, materials));
  EXPECT_FALSE(MayMeet({.materials = std::set<std::string>{"materials/oak"}}, items, materials));
  EXPECT_TRUE(
      MayMeet({.items = std::map<std::string, double>{{"items/dowel", 4}}}, items, materials));
  EXPECT_FALSE(
      MayMeet({.items = std::map<std::string, double>{{"items/nail", 4}}}, items, materials));
  EXPECT_FALSE(MayMeet({.items = std::map<std::string, double>{}}, items, materials));
}

}  // namespace
}  // namespace mortise::retrieval
