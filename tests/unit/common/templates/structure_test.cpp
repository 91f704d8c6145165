// The structure of designs: where it is the same, so are parts, vertices and triangles; where it is
// not, there are others.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/design/part_shapes.h"
#include "common/files/template_codec.h"
#include "common/templates/template_codec.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/templates/conditioned_bars.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::templates {
namespace {

using parametric::EvaluatedDesign;
using parametric::Structure;

using Function = std::shared_ptr<const Template>;

Function Compiled(v1::TemplateBundle bundle) {
  EXPECT_EQ(FillAndCheck(bundle, Trial::kDefaults), absl::OkStatus());
  absl::StatusOr<Function> compiled = Compile(bundle);
  EXPECT_TRUE(compiled.ok()) << compiled.status();
  return compiled.ok() ? *std::move(compiled) : nullptr;
}

// A plate with rows of holes, one for each 50 mm of its length, and a boss of as many corners but
// one.
constexpr char kDrilled[] = R"pb(
  definitions { name: "holes" value: "floor(length / 0.05)" }
  features {
    name: "outline"
    sketch {
      profiles {
        name: "edge"
        rectangle { width: "length" height: "0.1" }
      }
    }
  }
  features {
    name: "plate"
    extrude { sketch: "outline" to: "0.01" }
  }
  features {
    name: "hole"
    hole {
      face: "plate.end"
      position { x: "0.02 - length / 2" y: "-0.02" }
      diameter: "0.008"
    }
  }
  features {
    name: "rows"
    linear_pattern {
      feature: "hole"
      step { x: "0.04" }
      count: "holes"
      second_step { y: "0.04" }
      second_count: "2"
    }
  }
  features {
    name: "corners"
    sketch {
      profiles {
        name: "boss"
        polygon { radius: "0.005" sides: "holes - 1" }
      }
    }
  }
  features {
    name: "boss"
    extrude { sketch: "corners" to: "0.02" operation: UNITE }
  }
)pb";

v1::TemplateBundle DrilledPlate() {
  return BarOf(
      absl::StrCat("cad { title: 'Plate' material: 'materials/spruce' ", kLength, kDrilled, "}"),
      {});
}

// The defaults, the ends of the parameters one by one, and points between; always the same.
std::vector<Eigen::VectorXd> PointsOf(const Function& function, int between) {
  const std::vector<parametric::Parameter>& parameters = function->parameters();
  const Eigen::VectorXd defaults = parametric::Defaults(parameters);
  std::vector<Eigen::VectorXd> points = {defaults};
  for (Eigen::Index i = 0; i < defaults.size(); ++i) {
    const parametric::Parameter& parameter = parameters[static_cast<std::size_t>(i)];
    for (const double share : {0.1, 0.45, 0.55, 0.9}) {
      points.push_back(defaults);
      points.back()(i) = parameter.minimum + share * (parameter.maximum - parameter.minimum);
    }
  }
  std::mt19937_64 random(7);
  for (int k = 0; k < between; ++k) {
    points.push_back(defaults);
    for (Eigen::Index i = 0; i < defaults.size(); ++i) {
      const parametric::Parameter& parameter = parameters[static_cast<std::size_t>(i)];
      const double most = k % 2 == 0 ? 0.3 : 0.02;  // far off, not all lengths go together
      const double share = most * static_cast<double>(random() >> 11) * 0x1p-53;
      const double end = (random() & 1U) != 0 ? parameter.maximum : parameter.minimum;
      points.back()(i) += share * (end - points.back()(i));
    }
  }
  for (Eigen::VectorXd& q : points) q = parametric::WithWholeNumbers(parameters, std::move(q));
  return points;
}

std::vector<std::string> PartNames(const EvaluatedDesign& design) {
  std::vector<std::string> names;
  for (const parametric::EvaluatedPart& part : design.parts) names.push_back(part.name);
  return names;
}

// How many vertices, triangles and faces each part has, and which vertices its triangles have.
void ExpectSameVertices(const EvaluatedDesign& a, const EvaluatedDesign& b) {
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    const parametric::EvaluatedPart &one = a.parts[i], &other = b.parts[i];
    EXPECT_EQ(one.outline.cols(), other.outline.cols()) << one.name;
    EXPECT_EQ(one.face_names, other.face_names) << one.name;
    ASSERT_EQ(one.faceted.has_value(), other.faceted.has_value()) << one.name;
    if (!one.faceted) continue;
    EXPECT_EQ(one.faceted->surface.vertices.cols(), other.faceted->surface.vertices.cols());
    EXPECT_EQ(one.faceted->surface.triangles, other.faceted->surface.triangles) << one.name;
  }
}

struct Shipped {
  std::string name;     // of an assembly, or of a template
  bool varies = false;  // whether its points have structures of more than one kind
};

void PrintTo(const Shipped& shipped, std::ostream* out) { *out << shipped.name; }

Function ShippedFunction(const std::string& name) {
  return Compiled(name.starts_with("assemblies/") ? ShippedAssembly(name) : ShippedTemplate(name));
}

class StructureOfShipped : public ::testing::TestWithParam<Shipped> {};

TEST_P(StructureOfShipped, TheSameStructureMeansTheSameParts) {
  const Function function = ShippedFunction(GetParam().name);
  ASSERT_NE(function, nullptr);
  const bool is_cad = GetParam().name.starts_with("templates/");
  std::map<std::string, std::vector<EvaluatedDesign>> by_key;
  std::set<std::vector<std::string>> part_lists;
  int pairs = 0;
  for (const Eigen::VectorXd& q : PointsOf(function, is_cad ? 2 : 20)) {
    const absl::StatusOr<EvaluatedDesign> design = function->Evaluate(q);
    const absl::StatusOr<Structure> structure = function->StructureAt(q);
    if (!design.ok()) {
      if (!is_cad) {
        EXPECT_EQ(structure.status(), design.status());
      }
      continue;
    }
    ASSERT_OK(structure.status());
    ASSERT_EQ(*structure, design->structure);
    auto& alike = by_key[KeyOf(*structure)];
    if (!alike.empty()) {
      ++pairs;
      EXPECT_EQ(alike.front().structure, design->structure);
      EXPECT_EQ(PartNames(alike.front()), PartNames(*design));
      if (!is_cad) ExpectSameVertices(alike.front(), *design);
    }
    part_lists.insert(PartNames(*design));
    if (alike.empty()) alike.push_back(*design);
  }
  EXPECT_GE(pairs, 3);
  EXPECT_EQ(by_key.size() > 1, GetParam().varies);
  // Of an assembly, another structure is another number of some parts.
  if (!is_cad) {
    EXPECT_EQ(part_lists.size(), by_key.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Assemblies, StructureOfShipped,
                         ::testing::Values(Shipped{"assemblies/bookshelf", true},
                                           Shipped{"assemblies/bed", true},
                                           Shipped{"assemblies/workbench", true},
                                           Shipped{"assemblies/picnic-table", true},
                                           Shipped{"assemblies/tool-cart"}),
                         [](const auto& chosen) {
                           return absl::StrReplaceAll(chosen.param.name, {{"-", "_"}, {"/", "_"}});
                         });

INSTANTIATE_TEST_SUITE_P(Templates, StructureOfShipped,
                         ::testing::Values(Shipped{"templates/wrench"},
                                           Shipped{"templates/camera-mount"},
                                           Shipped{"templates/table"}, Shipped{"templates/boat"},
                                           Shipped{"templates/armchair", true}),
                         [](const auto& chosen) {
                           return absl::StrReplaceAll(chosen.param.name, {{"-", "_"}, {"/", "_"}});
                         });

TEST(StructureTest, OfFeaturesCountsInstancesAndCorners) {
  const Function plate = Compiled(DrilledPlate());
  ASSERT_NE(plate, nullptr);
  const auto at = [&](double length) {
    return plate->StructureAt(Eigen::VectorXd::Constant(1, length));
  };
  ASSERT_OK_AND_ASSIGN(const Structure drawn, at(0.41));
  EXPECT_EQ(Describe(drawn), "rows: 8 × 2, corners.boss: 7");
  ASSERT_OK_AND_ASSIGN(const Structure alike, at(0.44));
  EXPECT_EQ(alike, drawn);
  EXPECT_EQ(KeyOf(alike), KeyOf(drawn));
  ASSERT_OK_AND_ASSIGN(const Structure longer, at(0.51));
  EXPECT_EQ(Describe(longer), "rows: 10 × 2, corners.boss: 9");
  EXPECT_NE(KeyOf(longer), KeyOf(drawn));
  ASSERT_OK_AND_ASSIGN(const EvaluatedDesign design,
                       plate->Evaluate(Eigen::VectorXd::Constant(1, 0.41)));
  EXPECT_EQ(design.structure, drawn);
}

TEST(StructureTest, FailsAsEvaluating) {
  const Function plate = Compiled(DrilledPlate());
  ASSERT_NE(plate, nullptr);
  EXPECT_EQ(DetailOf(plate->StructureAt(Eigen::VectorXd::Constant(1, 5)).status()).field,
            "parameters[0].value");
  EXPECT_EQ(plate->StructureAt(Eigen::VectorXd::Zero(2)).status(),
            plate->Evaluate(Eigen::VectorXd::Zero(2)).status());
}

TEST(StructureTest, SurvivesItsMessage) {
  EvaluatedDesign design;
  design.structure = Structure{{{"slat 1", {14}}, {"screw 1", {2, 14}}}};
  const v1::EvaluatedDesign message = parametric::ToProto(design);
  EXPECT_EQ(message.structure().description(), "slat 1: 14, screw 1: 2 × 14");
  EXPECT_EQ(message.structure().key(), KeyOf(*design.structure));
  ASSERT_OK_AND_ASSIGN(const EvaluatedDesign back, parametric::FromProto(message));
  EXPECT_EQ(back.structure, design.structure);
  // What was written before structures were told has none, which is not that nothing is counted.
  ASSERT_OK_AND_ASSIGN(const EvaluatedDesign old, parametric::FromProto(v1::EvaluatedDesign()));
  EXPECT_FALSE(old.structure.has_value());
  EXPECT_FALSE(parametric::ToProto(old).has_structure());
}

TEST(StructureTest, CountsOfNothingAreRefused) {
  v1::EvaluatedDesign message;
  v1::Structure::Count& count = *message.mutable_structure()->add_counts();
  const auto field = [&] { return DetailOf(parametric::FromProto(message).status()).field; };
  EXPECT_EQ(field(), "structure.counts[0].numbers");
  count.add_numbers(0);
  EXPECT_EQ(field(), "structure.counts[0].numbers");
  count.set_numbers(0, 3);
  EXPECT_EQ(field(), "");
  count.add_numbers(1);
  count.add_numbers(1);
  EXPECT_EQ(field(), "structure.counts[0].numbers");
}

}  // namespace
}  // namespace mortise::templates
