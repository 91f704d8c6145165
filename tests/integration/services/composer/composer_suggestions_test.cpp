// Models are asked what they are made of, and what might come next: mortise-composer as a real
// process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "common/base/errors.h"
#include "tests/integration/services/composer/composer_house.h"

namespace mortise::testing {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;
using Stub = v1::ComposerService::Stub;

class ComposerSuggestionsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    house_ = std::make_unique<ComposerHouse>();
    v1::Model model = house_->New("frame");
    frame_ = house_->Add(model, "dining-table", "frame", "frame").value_or(model);
    ASSERT_EQ(frame_.components_size(), 1);
  }
  static void TearDownTestSuite() { house_.reset(); }

  static absl::StatusOr<v1::ComponentSuggestions> Suggest(v1::SuggestComponentsRequest request) {
    if (request.name().empty()) request.set_name(frame_.name());
    return Call(house_->composer(), &Stub::SuggestComponents, request);
  }

  static absl::StatusOr<v1::ModelBill> Bill(const std::string& name) {
    v1::GetModelBillRequest request;
    request.set_name(name);
    return Call(house_->composer(), &Stub::GetModelBill, request);
  }

  static void ExpectRefused(const v1::SuggestComponentsRequest& request, const std::string& field) {
    const absl::Status status = Suggest(request).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    EXPECT_EQ(DetailOf(status).field, field) << status;
  }

  static std::unique_ptr<ComposerHouse> house_;
  static v1::Model frame_;
};

std::unique_ptr<ComposerHouse> ComposerSuggestionsTest::house_;
v1::Model ComposerSuggestionsTest::frame_;

TEST_F(ComposerSuggestionsTest, ABillNamesEachItemOnce) {
  const auto bill = Bill(frame_.name());
  ASSERT_TRUE(bill.ok()) << bill.status();
  EXPECT_EQ(bill->revision(), frame_.revision());
  EXPECT_GT(bill->mass(), 0);
  int parts = 0;
  double sum = 0;
  for (const v1::ModelBillLine& line : bill->lines()) {
    parts += line.quantity();
    sum += line.price().amount();
    EXPECT_FALSE(line.title().empty());
    EXPECT_EQ(line.parts_size(), line.quantity());
  }
  EXPECT_EQ(parts, frame_.parts_size());
  ASSERT_EQ(bill->totals_size(), 1);
  EXPECT_EQ(bill->totals(0).currency(), "EUR");
  EXPECT_NEAR(bill->totals(0).amount(), sum, 1e-9);
}

TEST_F(ComposerSuggestionsTest, ABillIsOfTheModelAsItIsNow) {
  v1::Model model = house_->New("billed");
  model = house_->Add(model, "dining-table", "", "table").value_or(model);
  const auto before = Bill(model.name());
  ASSERT_TRUE(before.ok()) << before.status();
  const auto wider = house_->Drag(model, "long apron 1", "width", 1.6);
  ASSERT_TRUE(wider.ok()) << wider.status();
  const auto after = Bill(model.name());
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_GT(after->totals(0).amount(), before->totals(0).amount());
  const bool is_there =
      std::any_of(after->lines().begin(), after->lines().end(), [](const auto& l) {
        return l.item() == "items/beech-plank-26x200" && std::abs(l.size().x() - 1.6) < 1e-6;
      });
  EXPECT_TRUE(is_there);
}

// What is suggested is given to AddComponent as it is, and then snaps and is connected.
TEST_F(ComposerSuggestionsTest, TheTopOfATableIsSuggestedForItsFrame) {
  const auto found = Suggest({});
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->revision(), frame_.revision());
  ASSERT_THAT(found->suggestions(), Not(IsEmpty()));
  const v1::ComponentSuggestion& best = found->suggestions(0);
  EXPECT_EQ(best.template_(), "templates/dining-table");
  EXPECT_EQ(best.group(), "top");
  EXPECT_NEAR(best.position().z(), 0.712, 1e-9);
  EXPECT_GT(best.price().amount(), 0);
  EXPECT_EQ(best.trial(), v1::ComponentSuggestion::FITS);
  for (int i = 1; i < found->suggestions_size(); ++i) {
    EXPECT_LE(found->suggestions(i).score(), found->suggestions(i - 1).score());
  }
  v1::AddComponentRequest add;
  add.set_template_(best.template_());
  add.set_template_revision(best.template_revision());
  add.set_group(best.group());
  *add.mutable_position() = best.position();
  add.set_component_id("suggested");
  v1::Model model = house_->New("taken");
  model = house_->Add(model, "dining-table", "frame", "frame").value_or(model);
  const auto added = house_->Change(&Stub::AddComponent, model, add);
  ASSERT_TRUE(added.ok()) << added.status();
  const auto snapped = house_->Snap(*added, "suggested");
  ASSERT_TRUE(snapped.ok()) << snapped.status();
  const auto connected = house_->Connect(*snapped, "suggested");
  ASSERT_TRUE(connected.ok()) << connected.status();
  EXPECT_THAT(ComponentOf(*connected, "suggested").connections(), Not(IsEmpty()));
}

// The frame of a table turned by a quarter: its top is, too.
TEST_F(ComposerSuggestionsTest, WhatFitsOnlyTurnedIsSuggestedTurned) {
  v1::AddComponentRequest add;
  add.set_template_("templates/dining-table");
  add.set_group("frame");
  add.set_component_id("frame");
  add.add_turns(v1::Z);
  const auto frame = house_->Change(&Stub::AddComponent, house_->New("turned"), add);
  ASSERT_TRUE(frame.ok()) << frame.status();
  v1::SuggestComponentsRequest request;
  request.set_name(frame->name());
  const auto found = Suggest(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_THAT(found->suggestions(), Not(IsEmpty()));
  const v1::ComponentSuggestion& best = found->suggestions(0);
  EXPECT_EQ(best.group(), "top");
  EXPECT_THAT(best.turns(), Not(IsEmpty()));
  EXPECT_EQ(best.trial(), v1::ComponentSuggestion::FITS);
  add.Clear();
  add.set_template_(best.template_());
  add.set_template_revision(best.template_revision());
  add.set_group(best.group());
  *add.mutable_position() = best.position();
  *add.mutable_turns() = best.turns();
  add.set_component_id("top");
  const auto added = house_->Change(&Stub::AddComponent, *frame, add);
  ASSERT_TRUE(added.ok()) << added.status();
  const auto snapped = house_->Snap(*added, "top");
  ASSERT_TRUE(snapped.ok()) << snapped.status();
  const auto connected = house_->Connect(*snapped, "top");
  ASSERT_TRUE(connected.ok()) << connected.status();
  EXPECT_THAT(connected->warnings(), IsEmpty());
}

TEST_F(ComposerSuggestionsTest, KeepsToThePriceAndWhatIsAtHand) {
  const auto all = Suggest({});
  ASSERT_TRUE(all.ok()) << all.status();
  ASSERT_THAT(all->suggestions(), Not(IsEmpty()));
  v1::SuggestComponentsRequest cheap;
  cheap.set_max_price(all->suggestions(0).price().amount() / 2);
  const auto cheaper = Suggest(cheap);
  ASSERT_TRUE(cheaper.ok()) << cheaper.status();
  for (const v1::ComponentSuggestion& each : cheaper->suggestions()) {
    ASSERT_TRUE(each.has_price());
    EXPECT_LE(each.price().amount(), cheap.max_price());
  }
  v1::SuggestComponentsRequest at_hand;
  at_hand.add_materials("materials/beech");
  const auto of_beech = Suggest(at_hand);
  ASSERT_TRUE(of_beech.ok()) << of_beech.status();
  EXPECT_EQ(of_beech->suggestions(0).group(), "top");
  v1::SuggestComponentsRequest nothing;
  nothing.add_items("items/dowel-6x40");
  const auto none = Suggest(nothing);
  ASSERT_TRUE(none.ok()) << none.status();
  EXPECT_THAT(none->suggestions(), IsEmpty());
}

TEST_F(ComposerSuggestionsTest, RefusesWhatItCannotAnswer) {
  v1::SuggestComponentsRequest request;
  request.set_count(51);
  ExpectRefused(request, "count");
  request.set_count(-1);
  ExpectRefused(request, "count");
  request.Clear();
  request.set_node("cellar");
  ExpectRefused(request, "node");
  request.Clear();
  request.set_max_price(-1);
  ExpectRefused(request, "max_price");
  request.Clear();
  request.add_items("beech");
  ExpectRefused(request, "items[0]");
  request.Clear();
  request.set_name("models/none");
  EXPECT_EQ(Suggest(request).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(Bill("models/none").status().code(), absl::StatusCode::kNotFound);
  request.set_name(house_->New("empty").name());
  EXPECT_EQ(DetailOf(Suggest(request).status()).reason, "MODEL_EMPTY");
  EXPECT_EQ(DetailOf(Bill(request.name()).status()).reason, "MODEL_EMPTY");
}

}  // namespace
}  // namespace mortise::testing
