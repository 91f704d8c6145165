// Every template that ships has a plan a workshop can follow, at its defaults and elsewhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/templates/assembly_template.h"
#include "common/templates/template_codec.h"
#include "services/fabplanner/documents/plan_files.h"
#include "services/fabplanner/planning/bill_tree.h"
#include "services/fabplanner/planning/planning.h"
#include "services/fabplanner/service/design_codec.h"
#include "services/fabplanner/shop_floor/plan_codec.h"
#include "tests/unit/common/templates/shipped_collection.h"
#include "tests/unit/services/fabplanner/added_bill.h"
#include "tests/unit/services/fabplanner/board_corners.h"

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;

constexpr int kFurtherPoints = 3;

// A template that ships, ready for evaluation.
struct Shipped {
  v1::TemplateBundle bundle;
  std::shared_ptr<const templates::Template> compiled;
};

// As the catalog offers them: an assembly by itself where no template of its name ships.
std::vector<std::string> NamesOfAll() {
  std::vector<std::string> names;
  for (const v1::Template& message : templates::ShippedCollection().templates) {
    names.push_back(message.name());
  }
  for (const v1::Assembly& message : templates::ShippedCollection().assemblies) {
    const std::string exposed = "templates" + message.name().substr(message.name().find('/'));
    if (std::find(names.begin(), names.end(), exposed) == names.end()) {
      names.push_back(message.name());
    }
  }
  return names;
}

// "assemblies/cabinet:left drawer" is the sub-tree of a group.
Shipped Load(const std::string& name) {
  Shipped shipped;
  if (name.starts_with("assemblies/")) {
    const std::size_t colon = std::min(name.find(':'), name.size());
    shipped.bundle = templates::ShippedAssembly(name.substr(0, colon));
    if (colon < name.size()) {
      shipped.bundle.mutable_template_()->mutable_assembly()->set_group(name.substr(colon + 1));
    }
    EXPECT_EQ(templates::FillAndCheck(shipped.bundle, templates::Trial::kDefaults),
              absl::OkStatus());
  } else {
    shipped.bundle = templates::ShippedTemplate(name);
    const std::string& assembly = shipped.bundle.template_().assembly().assembly();
    if (!assembly.empty()) {
      *shipped.bundle.mutable_assembly() = templates::ShippedAssembly(assembly).assembly();
      EXPECT_EQ(templates::FillAndCheck(shipped.bundle, templates::Trial::kDefaults),
                absl::OkStatus());
    }
  }
  auto compiled = templates::Compile(shipped.bundle);
  EXPECT_TRUE(compiled.ok()) << compiled.status();
  if (compiled.ok()) shipped.compiled = *std::move(compiled);
  return shipped;
}

// The defaults, and points at which one parameter after the other is elsewhere.
std::vector<parametric::EvaluatedDesign> DesignsOf(const Shipped& shipped) {
  std::vector<parametric::EvaluatedDesign> designs;
  const std::vector<parametric::Parameter>& parameters = shipped.compiled->parameters();
  const Eigen::VectorXd defaults = parametric::Defaults(parameters);
  const auto first = shipped.compiled->Evaluate(defaults);
  EXPECT_TRUE(first.ok()) << first.status();
  if (!first.ok()) return designs;
  designs.push_back(*first);
  for (double fraction : {0.3, 0.75, 0.5, 0.1, 0.9}) {
    for (std::size_t i = 0; i < parameters.size() && designs.size() <= kFurtherPoints; ++i) {
      Eigen::VectorXd q = defaults;
      const double range = parameters[i].maximum - parameters[i].minimum;
      double& value = q[static_cast<Eigen::Index>(i)];
      value = parameters[i].minimum + fraction * range;
      if (parametric::IsWhole(parameters[i])) value = std::round(value);
      if (std::abs(value - parameters[i].default_value) < 0.01 * range) continue;
      // Not all parameters are free of each other.
      auto design = shipped.compiled->Evaluate(q);
      if (design.ok()) designs.push_back(*std::move(design));
    }
  }
  EXPECT_EQ(designs.size(), 1 + kFurtherPoints);
  return designs;
}

void ExpectEachPartOnce(const Design& design, const FabricationPlan& plan) {
  std::map<std::string, int> crosscut, outlined, added;
  for (const BoardLayout& board : plan.boards) {
    for (const BoardSegment& segment : board.segments) ++crosscut[segment.part];
  }
  for (const SheetLayout& sheet : plan.sheets) {
    for (const SheetPlacement& placement : sheet.placements) ++outlined[placement.part];
  }
  for (const AssemblyStep& step : plan.steps) {
    for (const std::string& part : step.added_parts) ++added[part];
    for (const std::string& part : step.connectors) ++added[part];
  }
  ASSERT_EQ(plan.parts.size(), design.parts.size());
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const PlannedPart& planned = plan.parts[i];
    EXPECT_EQ(planned.part, design.parts[i].name);
    EXPECT_EQ(crosscut[planned.part], planned.making == Making::kCrosscut ? 1 : 0) << planned.part;
    EXPECT_EQ(outlined[planned.part], planned.making == Making::kOutline ? 1 : 0) << planned.part;
    EXPECT_EQ(added[planned.part], 1) << planned.part;
    EXPECT_EQ(planned.drawings.empty(), !planned.to_shape) << planned.part;
  }
  EXPECT_EQ(added.size(), design.parts.size());
}

void ExpectBoardsHold(const FabricationPlan& plan) {
  for (const BoardLayout& board : plan.boards) {
    const Eigen::Vector2d section(board.width, board.thickness);
    const BoardSegment* before = nullptr;
    for (const BoardSegment& segment : board.segments) {
      const Corners corners = CornersOf(segment.ends, segment.start, segment.length, section);
      EXPECT_GE(corners.First(), plan.rules.board_trim - kRounding) << segment.part;
      EXPECT_LE(corners.Last(), board.stock_length - plan.rules.board_trim + kRounding)
          << segment.part;
      if (before != nullptr) {
        EXPECT_TRUE(ArePartedBySaw(CornersOf(before->ends, before->start, before->length, section),
                                   before->ends, corners, segment.ends, plan.rules.kerf))
            << segment.part;
      }
      before = &segment;
    }
    EXPECT_GE(board.offcut, 0) << board.label;
  }
}

void ExpectHolesOnTheirParts(const Design& design, const FabricationPlan& plan) {
  std::map<std::string, Eigen::AlignedBox3d> boxes;
  for (const Part& part : design.parts) boxes[part.name] = BoundsOf(part);
  for (const Hole& hole : plan.holes) {
    ASSERT_TRUE(boxes.contains(hole.part)) << hole.part;
    const Eigen::AlignedBox3d& box = boxes[hole.part];
    const Eigen::Vector3d end = hole.position + hole.depth * hole.direction;
    EXPECT_LT(box.exteriorDistance(hole.position), 1e-6) << hole.part << " " << hole.connector;
    EXPECT_LT(box.exteriorDistance(end), 1e-6) << hole.part << " " << hole.connector;
    EXPECT_GT(hole.depth, 0);
    EXPECT_GT(hole.diameter, 0);
    // What is not meant to come out leaves something at the far side.
    int axis = 0;
    hole.direction.cwiseAbs().maxCoeff(&axis);
    const double left = std::min(end[axis] - box.min()[axis], box.max()[axis] - end[axis]);
    EXPECT_TRUE(hole.through || left > 1e-5) << hole.part << " " << hole.connector;
  }
}

// What is bought by the piece is counted as often as it is there; stock as often as it is laid out.
void ExpectBillCounts(const Design& design, const Items& items, const FabricationPlan& plan) {
  std::map<std::string, double> wanted, billed;
  double drawn = 0, billed_drawn = 0;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    if (plan.parts[i].making == Making::kBought) ++wanted[design.parts[i].item];
    if (plan.parts[i].making == Making::kToDrawing) ++drawn;
  }
  for (const Peg& peg : design.pegs) ++wanted[peg.item];
  for (const BoardLayout& board : plan.boards) {
    if (!items.at(board.item).ripped) ++wanted[board.item];
  }
  for (const SheetLayout& sheet : plan.sheets) ++wanted[sheet.item];
  for (const BillLine& line : plan.bill.lines) {
    if (line.item.empty()) {
      billed_drawn += line.quantity;
      EXPECT_GT(line.mass, 0) << line.title;
      EXPECT_FALSE(line.drawings.empty()) << line.title;
      continue;
    }
    EXPECT_GT(line.price.amount, 0) << line.item;
    if (!items.at(line.item).ripped) billed[line.item] += line.quantity;
  }
  EXPECT_EQ(wanted, billed);
  EXPECT_EQ(drawn, billed_drawn);
}

// Boxes that come in pass through no box that stands, judged without the planner's own code.
void ExpectFreeWays(const Design& design, const FabricationPlan& plan) {
  std::map<std::string, const Part*> parts;
  for (const Part& part : design.parts) parts[part.name] = &part;
  for (const AssemblyStep& step : plan.steps) {
    std::vector<std::string> standing = step.standing;
    for (const AssemblyStep::Move& move : step.moves) {
      for (const std::string& name : move.parts) {
        const Part& mover = *parts.at(name);
        if (mover.connecting || !IsBox(mover) || move.way_in.isZero()) continue;
        for (const std::string& other_name : standing) {
          const Part& other = *parts.at(other_name);
          if (other.connecting || !IsBox(other)) continue;
          Eigen::AlignedBox3d swept = BoundsOf(mover);
          const Eigen::AlignedBox3d there = swept.intersection(BoundsOf(other));
          if (!there.isEmpty() && there.sizes().minCoeff() > 6e-4) {
            continue;  // joined in each other
          }
          swept.extend((swept.min() - 100 * move.way_in).eval());
          const Eigen::AlignedBox3d hit = swept.intersection(BoundsOf(other));
          EXPECT_TRUE(hit.isEmpty() || hit.sizes().minCoeff() < 6e-4)
              << name << " passes through " << other_name << " in step " << step.number;
        }
      }
      standing.insert(standing.end(), move.parts.begin(), move.parts.end());
    }
  }
}

// Keeps the files where a person wants to look at them.
void KeepFiles(const std::string& name, const FabricationPlan& plan, const Design& design,
               const Items& items) {
  const char* folder = std::getenv("MORTISE_KEEP_PLANS");
  if (folder == nullptr) return;
  const auto files = MakePlanFiles(plan, design, items, {name}, [](int, int) { return true; });
  ASSERT_TRUE(files.ok()) << files.status();
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  std::filesystem::create_directories(path);
  for (const PlanFile& file : *files) std::ofstream(path / file.file_name) << file.bytes;
}

class ShippedPlansTest : public ::testing::TestWithParam<std::string> {};

// The plan of a design, checked; its files are kept under `name` if that is not empty.
v1::Plan CheckedPlan(const Shipped& shipped, const parametric::EvaluatedDesign& evaluated,
                     const Items& items, const std::string& name) {
  auto design = DesignFrom(parametric::ToProto(evaluated));
  EXPECT_TRUE(design.ok()) << design.status();
  if (!design.ok()) return {};
  AddDrawing(shipped.bundle.assembly(), &*design);
  auto plan = MakePlan(*design, items, 1);
  EXPECT_TRUE(plan.ok()) << plan.status();
  if (!plan.ok()) return {};
  plan->bill_tree = MakeBillTree(*plan, *design, items, {.template_name = "templates/shipped"});
  ExpectTreeAddsUp(*plan, name);
  ExpectEachPartOnce(*design, *plan);
  ExpectBoardsHold(*plan);
  ExpectHolesOnTheirParts(*design, *plan);
  ExpectBillCounts(*design, items, *plan);
  ExpectFreeWays(*design, *plan);
  for (const AssemblyStep& step : plan->steps) {
    EXPECT_THAT(step.instruction, Not(HasSubstr("No straight movement"))) << step.number;
    EXPECT_FALSE(step.instruction.empty()) << step.number;
  }
  v1::Plan message = ToProto(*plan, *design);
  EXPECT_EQ(message.parts_size(), static_cast<int>(design->parts.size()));
  const FabricationPlan read = CuttingPlanFrom(message);
  EXPECT_EQ(CutsFor(read).size(), CutsFor(*plan).size());
  ExpectBoardsHold(read);
  if (!name.empty()) KeepFiles(name, *plan, *design, items);
  return message;
}

TEST_P(ShippedPlansTest, HasAPlanThatCanBeFollowed) {
  const Shipped shipped = Load(GetParam());
  ASSERT_NE(shipped.compiled, nullptr);
  const auto items = ItemsFrom(shipped.bundle);
  ASSERT_TRUE(items.ok()) << items.status();
  std::string name = GetParam().substr(GetParam().find('/') + 1);
  for (const parametric::EvaluatedDesign& evaluated : DesignsOf(shipped)) {
    CheckedPlan(shipped, evaluated, *items, name);
    name.clear();
  }
}

// Its expert has the shelves fastened to one side after the other, and the back come last.
TEST(ShippedBookshelf, FollowsItsPriorities) {
  Shipped bookshelf = Load("assemblies/bookshelf");
  ASSERT_NE(bookshelf.compiled, nullptr);
  const auto items = ItemsFrom(bookshelf.bundle);
  ASSERT_TRUE(items.ok()) << items.status();
  const auto design =
      bookshelf.compiled->Evaluate(parametric::Defaults(bookshelf.compiled->parameters()));
  ASSERT_TRUE(design.ok()) << design.status();
  const v1::Plan plan = CheckedPlan(bookshelf, *design, *items, "");
  int latest = 0;
  for (const v1::AssemblyStep& step : plan.steps()) {
    if (step.priority() == 0) continue;
    EXPECT_GE(step.priority(), latest) << step.number();
    latest = step.priority();
  }
  ASSERT_GT(plan.steps_size(), 2);
  const v1::AssemblyStep& last = plan.steps(plan.steps_size() - 1);
  EXPECT_EQ(last.priority(), 3);
  EXPECT_THAT(last.added_parts(), ::testing::Contains("back"));
  // Without them it would begin with the largest.
  for (v1::AssemblyPart& part : *bookshelf.bundle.mutable_assembly()->mutable_parts()) {
    part.clear_priority();
  }
  const v1::Plan by_shapes = CheckedPlan(bookshelf, *design, *items, "");
  ASSERT_GT(by_shapes.steps_size(), 0);
  EXPECT_THAT(by_shapes.steps(0).added_parts(), ::testing::Contains("back"));
}

// Table 8.2 of the thesis: without armrests two parts less from the chop saw, and a step.
TEST(ShippedArmchair, HasAStepLessWithoutArmrests) {
  const Shipped armchair = Load("templates/armchair");
  ASSERT_NE(armchair.compiled, nullptr);
  const auto items = ItemsFrom(armchair.bundle);
  ASSERT_TRUE(items.ok()) << items.status();
  for (const std::string arms : {"none", "both"}) {
    for (const std::string wood : {"spruce", "beech"}) {
      const auto q = parametric::CompleteParameters(armchair.compiled->parameters(),
                                                    {{"armrests", 0, arms}, {"wood", 0, wood}});
      ASSERT_TRUE(q.ok()) << q.status();
      const auto design = armchair.compiled->Evaluate(*q);
      ASSERT_TRUE(design.ok()) << design.status();
      const v1::Plan plan =
          CheckedPlan(armchair, *design, *items, absl::StrCat("armchair-", arms, "-", wood));
      const bool has_arms = arms == "both";
      EXPECT_EQ(plan.jigsaw_parts(), 4);
      EXPECT_EQ(plan.chop_saw_parts(), has_arms ? 10 : 8);
      EXPECT_EQ(plan.pegs(), has_arms ? 64 : 48);
      EXPECT_EQ(plan.steps_size(), has_arms ? 5 : 4);
      for (const v1::PlannedPart& part : plan.parts()) {
        EXPECT_THAT(part.item(), HasSubstr(wood)) << part.name();
      }
    }
  }
}

// Table 8.2 of the thesis: size changes the number of pegs, and the slabs of the back that of the
// parts from the chop saw, of which there are as many as the thesis counts.
TEST(ShippedShed, HasThePartsAndStepsOfTheThesis) {
  const Shipped shed = Load("templates/shed");
  ASSERT_NE(shed.compiled, nullptr);
  const auto items = ItemsFrom(shed.bundle);
  ASSERT_TRUE(items.ok()) << items.status();
  const auto plan_at = [&](const std::vector<parametric::NamedValue>& values) {
    const auto q = parametric::CompleteParameters(shed.compiled->parameters(), values);
    EXPECT_TRUE(q.ok()) << q.status();
    const auto design = shed.compiled->Evaluate(*q);
    EXPECT_TRUE(design.ok()) << design.status();
    return design.ok() ? CheckedPlan(shed, *design, *items, "") : v1::Plan();
  };
  const v1::Plan small = plan_at({{"width", 1.2}, {"depth", 1}, {"height", 1.4}});
  const v1::Plan large =
      plan_at({{"width", 1.98}, {"depth", 2.4}, {"height", 2.18}, {"door_width", 0.75}});
  const v1::Plan of_many_slabs = plan_at({{"slabs", 23}});
  const v1::Plan bare = plan_at({{"shelving", 0, "none"}, {"door", 0, "right"}});
  for (const v1::Plan* const plan : {&small, &large, &of_many_slabs}) {
    EXPECT_EQ(plan->jigsaw_parts(), 16);
    EXPECT_EQ(plan->steps_size(), 9);
    EXPECT_EQ(plan->chop_saw_parts(), plan == &of_many_slabs ? 37 : 25);
  }
  EXPECT_EQ(large.pegs(), 1333);
  EXPECT_LT(small.pegs(), 900);
  EXPECT_EQ(bare.steps_size(), 8);
  EXPECT_EQ(bare.jigsaw_parts(), 12);
}

std::string TestName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '/' || c == '-' || c == ':' || c == ' '; },
      '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedPlansTest, ::testing::ValuesIn(NamesOfAll()), TestName);

INSTANTIATE_TEST_SUITE_P(SubTrees, ShippedPlansTest,
                         ::testing::Values("assemblies/cabinet:left drawer",
                                           "assemblies/bed:headboard"),
                         TestName);

}  // namespace
}  // namespace mortise::fabplanner
