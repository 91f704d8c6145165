// Validation finds everything that is wrong, says where, and lets good templates pass.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/design/template_validation.h"
#include "common/files/template_codec.h"
#include "common/files/template_reader.h"
#include "tests/unit/common/files/table.h"

namespace mortise::parametric {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

auto At(const std::string& field, const std::string& message = "") {
  return testing::AllOf(Field(&FieldViolation::field, field),
                        Field(&FieldViolation::message, HasSubstr(message)));
}

std::string Listed(const std::vector<FieldViolation>& findings) {
  std::string text;
  for (const FieldViolation& finding : findings) {
    text += finding.field + ": " + finding.message + "\n";
  }
  return text;
}

class ValidationTest : public testing::Test {
 protected:
  TemplateBundle bundle_ = TableBundle();
  TemplateDefinition& table_ = bundle_.definition;

  Box& BoxOf(std::size_t part) { return std::get<Box>(table_.parts[part].body); }
  Prism& Top() { return std::get<Prism>(table_.parts[8].body); }
};

TEST_F(ValidationTest, TheTableIsFlawless) {
  EXPECT_THAT(ValidateTemplate(bundle_), IsEmpty()) << Listed(ValidateTemplate(bundle_));
}

TEST(CollectionTest, EverythingShippedIsValid) {
  const Collection collection = ShippedCollection();
  EXPECT_GE(collection.materials.size(), 5u);
  EXPECT_GE(collection.items.size(), 20u);
  ASSERT_FALSE(collection.templates.empty());
  std::vector<Material> materials;
  for (const auto& message : collection.materials) {
    materials.push_back(*FromProto(message));
    EXPECT_THAT(ValidateMaterial(materials.back()), IsEmpty()) << message.name();
  }
  for (const auto& message : collection.items) {
    const auto item = FromProto(message);
    ASSERT_TRUE(item.ok()) << item.status();
    EXPECT_THAT(ValidateItem(*item, materials), IsEmpty()) << message.name();
  }
  for (const auto& message : collection.templates) {
    if (message.kind_case() != v1::Template::KIND_NOT_SET) continue;
    const auto bundle = BundleOf(collection, message.name());
    ASSERT_TRUE(bundle.ok()) << bundle.status();
    EXPECT_THAT(ValidateTemplate(*bundle), IsEmpty()) << Listed(ValidateTemplate(*bundle));
  }
}

TEST_F(ValidationTest, ReportsAllThatIsWrongAtOnce) {
  table_.name = "table";
  table_.parameters[1].name = "length";
  table_.parameters[2].maximum = 0.1;
  table_.parameters[3].default_value = NAN;
  table_.parameters[4].name = "sin";
  table_.parts[0].item = "items/nothing";
  table_.parts[1].name = "2nd leg";
  BoxOf(2).x.to = "lenght / 2";
  table_.parts[3].thickness_axis = table_.parts[3].length_axis;
  Top().axis = Axis::kX;
  table_.connections[0].face = "side7";
  table_.connections[1].part = "apron";
  table_.connections[2].spacing = -1;
  table_.connections[3].item = "items/spruce-planed-2400";
  table_.connections[4].depth_in_part = 1;
  table_.boundary_conditions[0].part = "foot";
  table_.boundary_conditions[4].components.pop_back();
  const std::vector<FieldViolation> findings = ValidateTemplate(bundle_);
  for (const char* field :
       {"name", "parameters[1].name", "parameters[2].maximum", "parameters[3].default_value",
        "parameters[4].name", "parts[0].item", "parts[1].name", "parts[2].box.x.to",
        "parts[3].thickness_axis", "parts[8].prism.axis", "connections[0].face",
        "connections[1].part", "connections[2].spacing", "connections[3].item",
        "connections[4].depth_in_part", "boundary_conditions[0].part",
        "boundary_conditions[4].components"}) {
    EXPECT_THAT(findings, Contains(At(field))) << Listed(findings);
  }
  const absl::Status status = ToStatus(findings);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(status).field, "name");
  EXPECT_THAT(std::string(status.message()), HasSubstr("there is no parameter 'lenght'"));
}

// What cannot be read hides nothing, and what follows from it is no fault.
TEST_F(ValidationTest, ReportsWhatCannotBeReadWithAllElse) {
  v1::Template message = ToProto(table_);
  const auto places = [&] {
    std::vector<std::string> fields;
    for (const FieldViolation& finding :
         ValidateTemplateMessage(message, bundle_.items, bundle_.materials)) {
      fields.push_back(finding.field);
    }
    return fields;
  };
  EXPECT_THAT(places(), IsEmpty());
  message.mutable_parts(0)->clear_length_axis();
  message.mutable_parts(1)->clear_body();
  message.mutable_parts(8)->mutable_prism()->clear_axis();
  message.mutable_parts(7)->clear_thickness_axis();
  message.mutable_boundary_conditions(0)->clear_kind();
  message.mutable_boundary_conditions(0)->add_components("nobody");
  const std::vector<std::string> unread = {"parts[0].length_axis", "parts[1].body",
                                           "parts[7].thickness_axis", "parts[8].prism.axis",
                                           "boundary_conditions[0].kind"};
  EXPECT_THAT(places(), ::testing::UnorderedElementsAreArray(unread));
  message.mutable_parameters(0)->set_maximum(-1);
  message.mutable_parameters(1)->set_name(message.parameters(0).name());
  message.mutable_parameters(2)->set_unit("furlong");
  message.mutable_parts(0)->set_item("items/nothing");
  message.mutable_parts(1)->set_name("2nd leg");
  std::vector<std::string> found = places();
  for (const char* field : {"parts[0].item", "parts[1].name", "parameters[0].maximum",
                            "parameters[1].name", "parameters[2].unit"}) {
    EXPECT_THAT(found, Contains(field));
  }
  for (const std::string& field : unread) EXPECT_THAT(found, Contains(field));
  // Nor does what is missing altogether.
  message.clear_parts();
  found = places();
  for (const char* field : {"parts", "parameters[0].maximum", "parameters[2].unit"}) {
    EXPECT_THAT(found, Contains(field));
  }
}

TEST_F(ValidationTest, FindsPartsThatPenetrate) {
  BoxOf(4).x.from = "-length / 2 + 0.03";
  EXPECT_THAT(ValidateTemplate(bundle_), Contains(At("parts[4]", "penetrates 'leg_front_left'")));
}

TEST_F(ValidationTest, FindsConnectionsWithoutContact) {
  BoxOf(5).x.to = "length / 2 - 0.04 - leg_section";
  EXPECT_THAT(ValidateTemplate(bundle_), Contains(At("connections[7]", "does not touch")));
}

TEST_F(ValidationTest, FindsReversedExtents) {
  std::swap(BoxOf(0).z.from, BoxOf(0).z.to);
  EXPECT_THAT(ValidateTemplate(bundle_), Contains(At("parts[0].box.z", "not greater")));
}

TEST_F(ValidationTest, FindsTangledOutlines) {
  std::swap(Top().outline[0], Top().outline[2]);
  EXPECT_THAT(ValidateTemplate(bundle_), Contains(At("parts[8].prism.outline", "simple")));
}

TEST_F(ValidationTest, FindsClockwiseOutlines) {
  std::reverse(Top().outline.begin(), Top().outline.end());
  EXPECT_THAT(ValidateTemplate(bundle_),
              Contains(At("parts[8].prism.outline", "counter-clockwise")));
}

TEST_F(ValidationTest, LumberHasOutlinesAcrossItsLengthAlone) {
  // The front apron lies along x and is crosscut: an outline of its face has mitres.
  Prism mitred = Top();
  mitred.axis = Axis::kY;
  table_.parts[4].body = mitred;
  EXPECT_THAT(ValidateTemplate(bundle_), Not(Contains(At("parts[4].prism.axis"))));
  EXPECT_THAT(ValidateTemplate(bundle_), Not(Contains(At("parts[4].prism"))));
  mitred.axis = Axis::kX;
  table_.parts[4].body = mitred;
  EXPECT_THAT(ValidateTemplate(bundle_),
              Contains(At("parts[4].prism.axis", "must not be the part's length_axis")));
}

TEST_F(ValidationTest, FindsSizesTheItemDoesNotCome) {
  const Collection collection = ShippedCollection();
  for (const auto& message : collection.items) {
    if (message.name() == "items/board-19x89") bundle_.items.push_back(*FromProto(message));
  }
  table_.parts[4].item = "items/board-19x89";
  const auto findings = ValidateTemplate(bundle_);
  EXPECT_THAT(findings, Contains(At("parts[4].item", "width of 'apron_front' is 0.09")))
      << Listed(findings);
  EXPECT_THAT(findings, Contains(At("parts[4].item", "sold only with 0.019")));
}

// What only goes wrong away from the defaults is found too, and the message says where.
TEST_F(ValidationTest, FindsLengthsBeyondTheStock) {
  table_.parameters[0].maximum = 3;
  const auto findings = ValidateTemplate(bundle_);
  EXPECT_THAT(findings, Contains(At("parts[8].item", "length of 'top' is 3 m")))
      << Listed(findings);
  EXPECT_THAT(findings, Contains(At("parts[8].item", "length = 3")));
}

TEST_F(ValidationTest, FindsPegsThatStickOut) {
  for (Connection& connection : table_.connections) {
    if (connection.name == "top_leg_front_left") connection.depth_in_part = 0.1;
  }
  EXPECT_THAT(ValidateTemplate(bundle_), Contains(At("connections[8]", "sticks out of 'top'")));
}

// A range in millimetres, taken for metres: a peg every few centimetres of 30 km.
TEST_F(ValidationTest, BoundsRowsOfPegs) {
  table_.parameters[0].maximum = 30e3;
  const std::vector<FieldViolation> findings = ValidateTemplate(bundle_);
  const auto row = std::find_if(
      findings.begin(), findings.end(),
      [](const FieldViolation& finding) { return finding.field.ends_with(".spacing"); });
  ASSERT_NE(row, findings.end()) << Listed(findings);
  EXPECT_THAT(row->message, HasSubstr("more than 1000 pegs in a row"));
  EXPECT_THAT(row->message, HasSubstr("at length = ")) << "which parameter makes it so long";
  // As far as numbers go.
  table_.parameters[0].maximum = 1e300;
  EXPECT_THAT(ValidateTemplate(bundle_), Not(IsEmpty()));
}

TEST_F(ValidationTest, BoundsPegsInAll) {
  const std::vector<Connection> connections = table_.connections;
  for (int copy = 0; copy < 100; ++copy) {
    for (Connection connection : connections) {
      connection.name += "_" + std::to_string(copy);
      connection.spacing = 0.02;
      table_.connections.push_back(connection);
    }
  }
  const std::vector<FieldViolation> findings = ValidateTemplate(bundle_);
  EXPECT_THAT(findings, Contains(At("connections", "more than 10000 pegs"))) << Listed(findings);
}

TEST_F(ValidationTest, FindsDivisionByZero) {
  BoxOf(0).z.to = "height - top_thickness + 0 / (length - 1.4)";
  EXPECT_THAT(ValidateTemplate(bundle_), Contains(At("parts[0].box.z.to", "divides by zero")));
}

TEST_F(ValidationTest, LimitsWhatItLooksAt) {
  table_.parts.resize(1000, table_.parts[0]);
  const auto findings = ValidateTemplate(bundle_);
  EXPECT_THAT(findings, Contains(At("parts", "1000 entries")));
  EXPECT_EQ(findings.size(), 1u);
}

TEST_F(ValidationTest, LimitsTextsAndKnowsUnits) {
  table_.title = std::string(201, 'x');
  table_.description = std::string(10'001, 'x');
  table_.parameters[0].title = std::string(201, 'x');
  table_.parameters[0].unit = "furlong";
  table_.parts[1].title = std::string(201, 'x');
  const auto findings = ValidateTemplate(bundle_);
  for (const char* field :
       {"title", "description", "parameters[0].title", "parameters[0].unit", "parts[1].title"}) {
    EXPECT_THAT(findings, Contains(At(field))) << Listed(findings);
  }
  EXPECT_EQ(findings.size(), 5u) << Listed(findings);
}

TEST_F(ValidationTest, ChecksItems) {
  Item item = bundle_.items[1];
  ASSERT_THAT(ValidateItem(item, bundle_.materials), IsEmpty());
  item.name = "panel";
  item.material = "materials/cheese";
  item.dimensions[0].size = -1;
  item.dimensions[1].minimum = 2;
  item.dimensions[2].maximum = NAN;
  item.price.amount = -1;
  item.price.currency = "euro";
  item.price_date = "yesterday";
  const auto findings = ValidateItem(item, bundle_.materials);
  for (const char* field :
       {"name", "material", "dimensions[X].size", "dimensions[Y].maximum", "dimensions[Z].maximum",
        "price.amount", "price.currency", "price_date"}) {
    EXPECT_THAT(findings, Contains(At(field))) << Listed(findings);
  }
}

TEST_F(ValidationTest, ChecksMaterials) {
  Material material = bundle_.materials[0];
  ASSERT_THAT(ValidateMaterial(material), IsEmpty());
  material.density = 0;
  material.youngs_modulus = INFINITY;
  material.poissons_ratio = 0.5;
  material.thermal_expansion = -1;
  const auto findings = ValidateMaterial(material);
  for (const char* field : {"density", "youngs_modulus", "poissons_ratio", "thermal_expansion"}) {
    EXPECT_THAT(findings, Contains(At(field)));
  }
  EXPECT_THAT(findings, Not(Contains(At("name"))));
}

}  // namespace
}  // namespace mortise::parametric
