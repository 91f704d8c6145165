// Assemblies behind their one door: what can be asked of them, and what becomes of it.
#include "common/assembly/parametric_assembly.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "common/base/errors.h"
#include "tests/unit/common/assembly/bookcase.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

// A board on two posts: the posts under its ends, all as deep as each other.
Assembly Bench() {
  Assembly bench;
  bench.name = "bench";
  bench.groups = {{"bench", -1}};
  bench.parts = {ResizablePart("seat", {0, 0, 0.4}, {1.0, 0.3, 0.45}),
                 ResizablePart("left", {0, 0, 0}, {0.05, 0.3, 0.4}),
                 ResizablePart("right", {0.95, 0, 0}, {1.0, 0.3, 0.4})};
  return bench;
}

ParametricAssembly Parametrized(Assembly assembly) {
  auto made = ParametricAssembly::Create(std::move(assembly));
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

double LengthOf(const std::vector<PlacedPart>& parts, const std::string& name, Axis axis) {
  for (const PlacedPart& part : parts) {
    if (part.name == name) return part.box.size()[static_cast<int>(axis)];
  }
  ADD_FAILURE() << "no part " << name;
  return 0;
}

// One of these was seen to end the process by an assertion of the solver of linear programmes.
TEST(ParametricAssembly, IsMadeOfBookcasesOfAnySize) {
  for (const auto& [columns, shelves] : {std::pair(12, 8), std::pair(10, 8), std::pair(8, 5)}) {
    const auto made = ParametricAssembly::Create(Bookcase(columns, shelves));
    EXPECT_TRUE(made.ok()) << columns << " x " << shelves << ": " << made.status();
  }
}

TEST(ParametricAssembly, MeetsWhatCanBeMet) {
  const ParametricAssembly bench = Parametrized(Bench());
  for (const DemandPolicy policy : {DemandPolicy::kNearest, DemandPolicy::kStrict}) {
    const auto wider =
        bench.Adjust(bench.drawn(), {{{"seat", Axis::kX}, 1.4}, {{"left", Axis::kZ}, 0.5}}, policy);
    ASSERT_TRUE(wider.ok()) << wider.status();
    EXPECT_NEAR(wider->reached[0], 1.4, 1e-9);
    EXPECT_NEAR(wider->reached[1], 0.5, 1e-9);
    EXPECT_TRUE(bench.feasible_set().Violations(wider->q, 1e-9).empty());
    const std::vector<PlacedPart> parts = bench.PartsAt(wider->q);
    EXPECT_NEAR(LengthOf(parts, "right", Axis::kZ), 0.5, 1e-9) << "both posts reach the seat";
    EXPECT_NEAR(LengthOf(parts, "seat", Axis::kX), 1.4, 1e-9);
    for (const PlacedPart& part : parts) {
      if (part.name == "seat") continue;
      EXPECT_NEAR(part.box.minimum.z(), 0, 1e-9) << "it stays on the floor";
    }
  }
}

// What need not change does not: not by a hair, and least of all thicknesses.
TEST(ParametricAssembly, ChangesNoSizeThatCanStay) {
  const ParametricAssembly bench = Parametrized(Bench());
  const std::vector<PlacedPart> drawn = bench.PartsAt(bench.drawn());
  const auto lower =
      bench.Adjust(bench.drawn(), {{{"left", Axis::kZ}, 0.3}}, DemandPolicy::kStrict);
  ASSERT_TRUE(lower.ok()) << lower.status();
  for (const PlacedPart& part : bench.PartsAt(lower->q)) {
    for (const Axis axis : kAxes) {
      const bool is_leg = part.name != "seat" && axis == Axis::kZ;
      EXPECT_NEAR(LengthOf({part}, part.name, axis),
                  is_leg ? 0.3 : LengthOf(drawn, part.name, axis), 1e-9)
          << part.name << " " << AxisName(axis);
    }
  }
  const auto longer =
      bench.Adjust(bench.drawn(), {{{"seat", Axis::kX}, 1.3}}, DemandPolicy::kStrict);
  ASSERT_TRUE(longer.ok()) << longer.status();
  for (const char* post : {"left", "right"}) {
    EXPECT_NEAR(LengthOf(bench.PartsAt(longer->q), post, Axis::kX), 0.05, 1e-9) << post;
  }
}

// Templates of assemblies are searched by methods that follow slopes: a small step of what is asked
// for is a small step of the design.
TEST(ParametricAssembly, MeetsDemandsContinuously) {
  for (const Assembly& assembly : {Bench(), TwoLeggedTable(), ChestWithLid()}) {
    const ParametricAssembly design = Parametrized(assembly);
    const auto sizes = design.AdjustableSizes();
    ASSERT_TRUE(sizes.ok()) << sizes.status();
    for (const MeasureRange& range : *sizes) {
      constexpr int kSteps = 400;
      const double step = (range.maximum - range.minimum) / kSteps;
      Eigen::VectorXd before;
      for (int i = 0; i <= kSteps; ++i) {
        const double value = std::min(range.minimum + i * step, range.maximum);
        const auto met = design.Meet({{range.measure, value}});
        ASSERT_TRUE(met.ok()) << met.status() << range.measure.element << value;
        EXPECT_NEAR(met->reached[0], value, 1e-9);
        EXPECT_TRUE(design.feasible_set().Violations(met->q, 1e-8).empty());
        if (i > 0) {
          EXPECT_LT((met->q - before).norm(), 40 * step + 1e-9) << range.measure.element;
        }
        before = met->q;
      }
    }
  }
}

// As far as it goes, to the last digit, whichever of them is asked for first.
TEST(ParametricAssembly, ComesToTheVeryEnd) {
  const ParametricAssembly bench = Parametrized(Bench());
  for (const double asked : {100.0, -1.0}) {
    const auto end =
        bench.Adjust(bench.drawn(), {{{"seat", Axis::kZ}, asked}, {{"left", Axis::kZ}, asked}},
                     DemandPolicy::kNearest);
    ASSERT_TRUE(end.ok()) << end.status();
    for (std::size_t i = 0; i < 2; ++i) {
      const auto range = bench.RangeOf({i == 0 ? "seat" : "left", Axis::kZ});
      ASSERT_TRUE(range.ok()) << range.status();
      EXPECT_NEAR(end->reached[i], asked > 0 ? range->maximum : range->minimum, 1e-10);
    }
    EXPECT_TRUE(bench.feasible_set().Violations(end->q, 1e-9).empty());
  }
}

TEST(ParametricAssembly, NamesWhatCannotHoldTogether) {
  const ParametricAssembly bench = Parametrized(Bench());
  const auto refused =
      bench.Adjust(bench.drawn(), {{{"left", Axis::kZ}, 0.5}, {{"right", Axis::kZ}, 0.3}},
                   DemandPolicy::kStrict);
  EXPECT_EQ(DetailOf(refused.status()).reason, "DEMANDS_CONFLICT");
  for (const char* part : {"'left'", "'right'"}) {
    EXPECT_NE(refused.status().message().find(part), absl::string_view::npos) << refused.status();
  }
  EXPECT_NE(refused.status().message().find("'left' and 'right' equal in z size"),
            absl::string_view::npos)
      << refused.status();
}

// A size that the item fixes, and one that another follows, are told by the relationship's name.
TEST(ParametricAssembly, NamesTheEqualitiesThatStandAgainstADemand) {
  Assembly drawn = TwoLeggedTable();
  drawn.parts[0].limits[2] = {0.04, 0.04};
  const ParametricAssembly table = Parametrized(drawn);
  const auto refusal = [&](std::vector<MeasureDemand> demands) {
    const auto refused = table.Adjust(table.drawn(), demands, DemandPolicy::kStrict);
    EXPECT_EQ(DetailOf(refused.status()).reason, "DEMANDS_CONFLICT");
    return std::string(refused.status().message());
  };
  EXPECT_NE(refusal({{{"top", Axis::kZ}, 0.05}}).find("'top' z size fixed at 0.04 m"),
            std::string::npos);
  const std::string uneven = refusal({{{"leg 1", Axis::kX}, 0.08}, {{"leg 2", Axis::kX}, 0.07}});
  EXPECT_NE(uneven.find("'leg 1' and 'leg 2' equal in x size"), std::string::npos) << uneven;
  EXPECT_EQ(uneven.find("z minimum"), std::string::npos) << "and nothing superfluous: " << uneven;
}

TEST(ParametricAssembly, ComesAsNearAsItCanTheFirstDemandsFirst) {
  const ParametricAssembly bench = Parametrized(Bench());
  const auto both =
      bench.Adjust(bench.drawn(), {{{"left", Axis::kZ}, 0.5}, {{"right", Axis::kZ}, 0.3}},
                   DemandPolicy::kNearest);
  ASSERT_TRUE(both.ok()) << both.status();
  EXPECT_NEAR(both->reached[0], 0.5, 1e-7);
  EXPECT_NEAR(both->reached[1], 0.5, 1e-7) << "the posts stay alike";

  const auto range = bench.RangeOf({"seat", Axis::kX});
  ASSERT_TRUE(range.ok()) << range.status();
  for (const double asked : {-1.0, 100.0}) {
    const auto clamped =
        bench.Adjust(bench.drawn(), {{{"seat", Axis::kX}, asked}}, DemandPolicy::kNearest);
    ASSERT_TRUE(clamped.ok()) << clamped.status();
    EXPECT_NEAR(clamped->reached[0], asked < 0 ? range->minimum : range->maximum, 1e-7);
    EXPECT_TRUE(bench.feasible_set().Violations(clamped->q, 1e-9).empty());
  }
}

// Ends of ranges can be reached, what lies beyond cannot, and all that is between can.
TEST(ParametricAssembly, RangesAreExact) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    auto made = ParametricAssembly::Create(RandomAssembly(seed));
    if (!made.ok()) {
      EXPECT_EQ(DetailOf(made.status()).reason, "FEASIBLE_SET_UNBOUNDED") << made.status();
      continue;
    }
    const auto sizes = made->AdjustableSizes();
    ASSERT_TRUE(sizes.ok()) << sizes.status();
    for (const MeasureRange& range : *sizes) {
      EXPECT_LE(range.minimum, range.drawn + 1e-9);
      EXPECT_GE(range.maximum, range.drawn - 1e-9);
      const auto can_be = [&](double value) {
        return made->Adjust(made->drawn(), {{range.measure, value}}, DemandPolicy::kStrict).ok();
      };
      EXPECT_TRUE(can_be(range.minimum + 1e-7));
      EXPECT_TRUE(can_be(range.maximum - 1e-7));
      EXPECT_TRUE(can_be((range.minimum + range.maximum) / 2));
      EXPECT_FALSE(can_be(range.minimum - 1e-6));
      EXPECT_FALSE(can_be(range.maximum + 1e-6));
    }
  }
}

// Posts as deep as a seat that its item fixes cannot change, though theirs leaves them open.
TEST(ParametricAssembly, TellsWhichSizesTheDesignHolds) {
  EXPECT_TRUE(Parametrized(Bench()).HeldSizes().empty());
  Assembly bench = Bench();
  bench.parts[0].limits[1] = {0.3, 0.3};
  std::vector<std::string> held;
  for (const Measure& measure : Parametrized(bench).HeldSizes()) {
    held.push_back(measure.element + " " + AxisName(measure.axis));
  }
  EXPECT_EQ(held, (std::vector<std::string>{"left y", "right y"}));
}

TEST(ParametricAssembly, StartsFromWhereTheDesignerIs) {
  const ParametricAssembly bench = Parametrized(Bench());
  const auto wide = bench.Adjust(bench.drawn(), {{{"seat", Axis::kX}, 1.4}}, DemandPolicy::kStrict);
  ASSERT_TRUE(wide.ok()) << wide.status();
  const auto high = bench.Adjust(wide->q, {{{"left", Axis::kZ}, 0.5}}, DemandPolicy::kStrict);
  ASSERT_TRUE(high.ok()) << high.status();
  EXPECT_NEAR(LengthOf(bench.PartsAt(high->q), "seat", Axis::kX), 1.4, 1e-9);
  EXPECT_LT((bench.Adjust(wide->q, {}, DemandPolicy::kStrict)->q - wide->q).norm(), 1e-12);
}

TEST(ParametricAssembly, CountsDegreesOfFreedomByGroup) {
  const ParametricAssembly chest = Parametrized(ChestWithLid());
  for (std::size_t group = 0; group < chest.assembly().groups.size(); ++group) {
    const auto degrees = chest.DegreesOfFreedom(static_cast<int>(group));
    ASSERT_TRUE(degrees.ok()) << degrees.status();
    EXPECT_GE(*degrees, 3) << "it can stand anywhere";
  }
  EXPECT_EQ(*chest.DegreesOfFreedom(0), chest.feasible_set().degrees_of_freedom() + 3)
      << "without being held in place";
}

TEST(ParametricAssembly, TellsWhichElementNothingHolds) {
  Assembly loose = Bench();
  loose.parts.push_back(ResizablePart("lamp", {0.4, 0.1, 2.0}, {0.5, 0.2, 2.1}));
  const auto made = ParametricAssembly::Create(std::move(loose));
  EXPECT_EQ(DetailOf(made.status()).reason, "FEASIBLE_SET_UNBOUNDED");
  EXPECT_NE(made.status().message().find("'lamp' can move along z"), absl::string_view::npos)
      << made.status();
}

TEST(ParametricAssembly, TellsOfAllElementsThatNothingHolds) {
  Assembly loose = Bench();
  loose.parts.push_back(ResizablePart("lamp", {0.4, 0.1, 2.0}, {0.5, 0.2, 2.1}));
  loose.parts.push_back(ResizablePart("shade", {3.4, 5.1, 3.0}, {3.5, 5.2, 3.1}));
  const auto made = ParametricAssembly::Create(std::move(loose));
  EXPECT_EQ(DetailOf(made.status()).reason, "FEASIBLE_SET_UNBOUNDED");
  for (const char* named : {"'lamp' can move along ", "'shade' can move along ", "holds them"}) {
    EXPECT_NE(made.status().message().find(named), absl::string_view::npos) << made.status();
  }
  for (const char* held : {"'seat'", "'left'"}) {
    EXPECT_EQ(made.status().message().find(held), absl::string_view::npos) << made.status();
  }
}

TEST(ParametricAssembly, NamesBadInput) {
  const ParametricAssembly bench = Parametrized(Bench());
  const auto field = [&](const Eigen::VectorXd& from, const MeasureDemand& demand) {
    return DetailOf(bench.Adjust(from, {demand}, DemandPolicy::kNearest).status()).field;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field(bench.drawn(), {{"lid", Axis::kX}, 1}), "demands[0].measure.element");
  EXPECT_EQ(field(bench.drawn(), {{"seat", Axis::kX}, kNaN}), "demands[0].value");
  EXPECT_EQ(field(bench.drawn(), {{"seat", Axis::kX}, 1e308}), "demands[0].value");
  EXPECT_EQ(field(bench.drawn(), {{"seat", Axis::kX}, -1e308}), "demands[0].value");
  EXPECT_EQ(field(bench.drawn().head(3), {{"seat", Axis::kX}, 1}), "from");
  EXPECT_EQ(field(bench.drawn() * kNaN, {{"seat", Axis::kX}, 1}), "from");
  EXPECT_EQ(DetailOf(bench.RangeOf({"lid", Axis::kX}).status()).field, "measure.element");
}

// One request must not ask for more parts than memory holds.
TEST(ParametricAssembly, RefusesParametersBeyondAllMeasure) {
  Assembly field;
  field.name = "field";
  field.groups = {{"field", -1}};
  field.parts.push_back(ResizablePart("board", {0, 0, -0.02}, {0.25, 0.25, 0}));
  for (int i = 0; i < 9; ++i) {
    const Eigen::Vector3d low(0.1 * (i % 3), 0.1 * (i / 3), 0);
    field.parts.push_back(FixedPart("peg " + std::to_string(i), low, low.array() + 0.05));
  }
  const ParametricAssembly made = Parametrized(field);
  ASSERT_EQ(made.elements().size(), 2U);
  ASSERT_EQ(made.elements()[0].name, "peg 0");
  const auto field_of = [&](int variable, double value) {
    Eigen::VectorXd q = made.drawn();
    q[variable] = value;
    EXPECT_EQ(made.CheckParameters(q).ok(), made.FaultsAt(q).ok());
    return DetailOf(made.CheckParameters(q)).field;
  };
  EXPECT_EQ(field_of(SizeVariable(0, Axis::kX), 0.45), "");
  EXPECT_EQ(field_of(SizeVariable(0, Axis::kX), 3000), "q");
  EXPECT_EQ(field_of(SizeVariable(0, Axis::kX), 1e300), "q");
  EXPECT_EQ(field_of(CenterVariable(1, Axis::kX), 1e20), "q");
}

// Contact is between parts: a post between two slats of a row touches neither.
TEST(ParametricAssembly, ContactsAreOfPartsNotOfTheBoxAroundThem) {
  Assembly fence;
  fence.name = "fence";
  fence.groups = {{"fence", -1}};
  for (int i = 0; i < 4; ++i) {
    fence.parts.push_back(
        ResizablePart("slat " + std::to_string(i), {0.2 * i, 0, 0}, {0.2 * i + 0.05, 0.02, 1}));
  }
  fence.parts.push_back(ResizablePart("post", {0.1, 0, 0}, {0.15, 0.02, 1.5}));
  fence.parts.push_back(ResizablePart("rail", {0, 0.02, 0.4}, {0.65, 0.04, 0.5}));
  const auto elements = MakeElements(fence, 1e-6);
  const auto contacts = FindContacts(fence, elements, 1e-6);
  ASSERT_TRUE(contacts.ok()) << contacts.status();
  std::vector<std::string> names;
  for (const auto& [a, b] : *contacts) names.push_back(elements[a].name + "-" + elements[b].name);
  EXPECT_EQ(names, (std::vector<std::string>{"slat 1-rail", "slat 0-rail", "post-rail"}));
}

}  // namespace
}  // namespace mortise::parametric
