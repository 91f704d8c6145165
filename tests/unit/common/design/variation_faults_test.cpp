// What is wrong with choices, absent parts, copies and items by condition: all with its place, as
// written, at the parameters where it happens, or on import.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/evaluation.h"
#include "common/design/parameter_values.h"
#include "common/design/template_validation.h"
#include "tests/unit/common/design/varied_shelf.h"

namespace mortise::parametric {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

using Change = std::function<void(TemplateDefinition&)>;

std::vector<FieldViolation> FindingsOf(const Change& change) {
  TemplateBundle bundle = VariedShelf();
  change(bundle.definition);
  return ValidateTemplate(bundle);
}

void ExpectFault(const std::string& field, const std::string& message, const Change& change) {
  const std::vector<FieldViolation> findings = FindingsOf(change);
  const auto is_it = [&](const FieldViolation& finding) {
    return finding.field == field && finding.message.find(message) != std::string::npos;
  };
  std::string found;
  for (const FieldViolation& finding : findings) {
    absl::StrAppend(&found, "\n  ", finding.field, ": ", finding.message);
  }
  EXPECT_TRUE(std::any_of(findings.begin(), findings.end(), is_it))
      << field << ": " << message << " is not among" << found;
}

TEST(VariationFaults, ChoicesThatAreNone) {
  const auto top = [](auto change) {
    return [change](TemplateDefinition& shelf) { change(shelf.parameters[3]); };
  };
  ExpectFault("parameters[3].choices", "are 1; 2 to 1000",
              top([](Parameter& choice) { choice.choices = {"none"}; }));
  ExpectFault("parameters[3].choices[1]", "'none' is there twice", top([](Parameter& choice) {
                choice.choices = {"none", "none"};
              }));
  for (const char* name : {"", "a,b", "it's", " a", "a ", "a\nb", "a\"b"}) {
    ExpectFault("parameters[3].choices[0]", "must be 1 to 100 bytes",
                top([name](Parameter& choice) {
                  choice.choices = {name, "flat"};
                }));
  }
  ExpectFault("parameters[3].choices[0]", "must be 1 to 100 bytes",
              top([](Parameter& choice) { choice.choices[0] = std::string(101, 'a'); }));
  ExpectFault("parameters[3].unit", "must be 1, or left out",
              top([](Parameter& choice) { choice.unit = "m"; }));
  ExpectFault("parameters[3].minimum", "must be 0",
              top([](Parameter& choice) { choice.minimum = -1; }));
  ExpectFault("parameters[3].maximum", "must be 1",
              top([](Parameter& choice) { choice.maximum = 2; }));
  ExpectFault("parameters[3].step", "must be 1", top([](Parameter& choice) { choice.step = 0.5; }));
  ExpectFault("parameters[3].default_value", "must be the number of a value, 0 to 1, not 0.5",
              top([](Parameter& choice) { choice.default_value = 0.5; }));
  Parameter left_out{.name = "top",
                     .title = "",
                     .description = "",
                     .unit = "",
                     .choices = {"none", "flat", "round"}};
  FillChoice(left_out);
  EXPECT_EQ(left_out.unit, "1");
  EXPECT_EQ(left_out.maximum, 2);
  EXPECT_EQ(left_out.step, 1);
}

TEST(VariationFaults, PresenceThatIsNoCondition) {
  for (const char* text : {"1", "width", "0.5 * depth"}) {
    ExpectFault("parts[3].present", "expected a condition, such as a comparison",
                [text](TemplateDefinition& shelf) { shelf.parts[3].present = text; });
    ExpectFault("connections[2].present", "expected a condition",
                [text](TemplateDefinition& shelf) { shelf.connections[2].present = text; });
    ExpectFault("boundary_conditions[2].present", "expected a condition",
                [text](TemplateDefinition& shelf) { shelf.boundary_conditions[2].present = text; });
  }
  ExpectFault("parts[3].present", "'top' has no value 'flt'; it has 'none', 'flat'",
              [](TemplateDefinition& shelf) { shelf.parts[3].present = "top == 'flt'"; });
  ExpectFault("parts[3].present", "there is no parameter 'height'",
              [](TemplateDefinition& shelf) { shelf.parts[3].present = "height > 1"; });
  // Conditions are of parameters, so that none can depend on itself.
  ExpectFault("parts[3].present", "there is no parameter 'left'",
              [](TemplateDefinition& shelf) { shelf.parts[3].present = "left == 'flat'"; });
  ExpectFault("parts[3].present", "divides by zero", [](TemplateDefinition& shelf) {
    shelf.parts[3].present = "1 / (shelves - 1) > 0.1";
  });
  ExpectFault("parts[0].box.x.to", "'top' is a choice", [](TemplateDefinition& shelf) {
    std::get<Box>(shelf.parts[0].body).x.to = "0.02 * top";
  });
}

// Found over all combinations of choices, though not at the defaults.
TEST(VariationFaults, ConnectionsAndConditionsWithoutTheirPart) {
  ExpectFault("connections[2].part", "'top' is absent where this is present",
              [](TemplateDefinition& shelf) { shelf.connections[2].present.clear(); });
  ExpectFault("connections[2].part", "top = none, wood = oak", [](TemplateDefinition& shelf) {
    shelf.connections[2].present = "top == 'flat' or wood == 'oak'";
  });
  ExpectFault("connections[1].other_part", "'right' is absent", [](TemplateDefinition& shelf) {
    shelf.parts[1].present = "not (wood == 'oak' and top == 'flat')";
  });
  ExpectFault("boundary_conditions[2].part", "'top' is absent",
              [](TemplateDefinition& shelf) { shelf.boundary_conditions[2].present = ""; });
  ExpectFault("parts", "are all absent", [](TemplateDefinition& shelf) {
    shelf.connections.clear();
    shelf.boundary_conditions.clear();
    for (PartTemplate& part : shelf.parts) part.present = "wood == 'oak'";
  });
}

TEST(VariationFaults, CountsThatAreNone) {
  const auto count = [](const char* text) {
    return [text](TemplateDefinition& shelf) { shelf.parts[2].repeat[0].count = text; };
  };
  ExpectFault("parts[2].repeat[0].count", "is 0, but must be 1 to 1000: 'present' says",
              count("shelves - 3"));
  ExpectFault("parts[2].repeat[0].count", "is -2, but must be 1 to 1000", count("-2"));
  ExpectFault("parts[2].repeat[0].count", "is 1e+06, but must be 1 to 1000", count("1000000"));
  ExpectFault("parts[2].repeat[0].count", "no whole number", count("shelves / 2"));
  ExpectFault("parts[2].repeat[0].count", "expected a number, not a condition",
              count("shelves > 2"));
  ExpectFault("parts[2].repeat[0].count", "column 1", count(""));
  ExpectFault("parts[2].repeat", "makes 3000 parts; a design has at most 2000",
              [](TemplateDefinition& shelf) {
                shelf.connections.clear();
                shelf.boundary_conditions.clear();
                shelf.parts[2].repeat = {{"100", "0", "0", "1"}, {"30", "0", "1", "0"}};
              });
  ExpectFault("parts", "a design has at most 2000", [](TemplateDefinition& shelf) {
    shelf.connections.clear();
    shelf.boundary_conditions.clear();
    for (const std::size_t i : {0, 1, 2}) shelf.parts[i].repeat = {{"800", "", "", "10"}};
  });
  ExpectFault("parts[2].repeat", "has 3 entries; 0 to 2", [](TemplateDefinition& shelf) {
    shelf.parts[2].repeat.assign(3, {"2", "1", "", ""});
  });
}

TEST(VariationFaults, IndicesAndSteps) {
  const auto index = [](const char* name) {
    return [name](TemplateDefinition& shelf) { shelf.parts[2].repeat[0].index = name; };
  };
  ExpectFault("parts[2].repeat[0].index", "'width' is a parameter", index("width"));
  ExpectFault("parts[2].repeat[0].index", "is not an identifier", index("1k"));
  ExpectFault("parts[2].repeat[0].index", "is a word of the expression language", index("sin"));
  ExpectFault("parts[2].repeat[1].index", "'k' is used twice", [](TemplateDefinition& shelf) {
    shelf.parts[2].repeat = {{"2", "", "", "0.3", "k"}, {"2", "", "1", "", "k"}};
  });
  // An index is known in the body alone, and there of its own part.
  ExpectFault("parts[4].repeat[0].z", "there is no parameter 'k'",
              [](TemplateDefinition& shelf) { shelf.parts[4].repeat[0].z = "0.06 + k"; });
  ExpectFault("parts[4].present", "there is no parameter 'k'",
              [](TemplateDefinition& shelf) { shelf.parts[4].present = "k > 1"; });
  ExpectFault("parts[0].box.x.to", "there is no parameter 'k'", [](TemplateDefinition& shelf) {
    std::get<Box>(shelf.parts[0].body).x.to = "0.02 + k";
  });
  // Copies that nothing keeps apart.
  ExpectFault("parts[2]", "'shelf 2' penetrates 'shelf 1'",
              [](TemplateDefinition& shelf) { shelf.parts[2].repeat[0].z = ""; });
  ExpectFault("parts[4].box.x", "'to' is not greater than 'from'", [](TemplateDefinition& shelf) {
    std::get<Box>(shelf.parts[4].body).x.to = "width - 0.1 * k";
  });
}

TEST(VariationFaults, ReferencesToCopies) {
  const auto part = [](const char* name) {
    return [name](TemplateDefinition& shelf) { shelf.boundary_conditions[3].part = name; };
  };
  ExpectFault("boundary_conditions[3].part", "there is no 'shelf 2': 'shelf' is there 1 times",
              part("shelf 2"));
  ExpectFault("boundary_conditions[3].part", "there is no part 'shelf 0'", part("shelf 0"));
  ExpectFault("boundary_conditions[3].part", "is a row, its copies have one number",
              part("shelf 1.2"));
  ExpectFault("boundary_conditions[3].part", "'left' is not repeated", part("left 1"));
  ExpectFault("boundary_conditions[3].part", "there is no part 'board 1'", part("board 1"));
}

TEST(VariationFaults, PairingsThatMeanNothing) {
  ExpectFault("connections[0].pairing", "BY_NUMBER is for two parts that are both repeated",
              [](TemplateDefinition& shelf) { shelf.connections[0].pairing = Pairing::kByNumber; });
  ExpectFault("connections[0].other_part", "with the pairing TOUCHING",
              [](TemplateDefinition& shelf) { shelf.connections[0].other_part = "shelf"; });
  ExpectFault("connections[2].other_part", "a part cannot be joined to itself",
              [](TemplateDefinition& shelf) { shelf.connections[2].other_part = "top"; });
  ExpectFault("connections[0].pairing", "'shelf' is there 3 times and 'slat' 10 times",
              [](TemplateDefinition& shelf) {
                shelf.connections[0].other_part = "slat";
                shelf.connections[0].present = "depth > 0.22 or top == 'flat'";
              });
}

TEST(VariationFaults, ItemsByCondition) {
  const auto item = [](const char* when, const char* name) {
    return [when, name](TemplateDefinition& shelf) { shelf.parts[2].items = {{when, name}}; };
  };
  ExpectFault("parts[2].items[0].when", "column 1", item("", "items/oak"));
  ExpectFault("parts[2].items[0].when", "expected a condition", item("width", "items/oak"));
  ExpectFault("parts[2].items[0].item", "there is no item 'items/ash'",
              item("wood == 'oak'", "items/ash"));
  ExpectFault("parts[2].items[0].item", "joins parts; it cannot be one",
              item("wood == 'oak'", "items/peg"));
  ExpectFault("connections[1].items[0].item", "is no dowel",
              [](TemplateDefinition& shelf) { shelf.connections[1].items[0].item = "items/oak"; });
  ExpectFault("connections[1].spacing", "at least twice the diameter",
              [](TemplateDefinition& shelf) { shelf.connections[1].spacing = 0.012; });
}

TEST(VariationFaults, RowsOfPegs) {
  ExpectFault("connections[0].row_spacing", "at least twice the diameter",
              [](TemplateDefinition& shelf) { shelf.connections[0].row_spacing = 0.001; });
  ExpectFault("connections[0].row_spacing", "at least 0",
              [](TemplateDefinition& shelf) { shelf.connections[0].row_spacing = -1; });
  ExpectFault("connections[0].side_distance", "give their row_spacing",
              [](TemplateDefinition& shelf) { shelf.connections[0].side_distance = 0.01; });
  // A millimetre in the place of a metre.
  ExpectFault("connections[0].spacing", "makes more than 1000 pegs in a row",
              [](TemplateDefinition& shelf) {
                shelf.parameters[1].maximum = 400;
                shelf.connections[0].spacing = 0.05;
              });
}

TEST(VariationFaults, PegsWithoutEnd) {
  TemplateBundle bundle = VariedShelf();
  TemplateDefinition& slab = bundle.definition;
  slab.boundary_conditions.clear();
  slab.parts = {BoxPart("below", {"0", "9"}, {"0", "1.9"}, {"0", "0.1"}),
                BoxPart("above", {"0", "9"}, {"0", "1.9"}, {"0.1", "0.2"})};
  slab.connections = {Pegs("grid", "above", "z_min", "below")};
  slab.connections[0].spacing = slab.connections[0].row_spacing = 0.02;
  const auto function = TemplateFunction::Create(bundle);
  ASSERT_TRUE(function.ok());
  const absl::Status status = function->Evaluate(function->Defaults()).status();
  EXPECT_EQ(DetailOf(status).field, "connections[0].row_spacing");
  EXPECT_THAT(status.message(), HasSubstr("more than 10000"));
}

// An absent part is not looked at: neither its numbers nor its count.
TEST(VariationFaults, NothingIsWrongWithWhatIsAbsent) {
  TemplateBundle bundle = VariedShelf();
  bundle.definition.parts.push_back(
      BoxPart("never", {"1 / 0", "0"}, {"sqrt(-1)", "0"}, {"0", "1"}));
  bundle.definition.parts.back().present = "width < 0";
  bundle.definition.parts.back().repeat = {{"0", "1 / 0", "", ""}};
  EXPECT_THAT(ValidateTemplate(bundle), testing::IsEmpty());
  const auto function = TemplateFunction::Create(bundle);
  ASSERT_TRUE(function.ok());
  EXPECT_TRUE(function->EvaluateMass(function->Defaults()).ok());
}

// A value between two choices is refused with its field.
TEST(VariationFaults, ValuesBetweenChoices) {
  const auto function = TemplateFunction::Create(VariedShelf());
  ASSERT_TRUE(function.ok());
  Eigen::VectorXd q = function->Defaults();
  q(4) = 0.5;
  EXPECT_EQ(DetailOf(function->Evaluate(q).status()).field, "parameters[4].value");
  EXPECT_EQ(DetailOf(function->EvaluateMass(q).status()).field, "parameters[4].value");
  q(4) = 1;
  q(2) = 2.5;  // a whole number that counts
  EXPECT_EQ(DetailOf(function->Evaluate(q).status()).field, "parts[2].repeat[0].count");
}

}  // namespace
}  // namespace mortise::parametric
