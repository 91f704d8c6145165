// Parameters given by number or, where they are choices, by name.
#include "common/evaluation/parameter_number.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.h"

namespace mortise::evaluation {
namespace {

using ::testing::HasSubstr;

google::protobuf::RepeatedPtrField<std::string> Arms() {
  google::protobuf::RepeatedPtrField<std::string> choices;
  *choices.Add() = "none";
  *choices.Add() = "both";
  return choices;
}

absl::StatusOr<double> Number(double value, const std::string& choice, bool is_choice = true) {
  v1::ParameterValue given;
  given.set_name("arms");
  given.set_value(value);
  given.set_choice(choice);
  return NumberOf(given, is_choice ? Arms() : google::protobuf::RepeatedPtrField<std::string>(),
                  "fixed[2]");
}

TEST(ParameterNumber, IsTheValueOrThatOfTheName) {
  EXPECT_EQ(*Number(0.5, "", false), 0.5);
  EXPECT_EQ(*Number(1, ""), 1);
  EXPECT_EQ(*Number(0, "both"), 1);
  EXPECT_EQ(*Number(1, "both"), 1);
  EXPECT_EQ(*Number(0, "none"), 0);
}

TEST(ParameterNumber, RefusesNamesThatSaySomethingElse) {
  for (const auto& [status, fault] :
       {std::pair(Number(0, "left").status(), "'arms' has no value 'left'; it has none, both"),
        std::pair(Number(1, "none").status(), "'none' is value 0 of 'arms', not 1"),
        std::pair(Number(0, "both", false).status(), "'arms' is a number, no choice")}) {
    EXPECT_EQ(DetailOf(status).field, "fixed[2].choice");
    EXPECT_THAT(status.message(), HasSubstr(fault));
  }
}

}  // namespace
}  // namespace mortise::evaluation
