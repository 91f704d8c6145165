// What might come next in models made of designs that ship.
#include "services/composer/suggestions/suggest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/composer/model/overlap.h"
#include "services/composer/model/quarter_turn.h"
#include "services/composer/snapping/snap.h"
#include "services/composer/suggestions/try_suggestion.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using ::testing::Contains;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::Not;

std::string IdOf(const std::string& assembly) {
  std::string id = assembly.substr(assembly.find('/') + 1);
  std::replace(id.begin(), id.end(), '-', '_');
  return id;
}

// Components of what ships, each made once.
absl::StatusOr<const Assembly*> ShippedSubTree(const std::string& assembly,
                                               const std::string& node) {
  static auto* const known =
      new std::map<std::pair<std::string, std::string>, absl::StatusOr<Assembly>>();
  const std::pair key(assembly, node);
  auto found = known->find(key);
  if (found == known->end()) {
    const Assembly& whole = ShippedDesign(IdOf(assembly)).assembly->assembly();
    found = known->emplace(key, parametric::SubTreeOf(whole, node)).first;
  }
  if (!found->second.ok()) return found->second.status();
  return &*found->second;
}

SuggestOptions Options() {
  SuggestOptions options;
  options.same_material = [material_of = ShippedOptions().material_of](const std::string& item,
                                                                       const std::string& other) {
    return item == other || material_of(item) == material_of(other);
  };
  return options;
}

std::vector<const CollectionConnection*> ConnectionsOfAll(const std::vector<std::string>& ids) {
  std::vector<const CollectionConnection*> all;
  for (const std::string& id : ids) {
    for (const CollectionConnection& each : ShippedConnections(id)) all.push_back(&each);
  }
  return all;
}

const std::vector<std::string>& SomeDesigns() {
  static const auto* const ids =
      new std::vector<std::string>{"dining_table", "bookshelf", "workbench", "garden_bench"};
  return *ids;
}

TEST(SuggestTest, AFrameWantsTheTopThatItHadWhereItWas) {
  const Design frame = ShippedComponent("dining_table", "frame");
  const auto found = Suggest(frame, ConnectionsOfAll({"dining_table"}), ShippedSubTree, Options());
  ASSERT_THAT(found, Not(IsEmpty()));
  EXPECT_EQ(found[0].node, "top");
  EXPECT_EQ(found[0].distance, 0);
  EXPECT_EQ(found[0].assemblies, 1);
  EXPECT_EQ(found[0].held_by, 2);  // the long aprons
  EXPECT_EQ(found[0].score, 2);
  EXPECT_LT((found[0].position - Eigen::Vector3d(0.8, 0.45, 0.712)).norm(), 1e-9);
  // It is told of once, though both aprons hold it.
  const auto there = std::count_if(found.begin(), found.end(), [&](const Suggestion& each) {
    return each.node == "top" && (each.position - found[0].position).norm() < 0.01;
  });
  EXPECT_EQ(there, 1);
}

TEST(SuggestTest, WhereverTheModelIs) {
  Design frame = ShippedComponent("dining_table", "frame");
  frame.shift = {1, -2, 0.5};
  const auto found = Suggest(frame, ConnectionsOfAll({"dining_table"}), ShippedSubTree, Options());
  ASSERT_THAT(found, Not(IsEmpty()));
  EXPECT_LT((found[0].position - Eigen::Vector3d(1.8, -1.55, 1.212)).norm(), 1e-9);
}

TEST(SuggestTest, AWholeTableLacksNoTop) {
  const auto found = Suggest(ShippedDesign("dining_table"), ConnectionsOfAll({"dining_table"}),
                             ShippedSubTree, Options());
  EXPECT_THAT(found, Not(Contains(Field(&Suggestion::node, "top"))));
}

TEST(SuggestTest, NothingReachesIntoTheModel) {
  const Design frame = ShippedComponent("dining_table", "frame");
  const auto found = Suggest(frame, ConnectionsOfAll(SomeDesigns()), ShippedSubTree, Options());
  for (const Suggestion& each : found) {
    ASSERT_OK_AND_ASSIGN(const Assembly* const component,
                         ShippedSubTree(each.from->source, each.node));
    ASSERT_OK_AND_ASSIGN(Design design, AsDrawn(*component));
    const parametric::BoundingBox box = BoundsOf(design);
    design.shift =
        each.position - Eigen::Vector3d(box.center().x(), box.center().y(), box.minimum.z());
    for (const parametric::PlacedPart& part : PartsOf(design)) {
      for (const parametric::PlacedPart& other : PartsOf(frame)) {
        const SolidPart a(part.name, part.box, design.assembly->ShapeOf(part), part.stretch);
        const SolidPart b(other.name, other.box, frame.assembly->ShapeOf(other), other.stretch);
        EXPECT_EQ(SolidPart::DepthOf(a, b), 0)
            << each.from->source << " " << each.node << ": " << part.name << ", " << other.name;
      }
    }
  }
}

// What is suggested first can be added, snapped and connected.
TEST(SuggestTest, TheFirstOneCanBeConnected) {
  const Design frame = ShippedComponent("dining_table", "frame");
  const auto found = Suggest(frame, ConnectionsOfAll(SomeDesigns()), ShippedSubTree, Options());
  ASSERT_THAT(found, Not(IsEmpty()));
  const std::string id = IdOf(found[0].from->source);
  Design component = ShippedComponent(id, found[0].node);
  const parametric::BoundingBox box = BoundsOf(component);
  component.shift =
      found[0].position - Eigen::Vector3d(box.center().x(), box.center().y(), box.minimum.z());
  const Original original = ShippedOriginal(id);
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(component, &original.design, frame));
  ASSERT_OK_AND_ASSIGN(const Connected made, Connect(frame, snapped.component, "new", &original,
                                                     AllShippedConnections(), ShippedOptions()));
  EXPECT_THAT(made.connections, Not(IsEmpty()));
}

TEST(SuggestTest, IsTheSameWhateverTheOrderOfTheCollection) {
  const Design frame = ShippedComponent("dining_table", "frame");
  std::vector<const CollectionConnection*> connections = ConnectionsOfAll(SomeDesigns());
  const auto names = [&] {
    std::vector<std::string> all;
    for (const Suggestion& each : Suggest(frame, connections, ShippedSubTree, Options())) {
      all.push_back(each.from->source + " " + each.node + " " + each.element);
    }
    return all;
  };
  const std::vector<std::string> before = names();
  std::reverse(connections.begin(), connections.end());
  EXPECT_EQ(names(), before);
}

TEST(SuggestTest, KeepsToTheNodeTheNumberAndWhatIsWanted) {
  const Design frame = ShippedComponent("dining_table", "frame");
  const auto connections = ConnectionsOfAll(SomeDesigns());
  SuggestOptions options = Options();
  options.near = {"long apron 1"};
  for (const Suggestion& each : Suggest(frame, connections, ShippedSubTree, options)) {
    EXPECT_EQ(each.element, "long apron 1");
  }
  options = Options();
  options.count = 1;
  EXPECT_EQ(Suggest(frame, connections, ShippedSubTree, options).size(), 1U);
  const ComponentSource none = [](const std::string&, const std::string&) {
    return absl::StatusOr<const Assembly*>(absl::NotFoundError("costs too much"));
  };
  EXPECT_THAT(Suggest(frame, connections, none, Options()), IsEmpty());
}

// Only the first are tried; what cannot be connected goes, and what is held in part comes later.
TEST(SuggestTest, WhatWasTriedIsSaid) {
  using Outcome = SuggestionTrial::Outcome;
  const Design frame = ShippedComponent("dining_table", "frame");
  const auto connections = ConnectionsOfAll(SomeDesigns());
  const auto plain = Suggest(frame, connections, ShippedSubTree, Options());
  ASSERT_GE(plain.size(), 4U);
  for (const Suggestion& each : plain) EXPECT_EQ(each.trial.outcome, Outcome::kNotTried);
  SuggestOptions options = Options();
  options.most_tried = 3;
  int tried = 0;
  options.trial = [&](const Suggestion&) -> SuggestionTrial {
    constexpr Outcome kOutcomes[] = {Outcome::kFitsNot, Outcome::kHeldInPart, Outcome::kFits};
    return {kOutcomes[tried++], "why"};
  };
  const auto found = Suggest(frame, connections, ShippedSubTree, options);
  EXPECT_EQ(tried, 3);
  ASSERT_GE(found.size(), 3U);
  const auto place_of = [&](const Suggestion& of) {
    return std::find_if(found.begin(), found.end(),
                        [&](const Suggestion& each) {
                          return each.from == of.from && each.node == of.node &&
                                 each.element == of.element;
                        }) -
           found.begin();
  };
  EXPECT_EQ(place_of(plain[0]), static_cast<std::ptrdiff_t>(found.size()));
  ASSERT_LT(place_of(plain[1]), static_cast<std::ptrdiff_t>(found.size()));
  EXPECT_EQ(found[static_cast<std::size_t>(place_of(plain[1]))].score, plain[1].score / 2);
  EXPECT_EQ(found[static_cast<std::size_t>(place_of(plain[2]))].score, plain[2].score);
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LE(found[i].score, found[i - 1].score);
}

// What there is no time for is told of, and said not to be tried.
TEST(SuggestTest, TrialsEndWithTheTime) {
  using Outcome = SuggestionTrial::Outcome;
  const Design frame = ShippedComponent("dining_table", "frame");
  const auto connections = ConnectionsOfAll(SomeDesigns());
  SuggestOptions options = Options();
  int tried = 0;
  options.trial = [&](const Suggestion&) -> SuggestionTrial {
    ++tried;
    return {Outcome::kFits, ""};
  };
  const auto all = Suggest(frame, connections, ShippedSubTree, options);
  ASSERT_GE(all.size(), 4U);
  const int all_tried = std::exchange(tried, 0);
  options.has_time = [&] { return tried < 2; };
  const auto some = Suggest(frame, connections, ShippedSubTree, options);
  EXPECT_EQ(tried, 2);
  EXPECT_EQ(some.size(), all.size());
  const auto not_tried = [](const std::vector<Suggestion>& of) {
    return std::count_if(of.begin(), of.end(), [](const Suggestion& each) {
      return each.trial.outcome == Outcome::kNotTried;
    });
  };
  EXPECT_EQ(not_tried(some), static_cast<std::ptrdiff_t>(some.size()) - 2);
  // With time enough, as without a bound.
  options.has_time = [] { return true; };
  tried = 0;
  const auto again = Suggest(frame, connections, ShippedSubTree, options);
  EXPECT_EQ(tried, all_tried);
  ASSERT_EQ(again.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(again[i].node, all[i].node);
}

// Whoever asks has gone, or waits no longer: looking ends, and what was not looked at is no
// verdict.
TEST(SuggestTest, LookingEndsWithTheTime) {
  const Design frame = ShippedComponent("dining_table", "frame");
  const auto connections = ConnectionsOfAll(SomeDesigns());
  int asked_of = 0;
  const ComponentSource components = [&](const std::string& assembly, const std::string& node) {
    ++asked_of;
    return ShippedSubTree(assembly, node);
  };
  SuggestOptions options = Options();
  SearchExtent extent{true, 1};
  const auto all = Suggest(frame, connections, components, options, &extent);
  EXPECT_FALSE(extent.is_cut_short);
  EXPECT_EQ(extent.not_compared, 0);
  ASSERT_GE(all.size(), 4U);
  const int all_asked_of = std::exchange(asked_of, 0);
  int checks = 0;
  options.is_late = [&] { return ++checks > 3; };
  EXPECT_THAT(Suggest(frame, connections, components, options, &extent), IsEmpty());
  EXPECT_TRUE(extent.is_cut_short);
  EXPECT_EQ(asked_of, 0);
  EXPECT_LT(checks, 10) << "it went on";
  options.is_late = [&] { return asked_of > all_asked_of / 2; };
  const auto some = Suggest(frame, connections, components, options, &extent);
  EXPECT_TRUE(extent.is_cut_short);
  EXPECT_LE(asked_of, all_asked_of / 2 + 1);
  EXPECT_LT(some.size(), all.size());
  EXPECT_GT(extent.not_compared, 0);
  // The sooner it ends, the more is left.
  const std::int64_t left = extent.not_compared;
  options.is_late = [&] { return asked_of > 0; };
  asked_of = 0;
  EXPECT_THAT(Suggest(frame, connections, components, options, &extent), IsEmpty());
  EXPECT_GE(extent.not_compared, left);
}

std::vector<Eigen::Matrix3d> QuartersAboutTheVertical() {
  std::vector<Eigen::Matrix3d> turns;
  for (std::size_t quarters = 0; quarters < 4; ++quarters) {
    turns.push_back(TurnOf(std::vector<Axis>(quarters, Axis::kZ)));
  }
  return turns;
}

// A design of what ships, turned.
Original TurnedOriginal(const std::string& id, const std::vector<Axis>& turns) {
  Original original = ShippedOriginal(id);
  if (turns.empty()) return original;
  const Assembly turned = Turned(original.design.assembly->assembly(), TurnOf(turns));
  original.design = AsDrawn(turned).value();
  original.connections = std::make_shared<const std::vector<CollectionConnection>>(
      ConnectionsOf(original.source, turned).value());
  return original;
}

// A frame that stands along y: the top of one that stands along x goes on it when it is turned.
TEST(SuggestTest, WhatFitsOnlyTurnedIsTurned) {
  const Assembly drawn = ShippedComponent("dining_table", "frame").assembly->assembly();
  const auto connections = ConnectionsOfAll({"dining_table"});
  for (const std::vector<Axis>& turned :
       {std::vector<Axis>{Axis::kZ}, std::vector<Axis>(3, Axis::kZ)}) {
    ASSERT_OK_AND_ASSIGN(const Design frame, AsDrawn(Turned(drawn, TurnOf(turned))));
    SuggestOptions options = Options();
    options.trial = [&](const Suggestion& suggestion) {
      const Original original = TurnedOriginal("dining_table", suggestion.turns);
      Design dropped =
          AsDrawn(
              parametric::SubTreeOf(original.design.assembly->assembly(), suggestion.node).value())
              .value();
      const parametric::BoundingBox box = BoundsOf(dropped);
      dropped.shift += suggestion.position -
                       Eigen::Vector3d(box.center().x(), box.center().y(), box.minimum.z());
      EXPECT_LT((BoundsOf(dropped).size() - suggestion.size).norm(), 1e-9);
      return TryComponent(frame, dropped, suggestion.node, &original, AllShippedConnections(),
                          ShippedOptions());
    };
    EXPECT_THAT(Suggest(frame, connections, ShippedSubTree, options),
                Not(Contains(Field(&Suggestion::node, "top"))));
    options.turns = QuartersAboutTheVertical();
    const auto found = Suggest(frame, connections, ShippedSubTree, options);
    ASSERT_THAT(found, Not(IsEmpty()));
    EXPECT_EQ(found[0].node, "top");
    EXPECT_EQ(found[0].turns.size() % 2, 1U);
    EXPECT_EQ(found[0].distance, 0);
    EXPECT_EQ(found[0].held_by, 2);
    EXPECT_EQ(found[0].trial.outcome, SuggestionTrial::Outcome::kFits) << found[0].trial.text;
    const parametric::BoundingBox below = BoundsOf(frame);
    EXPECT_NEAR(found[0].position.z(), below.maximum.z(), 1e-9);
    EXPECT_LT((found[0].position - below.center()).head<2>().norm(), 1e-9);
  }
}

// What can be had as it is drawn is suggested so, and not four times.
TEST(SuggestTest, WhatFitsAsItIsDrawnIsNotTurned) {
  const Design frame = ShippedComponent("dining_table", "frame");
  const auto connections = ConnectionsOfAll({"dining_table"});
  SuggestOptions options = Options();
  const auto drawn = Suggest(frame, connections, ShippedSubTree, options);
  options.turns = QuartersAboutTheVertical();
  const auto found = Suggest(frame, connections, ShippedSubTree, options);
  ASSERT_THAT(found, Not(IsEmpty()));
  EXPECT_EQ(found[0].node, drawn[0].node);
  EXPECT_THAT(found[0].turns, IsEmpty());
  EXPECT_EQ(found[0].score, drawn[0].score);
  const auto in_its_place = std::count_if(found.begin(), found.end(), [&](const auto& each) {
    return each.node == found[0].node && (each.position - found[0].position).norm() < 0.01 &&
           (each.size - found[0].size).norm() < 0.01;
  });
  EXPECT_EQ(in_its_place, 1);
}

// However many turns and connections there are, the materials of two items are compared once.
TEST(SuggestTest, ComparesTheMaterialsOfTwoItemsOnce) {
  const Design frame = ShippedComponent("dining_table", "frame");
  SuggestOptions options = Options();
  options.turns = QuartersAboutTheVertical();
  std::set<std::pair<std::string, std::string>> compared;
  options.same_material = [&compared, same = Options().same_material](const std::string& item,
                                                                      const std::string& other) {
    EXPECT_TRUE(compared.emplace(item, other).second) << item << ", " << other;
    return same(item, other);
  };
  EXPECT_THAT(Suggest(frame, ConnectionsOfAll(SomeDesigns()), ShippedSubTree, options),
              Not(IsEmpty()));
}

// What is said to fit can be connected, and of all pairs none lacks a connection.
TEST(SuggestTest, WhatFitsCanBeConnected) {
  const auto all = AllShippedConnections();
  const auto dropped = [](const Suggestion& suggestion) {
    Design design = ShippedComponent(IdOf(suggestion.from->source), suggestion.node);
    const parametric::BoundingBox box = BoundsOf(design);
    design.shift =
        suggestion.position - Eigen::Vector3d(box.center().x(), box.center().y(), box.minimum.z());
    return design;
  };
  int fits = 0;
  for (const char* id : {"dining_table", "cabinet", "tool_cart"}) {
    SCOPED_TRACE(id);
    const Design body = ShippedComponent(id, std::string(id) == "cabinet" ? "case" : "frame");
    SuggestOptions options = Options();
    options.count = 4;
    options.most_tried = 4;
    options.trial = [&](const Suggestion& suggestion) {
      const Original original = ShippedOriginal(IdOf(suggestion.from->source));
      return TryComponent(body, dropped(suggestion), suggestion.node, &original, all,
                          ShippedOptions());
    };
    for (const Suggestion& each : Suggest(body, all, ShippedSubTree, options)) {
      if (each.trial.outcome != SuggestionTrial::Outcome::kFits) continue;
      ++fits;
      const Original original = ShippedOriginal(IdOf(each.from->source));
      ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped(each), &original.design, body));
      ASSERT_OK_AND_ASSIGN(const Connected made, Connect(body, snapped.component, each.node,
                                                         &original, all, ShippedOptions()));
      EXPECT_THAT(made.warnings, IsEmpty());
      EXPECT_TRUE(std::any_of(made.connections.begin(), made.connections.end(),
                              [](const auto& one) { return !one.parts.empty(); }));
    }
  }
  EXPECT_GE(fits, 3);
}

// A model that is a little larger than what the collection has gets it beside its own planes.
TEST(SuggestTest, WhatIsNearlyAsLargeIsPlacedByThePlanesThatMeet) {
  Design frame = ShippedComponent("dining_table", "frame");
  ASSERT_OK_AND_ASSIGN(const parametric::Adjustment wider,
                       frame.assembly->Adjust(frame.q, {{{"long apron 1", Axis::kX}, 1.44}},
                                              parametric::DemandPolicy::kStrict));
  frame.q = wider.q;
  const auto found = Suggest(frame, ConnectionsOfAll({"dining_table"}), ShippedSubTree, Options());
  ASSERT_THAT(found, Contains(Field(&Suggestion::node, "top")));
  for (const Suggestion& each : found) {
    if (each.node != "top") continue;
    // It lies on the frame.
    EXPECT_NEAR(each.position.z(), 0.712, 1e-9);
  }
}

}  // namespace
}  // namespace mortise::composer
