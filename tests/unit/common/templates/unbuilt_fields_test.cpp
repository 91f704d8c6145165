#include "common/templates/unbuilt_fields.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"

namespace mortise::templates {
namespace {

// The first unbuilt field of a template that has one.
std::string FieldOf(const v1::Template& message) {
  const absl::Status status = CheckNoUnbuiltFields(message);
  return absl::IsUnimplemented(status) ? DetailOf(status).field : status.ToString();
}

TEST(UnbuiltFieldsTest, NamesWhatTemplatesCannotDoYet) {
  v1::Template message;
  message.add_parameters()->set_name("width");
  message.add_parts();
  message.add_connections();
  message.add_boundary_conditions();
  EXPECT_TRUE(CheckNoUnbuiltFields(message).ok());
  message.mutable_boundary_conditions(0)->set_present("width > 1");
  EXPECT_EQ(FieldOf(message), "boundary_conditions[0].present");
  message.mutable_connections(0)->set_row_spacing(0.1);
  EXPECT_EQ(FieldOf(message), "connections[0].row_spacing");
  message.add_parts()->add_repeat()->set_count("3");
  EXPECT_EQ(FieldOf(message), "parts[1].repeat");
  message.mutable_parts(0)->set_present("width > 1");
  EXPECT_EQ(FieldOf(message), "parts[0].present");
  message.mutable_parameters(0)->add_choices("oak");
  EXPECT_EQ(FieldOf(message), "parameters[0].choices");
}

TEST(UnbuiltFieldsTest, NamesThemInOtherKinds) {
  v1::Template cad;
  cad.mutable_cad()->add_features();
  EXPECT_TRUE(CheckNoUnbuiltFields(cad).ok());
  cad.mutable_cad()->mutable_features(0)->set_present("depth > 0");
  EXPECT_EQ(FieldOf(cad), "cad.features[0].present");
  v1::Template cage;
  cage.mutable_cage()->add_conditions()->set_present("depth > 0");
  EXPECT_EQ(FieldOf(cage), "cage.conditions[0].present");
}

TEST(UnbuiltFieldsTest, RefusesValuesByName) {
  google::protobuf::RepeatedPtrField<v1::ParameterValue> values;
  v1::ParameterValue& value = *values.Add();
  value.set_name("wood");
  value.set_value(1);
  EXPECT_TRUE(CheckNoChoices(values).ok());
  value.set_choice("oak");
  EXPECT_EQ(DetailOf(CheckNoChoices(values)).field, "parameters[0].choice");
}

}  // namespace
}  // namespace mortise::templates
