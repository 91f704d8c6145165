// Templates of sub-trees of the assemblies that ship.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::templates {
namespace {

using parametric::EvaluatedDesign;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Function = std::shared_ptr<const Template>;

v1::TemplateBundle SubTree(const std::string& assembly, const std::string& group) {
  v1::TemplateBundle bundle = ShippedAssembly("assemblies/" + assembly);
  bundle.mutable_template_()->mutable_assembly()->set_group(group);
  return bundle;
}

std::set<std::string> PartNames(const EvaluatedDesign& design) {
  std::set<std::string> names;
  for (const parametric::EvaluatedPart& part : design.parts) names.insert(part.name);
  return names;
}

struct ShippedSubTree {
  std::string assembly, group;
  std::string inside, outside;  // a part of it, and one that is not
};

void PrintTo(const ShippedSubTree& sub_tree, std::ostream* out) {
  *out << sub_tree.assembly << " " << sub_tree.group;
}

class SubTreeOfShipped : public ::testing::TestWithParam<ShippedSubTree> {};

TEST_P(SubTreeOfShipped, IsATemplateByItself) {
  v1::TemplateBundle bundle = SubTree(GetParam().assembly, GetParam().group);
  ASSERT_OK(FillAndCheck(bundle, Trial::kThorough));
  const v1::Template& message = bundle.template_();
  EXPECT_EQ(message.title(), absl::StrCat(bundle.assembly().title(), ": ", GetParam().group));
  EXPECT_GE(message.parameters_size(), 1);
  ASSERT_OK_AND_ASSIGN(const Function function, Compile(bundle));
  const Eigen::VectorXd defaults = parametric::Defaults(function->parameters());
  ASSERT_OK_AND_ASSIGN(const EvaluatedDesign drawn, function->Evaluate(defaults));
  EXPECT_THAT(PartNames(drawn), Contains(GetParam().inside));
  EXPECT_THAT(PartNames(drawn), Not(Contains(GetParam().outside)));
  // It is where and as large as it is in the whole.
  v1::TemplateBundle whole = ShippedAssembly("assemblies/" + GetParam().assembly);
  ASSERT_OK(FillAndCheck(whole, Trial::kDefaults));
  ASSERT_OK_AND_ASSIGN(const Function all, Compile(whole));
  ASSERT_OK_AND_ASSIGN(const EvaluatedDesign drawn_whole,
                       all->Evaluate(parametric::Defaults(all->parameters())));
  EXPECT_LT(drawn.mass, drawn_whole.mass);
  for (const parametric::EvaluatedPart& part : drawn.parts) {
    const int index = parametric::FindPart(drawn_whole, part.name);
    ASSERT_GE(index, 0) << part.name;
    const auto& same = drawn_whole.parts[static_cast<std::size_t>(index)];
    EXPECT_LT((part.minimum - same.minimum).norm(), 1e-6) << part.name;
    EXPECT_LT((part.maximum - same.maximum).norm(), 1e-6) << part.name;
  }
}

// Each of its sizes can be changed by itself, without faults; further off, others must change too.
TEST_P(SubTreeOfShipped, HasDesignsOfItsOwn) {
  v1::TemplateBundle bundle = SubTree(GetParam().assembly, GetParam().group);
  ASSERT_OK(FillAndCheck(bundle, Trial::kDefaults));
  ASSERT_OK_AND_ASSIGN(const Function function, Compile(bundle));
  const Eigen::VectorXd defaults = parametric::Defaults(function->parameters());
  for (Eigen::Index i = 0; i < defaults.size(); ++i) {
    const parametric::Parameter& parameter = function->parameters()[static_cast<std::size_t>(i)];
    int designs = 0;
    for (const double share : {0.01, 0.2}) {
      for (const double end : {parameter.minimum, parameter.maximum}) {
        Eigen::VectorXd q = defaults;
        q(i) += share * (end - q(i));
        if (q(i) == defaults(i)) continue;
        const auto at = function->AssemblyAt(q);
        if (DetailOf(at.status()).reason == "DEMANDS_CONFLICT") continue;
        ASSERT_OK(at);
        ++designs;
        ASSERT_OK_AND_ASSIGN(const auto faults, (*at)->assembly->FaultsAt((*at)->q));
        for (const auto& fault : faults) {
          ADD_FAILURE() << parameter.name << " = " << q(i) << ": " << Describe(fault);
        }
      }
    }
    EXPECT_GE(designs, 1) << parameter.name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Groups, SubTreeOfShipped,
    ::testing::Values(ShippedSubTree{"bookshelf", "shelves", "shelf 1", "screw left 1.1"},
                      ShippedSubTree{"cabinet", "left drawer", "left drawer front", "deck"},
                      ShippedSubTree{"bed", "headboard", "headboard screw left 1",
                                     "cleat screw left 1"},
                      ShippedSubTree{"bed", "slats", "slat screw left 1", "side rail 1"},
                      ShippedSubTree{"toy-chest", "case", "screw front 1.1", "hinge 1"},
                      ShippedSubTree{"tool-cart", "drawer", "drawer front", "hinge 1"}),
    [](const auto& chosen) {
      return absl::StrReplaceAll(chosen.param.assembly + "_" + chosen.param.group,
                                 {{"-", "_"}, {" ", "_"}});
    });

INSTANTIATE_TEST_SUITE_P(
    Parts, SubTreeOfShipped,
    ::testing::Values(ShippedSubTree{"bed", "slat", "slat 14", "bearer 1"},
                      ShippedSubTree{"bookshelf", "plinth", "plinth", "side 1"}),
    [](const auto& chosen) { return chosen.param.assembly + "_" + chosen.param.group; });

TEST(SubTreeChecks, TheRootIsTheTemplateOfTheWhole) {
  v1::TemplateBundle root = SubTree("bookshelf", ""),
                     whole = ShippedAssembly("assemblies/bookshelf");
  ASSERT_OK(FillAndCheck(root, Trial::kDefaults));
  ASSERT_OK(FillAndCheck(whole, Trial::kDefaults));
  EXPECT_EQ(root.SerializeAsString(), whole.SerializeAsString());
}

// Content differs by the group alone.
TEST(SubTreeChecks, DigestsTellSubTreesApart) {
  v1::TemplateBundle shelves = SubTree("bookshelf", "shelves"), row = SubTree("bookshelf", "shelf");
  for (v1::TemplateBundle* bundle : {&shelves, &row}) {
    bundle->mutable_template_()->set_title("Shelves");
    ASSERT_OK(FillAndCheck(*bundle, Trial::kDefaults));
  }
  EXPECT_NE(shelves.template_().digest(), row.template_().digest());
}

TEST(SubTreeChecks, GroupsThatThereAreNotAreNamed) {
  for (const char* group : {"chimney", "assemblies/bookshelf", "shelves ", "Shelves"}) {
    v1::TemplateBundle bundle = SubTree("bookshelf", group);
    const absl::Status refused = FillAndCheck(bundle, Trial::kDefaults);
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << group;
    EXPECT_EQ(DetailOf(refused).field, "assembly.group") << refused;
    EXPECT_THAT(std::string(refused.message()), HasSubstr("there is no group or part"));
  }
  v1::TemplateBundle screws = SubTree("bookshelf", "screw left");
  const absl::Status refused = FillAndCheck(screws, Trial::kDefaults);
  EXPECT_EQ(DetailOf(refused).field, "assembly.group") << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("no principal parts"));
}

TEST(SubTreeChecks, HandlesAndConditionsAreOfItsElements) {
  v1::TemplateBundle bundle = SubTree("bookshelf", "shelves");
  v1::AssemblyHandle& handle = *bundle.mutable_template_()->mutable_assembly()->add_handles();
  handle.set_parameter("height");
  handle.mutable_measure()->set_element("side 1");
  handle.mutable_measure()->set_axis(v1::Z);
  v1::BoundaryCondition& condition = *bundle.mutable_template_()->add_boundary_conditions();
  condition.set_name("foot");
  condition.set_kind(v1::BoundaryCondition::FIXED);
  condition.set_part("side 1");
  condition.set_face("z_min");
  const absl::Status refused = FillAndCheck(bundle, Trial::kDefaults);
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  for (const char* field : {"assembly.handles[0].measure", "boundary_conditions[0].part"}) {
    EXPECT_THAT(std::string(refused.message()), HasSubstr(field));
  }
}

// What is wrong with the assembly itself is told as of any template.
TEST(SubTreeChecks, FaultsOfTheAssemblyKeepTheirPlace) {
  v1::TemplateBundle bundle = SubTree("bookshelf", "shelves");
  bundle.mutable_assembly()->mutable_parts(0)->set_item("items/none");
  EXPECT_EQ(DetailOf(FillAndCheck(bundle, Trial::kDefaults)).field,
            "assembly.assembly.parts[0].item");
}

// Two posts that only the shelf outside of the group held.
TEST(SubTreeChecks, WhatNothingInsideHoldsIsRefusedByItsGroup) {
  v1::TemplateBundle bundle = SubTree("bookshelf", "posts");
  v1::Assembly& shelf = *bundle.mutable_assembly();
  shelf.Clear();
  shelf.set_name("assemblies/bookshelf");
  shelf.add_groups()->set_name("posts");
  const auto add = [&](const std::string& name, const std::string& group, double x, double y,
                       double z, double length, double width, double height) {
    v1::AssemblyPart& part = *shelf.add_parts();
    part.set_name(name);
    part.set_group(group);
    part.mutable_position()->set_x(x);
    part.mutable_position()->set_y(y);
    part.mutable_position()->set_z(z);
    part.mutable_size()->set_x(length);
    part.mutable_size()->set_y(width);
    part.mutable_size()->set_z(height);
  };
  add("left post", "posts", 0, 0, 0, 0.05, 0.1, 1);
  add("right post", "posts", 0.9, 0.3, 0, 0.06, 0.11, 1.1);
  add("shelf", "", 0.05, 0, 0.5, 0.85, 0.45, 0.03);
  const absl::Status refused = FillAndCheck(bundle, Trial::kDefaults);
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition) << refused;
  EXPECT_EQ(DetailOf(refused).reason, "FEASIBLE_SET_UNBOUNDED") << refused;
  EXPECT_EQ(DetailOf(refused).field, "assembly.group");
}

}  // namespace
}  // namespace mortise::templates
