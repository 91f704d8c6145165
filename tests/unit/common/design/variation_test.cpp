// What templates choose, leave out and repeat: designs with absent parts are those of templates
// without them, copies are parts written out, structures tell all of it, gradients hold.
#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/design/contact.h"
#include "common/design/evaluation.h"
#include "common/design/parameter_values.h"
#include "common/design/template_validation.h"
#include "common/files/template_codec.h"
#include "tests/unit/common/design/varied_designs.h"
#include "tests/unit/common/design/varied_shelf.h"

namespace mortise::parametric {
namespace {

using Eigen::VectorXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

VectorXd RandomPoint(const std::vector<Parameter>& parameters, std::mt19937& random) {
  VectorXd q(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Parameter& parameter = parameters[static_cast<std::size_t>(i)];
    q(i) = std::uniform_real_distribution<double>(parameter.minimum, parameter.maximum)(random);
    if (IsWhole(parameter)) q(i) = std::round(q(i));
  }
  return q;
}

// What two designs are but for how they came about.
std::string ContentOf(EvaluatedDesign design) {
  v1::EvaluatedDesign message = ToProto(design);
  message.clear_structure();
  message.clear_template_digest();
  return message.SerializeAsString();
}

// ---- Templates at random: boxes beside each other, each there where its condition holds
// ----------

struct RandomTemplate {
  TemplateBundle bundle;
  // Whether the box of this index, and the pegs and the load of it, are there.
  std::vector<bool> PresentAt(const VectorXd& q) const {
    std::vector<bool> present;
    for (const int kind : kinds) {
      present.push_back(kind == 0   ? true
                        : kind == 1 ? q(1) == 1
                        : kind == 2 ? q(1) != 2
                                    : q(0) > 0.5);
    }
    return present;
  }
  std::vector<int> kinds;
};

RandomTemplate RandomBoxes(std::mt19937& random) {
  static const std::vector<std::string> kConditions = {"", "style == 'b'", "not style == 'c'",
                                                       "size > 0.5"};
  RandomTemplate made;
  made.bundle = VariedShelf();
  TemplateDefinition& definition = made.bundle.definition;
  definition.parameters = {Number("size", "m", 0.2, 0.8, 0.4), Choice("style", {"a", "b", "c"})};
  definition.parts.clear();
  definition.connections.clear();
  definition.boundary_conditions.clear();
  const int count = 2 + static_cast<int>(random() % 6);
  for (int i = 0; i < count; ++i) {
    made.kinds.push_back(i == 0 ? 0 : static_cast<int>(random() % 4));
    const std::string& condition = kConditions[static_cast<std::size_t>(made.kinds.back())];
    PartTemplate part = BoxPart(absl::StrCat("box", i),
                                {absl::StrCat(i, " * size"), absl::StrCat(i + 1, " * size")},
                                {"0", "0.1"}, {"0", "0.2 + size / 4"});
    part.present = condition;
    definition.parts.push_back(part);
    BoundaryCondition load = {absl::StrCat("load", i),
                              BoundaryConditionKind::kForce,
                              part.name,
                              "z_max",
                              {"0", "0", "-size"},
                              ""};
    load.present = condition;
    definition.boundary_conditions.push_back(load);
    if (i == 0) continue;
    Connection pegs = Pegs(absl::StrCat("pegs", i), part.name, "x_min", absl::StrCat("box", i - 1));
    for (const int one : {i - 1, i}) {
      const std::string& of = kConditions[static_cast<std::size_t>(made.kinds[one])];
      if (of.empty()) continue;
      absl::StrAppend(&pegs.present, pegs.present.empty() ? "" : " and ", of);
    }
    definition.connections.push_back(pegs);
  }
  return made;
}

TEST(Variation, AbsentPartsAreThoseOfATemplateWithoutThem) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 60; ++trial) {
    const RandomTemplate made = RandomBoxes(random);
    const TemplateFunction function = FunctionOf(made.bundle);
    const VectorXd q = RandomPoint(function.parameters(), random);
    const std::vector<bool> present = made.PresentAt(q);
    TemplateBundle without = made.bundle;
    TemplateDefinition& left = without.definition;
    const auto is_absent = [&](const std::string& name) {
      return !present[static_cast<std::size_t>(name.back() - '0')];
    };
    std::erase_if(left.parts, [&](const PartTemplate& part) { return is_absent(part.name); });
    std::erase_if(left.connections, [&](const Connection& pegs) {
      return is_absent(pegs.part) || is_absent(pegs.other_part);
    });
    std::erase_if(left.boundary_conditions,
                  [&](const BoundaryCondition& load) { return is_absent(load.name); });
    for (PartTemplate& part : left.parts) part.present.clear();
    for (Connection& pegs : left.connections) pegs.present.clear();
    for (BoundaryCondition& load : left.boundary_conditions) load.present.clear();
    const TemplateFunction written = FunctionOf(without);
    const auto one = function.Evaluate(q);
    const auto other = written.Evaluate(q);
    ASSERT_TRUE(one.ok()) << one.status();
    ASSERT_TRUE(other.ok()) << other.status();
    EXPECT_EQ(ContentOf(*one), ContentOf(*other));
    const auto mass = function.EvaluateMass(q);
    const auto mass_without = written.EvaluateMass(q);
    ASSERT_TRUE(mass.ok() && mass_without.ok());
    EXPECT_EQ(mass->mass, mass_without->mass);
    EXPECT_EQ(mass->mass_gradient, mass_without->mass_gradient);
    std::vector<std::string> absent;
    for (std::size_t i = 0; i < present.size(); ++i) {
      if (!present[i]) absent.push_back(absl::StrCat("box", i));
    }
    EXPECT_EQ(one->structure->absent_parts, absent);
  }
}

TEST(Variation, RandomTemplatesAreValid) {
  std::mt19937 random(12);
  for (int trial = 0; trial < 10; ++trial) {
    const auto findings = ValidateTemplate(RandomBoxes(random).bundle);
    EXPECT_THAT(findings, IsEmpty()) << findings[0].field << ": " << findings[0].message;
  }
}

// ---- Copies -------------------------------------------------------------------------------------

TEST(Variation, ShelfIsValid) {
  const auto findings = ValidateTemplate(VariedShelf());
  EXPECT_THAT(findings, IsEmpty()) << findings[0].field << ": " << findings[0].message;
}

// Each copy as a part of its own, with the number in the place of the index.
TemplateBundle WrittenOut(const TemplateBundle& bundle, const EvaluatedDesign& design) {
  TemplateBundle written = bundle;
  TemplateDefinition& definition = written.definition;
  definition.parts.clear();
  definition.connections.clear();
  definition.boundary_conditions.clear();
  const auto absent = [&](const std::string& part) {
    const auto& names = design.structure->absent_parts;
    return std::find(names.begin(), names.end(), part) != names.end();
  };
  const auto count_of = [&](const std::string& part) {
    for (const StructureCount& count : design.structure->counts) {
      if (count.name == part) return count.numbers[0];
    }
    return 1;
  };
  const auto name_of = [](const std::string& part, int k) { return absl::StrCat(part, "_", k); };
  for (PartTemplate part : bundle.definition.parts) {
    if (absent(part.name)) continue;
    const std::string z = part.repeat.empty() ? "0" : part.repeat[0].z;
    const Box drawn = std::get<Box>(part.body);
    const PartTemplate original = part;
    part.present.clear();
    part.repeat.clear();
    for (int k = 0; k < count_of(original.name); ++k) {
      Box box = drawn;
      box.x.to = absl::StrReplaceAll(box.x.to, {{"* k", absl::StrCat("* ", k)}});
      box.z = {absl::StrCat("(", drawn.z.from, ") + ", k, " * (", z, ")"),
               absl::StrCat("(", drawn.z.to, ") + ", k, " * (", z, ")")};
      part.body = box;
      part.name = name_of(original.name, k + 1);
      definition.parts.push_back(part);
    }
  }
  for (Connection pegs : bundle.definition.connections) {
    if (absent(pegs.part)) continue;
    const Connection original = pegs;
    pegs.present.clear();
    for (int k = 0; k < count_of(original.part); ++k) {
      pegs.name = absl::StrCat(original.name, "_", k);
      pegs.part = name_of(original.part, k + 1);
      pegs.other_part = name_of(original.other_part, 1);
      definition.connections.push_back(pegs);
    }
  }
  return written;
}

TEST(Variation, CopiesArePartsWrittenOut) {
  const TemplateBundle bundle = VariedShelf();
  const TemplateFunction function = FunctionOf(bundle);
  std::mt19937 random(13);
  for (int trial = 0; trial < 60; ++trial) {
    const VectorXd q = RandomPoint(function.parameters(), random);
    const auto design = function.Evaluate(q);
    ASSERT_TRUE(design.ok()) << design.status();
    const TemplateFunction other = FunctionOf(WrittenOut(bundle, *design));
    const auto written = other.Evaluate(q);
    ASSERT_TRUE(written.ok()) << written.status();
    ASSERT_EQ(design->parts.size(), written->parts.size());
    for (std::size_t i = 0; i < design->parts.size(); ++i) {
      const EvaluatedPart& copy = design->parts[i];
      const EvaluatedPart& part = written->parts[i];
      EXPECT_TRUE(copy.minimum.isApprox(part.minimum, 1e-12) ||
                  (copy.minimum - part.minimum).norm() < 1e-12);
      EXPECT_TRUE(copy.maximum.isApprox(part.maximum, 1e-12));
      EXPECT_NEAR(copy.volume, part.volume, 1e-12);
      EXPECT_EQ(copy.item, part.item);
      EXPECT_EQ(copy.face_names, part.face_names);
    }
    ASSERT_EQ(design->connectors.size(), written->connectors.size());
    for (std::size_t i = 0; i < design->connectors.size(); ++i) {
      EXPECT_LT((design->connectors[i].position - written->connectors[i].position).norm(), 1e-12);
      EXPECT_EQ(design->connectors[i].item, written->connectors[i].item);
    }
    const auto mass = function.EvaluateMass(q);
    const auto mass_written = other.EvaluateMass(q);
    ASSERT_TRUE(mass.ok() && mass_written.ok());
    EXPECT_NEAR(mass->mass, mass_written->mass, 1e-9);
    EXPECT_NEAR(mass->mass, design->mass, 1e-9);
    for (const Eigen::Index numbers : {0, 1}) {
      EXPECT_NEAR(mass->mass_gradient(numbers), mass_written->mass_gradient(numbers), 1e-9);
    }
  }
}

TEST(Variation, CopiesAreCalledByTheirNumbers) {
  const EvaluatedDesign design = At(VariedShelf(), {{"shelves", 2}});
  EXPECT_EQ(Part(design, "shelf 1").minimum.z(), 0.1);
  EXPECT_NEAR(Part(design, "shelf 2").minimum.z(), 0.4, 1e-12);
  EXPECT_LT(FindPart(design, "shelf 3"), 0);
  EXPECT_LT(FindPart(design, "shelf"), 0);
  EXPECT_NEAR(Part(design, "slat 7").maximum.x(), 0.8 - 0.006, 1e-12);
  EXPECT_EQ(CopyName("slat", std::vector<int>{2, 7}), "slat 2.7");
  for (const char* name : {"slat", "slat 1", "slat 12.1000"}) {
    const auto read = ReadCopyName(name);
    ASSERT_TRUE(read) << name;
    EXPECT_EQ(CopyName(read->part, read->numbers), name);
  }
  for (const char* name : {"slat 0", "slat 01", "slat 1.", "slat 1 2", "slat +1", "slat 1001",
                           "slat x", "slat ", "slat 1.2.3x"}) {
    EXPECT_FALSE(ReadCopyName(name)) << name;
  }
}

TEST(Variation, GridsCountTheSecondDirectionLast) {
  TemplateBundle bundle = VariedShelf();
  TemplateDefinition& grid = bundle.definition;
  grid.connections.clear();
  grid.boundary_conditions.clear();
  grid.parts = {BoxPart("tile", {"i * 0.001", "0.1"}, {"0", "0.1 + j * 0.001"}, {"0", "0.02"})};
  grid.parts[0].repeat = {{"shelves", "0.2", "", "", "i"}, {"2", "", "0.3", "", "j"}};
  const EvaluatedDesign design = At(bundle, {{"shelves", 3}});
  std::vector<std::string> names;
  for (const EvaluatedPart& part : design.parts) names.push_back(part.name);
  EXPECT_THAT(names,
              ElementsAre("tile 1.1", "tile 1.2", "tile 2.1", "tile 2.2", "tile 3.1", "tile 3.2"));
  EXPECT_TRUE(design.parts[5].minimum.isApprox(Eigen::Vector3d(0.402, 0.3, 0), 1e-12));
  EXPECT_TRUE(design.parts[5].maximum.isApprox(Eigen::Vector3d(0.5, 0.401, 0.02), 1e-12));
  ASSERT_THAT(design.structure->counts, SizeIs(1));
  EXPECT_EQ(design.structure->counts[0].numbers, (std::vector<int>{3, 2}));
}

TEST(Variation, PrismsAreMovedAlongAllAxes) {
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
    TemplateBundle bundle = VariedShelf();
    bundle.items[1].kind = ItemKind::kSheet;
    TemplateDefinition& row = bundle.definition;
    row.connections.clear();
    row.boundary_conditions.clear();
    row.parts = {BoxPart("wedge", {}, {}, {})};
    row.parts[0].thickness_axis = axis;
    row.parts[0].length_axis = axis == Axis::kX ? Axis::kY : Axis::kX;
    row.parts[0].body = Prism{axis, {{"0", "0"}, {"0.2", "0"}, {"0", "0.1"}}, {"0", "0.02"}};
    row.parts[0].repeat = {{"2", "0.3", "0.4", "0.5"}};
    const EvaluatedDesign design = At(bundle, {});
    ASSERT_THAT(design.parts, SizeIs(2));
    const Eigen::Vector3d by(0.3, 0.4, 0.5);
    EXPECT_TRUE((design.parts[1].minimum - design.parts[0].minimum).isApprox(by, 1e-12));
    EXPECT_TRUE((design.parts[1].maximum - design.parts[0].maximum).isApprox(by, 1e-12));
    EXPECT_NEAR(design.parts[1].volume, 0.2 * 0.1 / 2 * 0.02, 1e-12);
  }
}

// ---- Conditions on copies -----------------------------------------------------------------------

TEST(Variation, CopiesShareAForceByTheAreasOfTheirFaces) {
  const EvaluatedDesign design = At(VariedShelf(), {{"shelves", 3}, {"top", 0, "flat"}});
  std::vector<std::string> names, parts;
  double force = 0;
  for (const EvaluatedBoundaryCondition& condition : design.boundary_conditions) {
    names.push_back(condition.name);
    parts.push_back(condition.part);
    if (condition.name == "books") force += condition.force.z();
  }
  EXPECT_THAT(names, ElementsAre("floor", "books", "books", "books", "vase", "first"));
  EXPECT_THAT(parts, ElementsAre("left", "shelf 1", "shelf 2", "shelf 3", "top", "shelf 1"));
  EXPECT_NEAR(force, -300, 1e-9);
  EXPECT_NEAR(design.boundary_conditions[2].force.z(), -100, 1e-9);
  // By areas where they differ: slats are 1 mm shorter each.
  TemplateBundle bundle = VariedShelf();
  bundle.definition.boundary_conditions = {
      {"push", BoundaryConditionKind::kForce, "slat", "y_max", {"0", "-1", "0"}, ""}};
  const EvaluatedDesign pushed = At(bundle, {{"shelves", 1}});
  ASSERT_THAT(pushed.boundary_conditions, SizeIs(3));
  const double all = 0.8 + 0.799 + 0.798;
  EXPECT_NEAR(pushed.boundary_conditions[0].force.y(), -0.8 / all, 1e-9);
  EXPECT_NEAR(pushed.boundary_conditions[2].force.y(), -0.798 / all, 1e-9);
}

// ---- Structure ----------------------------------------------------------------------------------

// What is there, how often, of what, worked out from the template's text.
std::string ExpectedStructure(const VectorXd& q) {
  const bool has_slats = q(1) > 0.22 || q(3) == 1;
  return absl::StrCat(q(2), " ", q(3), " ", q(4), " ", has_slats);
}

TEST(Variation, StructuresAreTheSameWhereChoicesCountsAndPartsAre) {
  const TemplateFunction function = FunctionOf(VariedShelf());
  std::mt19937 random(19);
  std::map<std::string, std::string> keys, expected;
  for (int trial = 0; trial < 300; ++trial) {
    const VectorXd q = RandomPoint(function.parameters(), random);
    const auto design = function.Evaluate(q);
    ASSERT_TRUE(design.ok()) << design.status();
    const std::string key = KeyOf(*design->structure);
    const std::string should = ExpectedStructure(q);
    EXPECT_EQ(keys.emplace(should, key).first->second, key) << should;
    EXPECT_EQ(expected.emplace(key, should).first->second, should) << key;
  }
  EXPECT_GT(keys.size(), 20U);
}

TEST(Variation, StructuresSayWhatIsThere) {
  const EvaluatedDesign design =
      At(VariedShelf(), {{"depth", 0.2}, {"shelves", 2}, {"wood", 0, "oak"}});
  EXPECT_EQ(Describe(*design.structure),
            "top = none, wood = oak, without top, without slat, without vase, shelf: 2, shelf of "
            "items/oak");
  EXPECT_EQ(Part(design, "shelf 1").item, "items/oak");
  EXPECT_EQ(Part(design, "left").item, "items/pine");
  const auto back = FromProto(ToProto(design));
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(*back->structure, *design.structure);
  EXPECT_EQ(back->parameters[4].choice, "oak");
}

// ---- Gradients ----------------------------------------------------------------------------------

TEST(Variation, GradientsOfMassAreThoseOfDifferences) {
  const TemplateFunction function = FunctionOf(VariedShelf());
  std::mt19937 random(23);
  for (int trial = 0; trial < 100; ++trial) {
    VectorXd q = RandomPoint(function.parameters(), random);
    if (std::abs(q(1) - 0.22) < 1e-3) continue;  // where slats come and go
    q(0) = std::clamp(q(0), 0.51, 1.19);
    q(1) = std::clamp(q(1), 0.201, 0.399);
    const auto mass = function.EvaluateMass(q);
    ASSERT_TRUE(mass.ok()) << mass.status();
    for (const Eigen::Index i : {0, 1}) {
      VectorXd up = q, down = q;
      up(i) += 1e-6;
      down(i) -= 1e-6;
      const double difference =
          (function.EvaluateMass(up)->mass - function.EvaluateMass(down)->mass) / 2e-6;
      EXPECT_NEAR(mass->mass_gradient(i), difference, 1e-5 * (1 + std::abs(difference)));
    }
    EXPECT_EQ(mass->mass_gradient(3), 0);
    EXPECT_EQ(mass->mass_gradient(4), 0);
  }
}

// ---- Parameters ---------------------------------------------------------------------------------

TEST(Variation, ChoicesAreGivenByNameOrNumber) {
  const std::vector<Parameter> parameters = VariedShelf().definition.parameters;
  const auto value = [&](const NamedValue& given) -> std::string {
    const auto q = CompleteParameters(parameters, {given});
    return q.ok() ? absl::StrCat((*q)(4)) : std::string(q.status().message());
  };
  EXPECT_EQ(value({"wood", 1}), "1");
  EXPECT_EQ(value({"wood", 0, "oak"}), "1");
  EXPECT_EQ(value({"wood", 1, "oak"}), "1");
  EXPECT_EQ(value({"wood", 0, "pine"}), "0");
  EXPECT_THAT(value({"wood", 0, "ash"}),
              HasSubstr("'wood' has no value 'ash'; it has 'pine', 'oak'"));
  EXPECT_THAT(value({"wood", 1, "pine"}), HasSubstr("leave one of them out"));
  EXPECT_THAT(value({"wood", 0.5}), HasSubstr("not the number of one of its 2 values"));
  EXPECT_THAT(value({"wood", 2}), HasSubstr("not the number"));
  EXPECT_THAT(value({"width", 0, "oak"}), HasSubstr("'width' is a number, no choice"));
  const VectorXd q = *CompleteParameters(parameters, {{"wood", 0, "oak"}});
  EXPECT_THAT(ToText(parameters, q), HasSubstr("top = none, wood = oak"));
  EXPECT_EQ(NamedValues(parameters, q)[4].choice, "oak");
  EXPECT_EQ(NamedValues(parameters, q)[0].choice, "");
}

TEST(Variation, TriesEveryCombinationOfChoices) {
  const std::vector<Parameter> parameters = VariedShelf().definition.parameters;
  std::set<std::pair<double, double>> at_defaults, at_corners;
  for (const VectorXd& q : TrialPoints(parameters, 8)) {
    EXPECT_THAT(CheckRanges(parameters, q), IsEmpty());
    EXPECT_EQ(q(2), std::round(q(2)));
    if (q(0) == 0.8) at_defaults.insert({q(3), q(4)});
    if (q(0) == 1.2 && q(1) == 0.4 && q(2) == 6) at_corners.insert({q(3), q(4)});
  }
  EXPECT_THAT(at_defaults, SizeIs(4));
  EXPECT_THAT(at_corners, SizeIs(4));
  // Of very many combinations, each value by itself.
  std::vector<Parameter> many;
  for (int i = 0; i < 10; ++i) many.push_back(Choice(absl::StrCat("c", i), {"a", "b", "c"}));
  const std::vector<VectorXd> points = TrialPoints(many, 4);
  EXPECT_LT(points.size(), 40U);
  for (Eigen::Index i = 0; i < 10; ++i) {
    std::set<double> values;
    for (const VectorXd& q : points) values.insert(q(i));
    EXPECT_THAT(values, SizeIs(3));
  }
}

}  // namespace
}  // namespace mortise::parametric
