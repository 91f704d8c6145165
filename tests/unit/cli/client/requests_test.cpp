// What people write for requests, and what they read of results.
#include "cli/client/requests.h"

#include <google/protobuf/dynamic_message.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/client/decimal_flags.h"
#include "cli/client/json_input.h"
#include "cli/client/output.h"
#include "common/base/errors.h"
#include "mortise/v1/fabplanner.pb.h"

namespace mortise::cli {
namespace {

TEST(Requests, VectorsAreThreeNumbers) {
  const auto vector = ParseVector("-10, 0,2.5e-1", "--wind");
  ASSERT_TRUE(vector.ok()) << vector.status();
  EXPECT_EQ(vector->x(), -10);
  EXPECT_EQ(vector->y(), 0);
  EXPECT_EQ(vector->z(), 0.25);
  for (const char* const text :
       {"", "1", "1, 2", "1, 2, 3, 4", "1, 2, x", "1, , 3", "1, 2, nan", "inf, 0, 0", "1 2 3"}) {
    const absl::Status status = ParseVector(text, "--wind").status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_EQ(DetailOf(status).field, "--wind") << text;
  }
}

TEST(Requests, DemandsNameAnElementAndALengthOfIt) {
  const auto size = ParseDemand("shelf 1.x=1200mm");
  ASSERT_TRUE(size.ok()) << size.status();
  EXPECT_EQ(size->measure().element(), "shelf 1");
  EXPECT_EQ(size->measure().axis(), v1::X);
  EXPECT_EQ(size->measure().kind(), v1::Measure::KIND_UNSPECIFIED);
  EXPECT_DOUBLE_EQ(size->value(), 1.2);
  const auto place = ParseDemand("dowel 1.2.z.maximum=0.7");
  ASSERT_TRUE(place.ok()) << place.status();
  EXPECT_EQ(place->measure().element(), "dowel 1.2");
  EXPECT_EQ(place->measure().axis(), v1::Z);
  EXPECT_EQ(place->measure().kind(), v1::Measure::MAXIMUM);
  for (const char* const text : {"", "shelf 1", "shelf 1.x", "shelf 1=2", "shelf 1.x.top=2"}) {
    EXPECT_FALSE(ParseDemand(text).ok()) << text;
  }
}

TEST(Requests, LengthsAreDecimal) {
  EXPECT_DOUBLE_EQ(ParseQuantity("1500mm", "--set a").value_or(0), 1.5);
  EXPECT_DOUBLE_EQ(ParseQuantity(" 2.5e1 cm ", "--set a").value_or(0), 0.25);
  EXPECT_DOUBLE_EQ(ParseQuantity("0", "--kerf").value_or(1), 0);
  for (const char* const text : {"0x10", "0x10mm", "inf", "nan", "1e400", "1_000mm", "1,5mm", ""}) {
    const absl::Status status = ParseQuantity(text, "--kerf").status();
    EXPECT_EQ(DetailOf(status).field, "--kerf") << text;
  }
  // What is no unit is not blamed for what is no number.
  for (const char* const text : {"0x10", "1_000mm", "1,5 mm"}) {
    EXPECT_EQ(
        ParseQuantity(text, "--set a").status().message(),
        absl::StrCat("--set a: '", text,
                     "' is no decimal number, such as 12.5m; units: m, cm, mm, in, \", deg, rad"));
  }
  EXPECT_EQ(ParseQuantity("3 yd", "--set a").status().message(),
            "--set a: 'yd' is not a unit known here: m, cm, mm, in, \", deg, rad");
  EXPECT_FALSE(ParseMetricValue("0x10 kg", "--at").ok());
  EXPECT_FALSE(ParseVector("0x1, 2, 3", "--wind").ok());
}

TEST(Requests, InchesMayBeFractions) {
  EXPECT_DOUBLE_EQ(ParseLength("1/8\"", "--kerf").value_or(0), 0.0254 / 8);
  EXPECT_DOUBLE_EQ(ParseLength("0.125in", "--kerf").value_or(0), 0.0254 / 8);
  EXPECT_DOUBLE_EQ(ParseLength("1 3/4 in", "--kerf").value_or(0), 1.75 * 0.0254);
  EXPECT_DOUBLE_EQ(ParseLength("-1/8 \"", "--kerf").value_or(0), -0.0254 / 8);
  EXPECT_DOUBLE_EQ(ParseMetricValue("1/2in", "--at").value_or(0), 0.0127);
  // Of millimetres, or without a unit, a fraction would be a slip; and none is of nothing.
  for (const char* const text : {"1/8", "1/8mm", "1/0in", "1/-8in", "1/2/3in", "/8in", "1//8in"}) {
    const absl::Status status = ParseLength(text, "--kerf").status();
    EXPECT_EQ(DetailOf(status).field, "--kerf") << text;
  }
  EXPECT_EQ(ParseLength("3,2mm", "--kerf").status().message(),
            "--kerf: '3,2mm' is no decimal number, such as 12.5m; units: m, cm, mm, in, \"");
  EXPECT_FALSE(CheckUnit("1/8\"", "kg", "--limit mass").ok());
}

TEST(Requests, LengthsAreNoAnglesNorTheOtherWayRound) {
  EXPECT_DOUBLE_EQ(ParseLength("3mm", "--kerf").value_or(0), 0.003);
  EXPECT_DOUBLE_EQ(ParseLength("0.003", "--kerf").value_or(0), 0.003);
  EXPECT_DOUBLE_EQ(ParseAngle("45deg", "--mitre-limit").value_or(0), M_PI / 4);
  EXPECT_DOUBLE_EQ(ParseAngle("0.5 rad", "--mitre-limit").value_or(0), 0.5);
  const absl::Status angle = ParseLength("3deg", "--kerf").status();
  EXPECT_EQ(DetailOf(angle).field, "--kerf");
  EXPECT_EQ(angle.message(), "--kerf: '3deg' is not a length, which is in m, cm, mm, in, \"");
  const absl::Status length = ParseAngle("45mm", "--mitre-limit").status();
  EXPECT_EQ(DetailOf(length).field, "--mitre-limit");
  EXPECT_EQ(length.message(), "--mitre-limit: '45mm' is not an angle, which is in deg, rad");
  EXPECT_FALSE(ParseDemand("shelf 1.x=3deg").ok());
}

// What begins as no number does is the name of a choice's value; the service knows which there are.
TEST(Requests, ParametersAreLengthsOrNamesOfValues) {
  const auto values = ParseParameters({"width=520mm", "armrests= both ", "top=left only"});
  ASSERT_TRUE(values.ok()) << values.status();
  EXPECT_EQ((*values)[0].value(), 0.52);
  EXPECT_EQ((*values)[0].choice(), "");
  EXPECT_EQ((*values)[1].name(), "armrests");
  EXPECT_EQ((*values)[1].choice(), "both");
  EXPECT_EQ((*values)[1].value(), 0);
  EXPECT_EQ((*values)[2].choice(), "left only");
  for (const char* const text : {"width", "=both", "width=", "width=3 yd", "width=1,5"}) {
    EXPECT_FALSE(ParseParameters({text}).ok()) << text;
  }
}

TEST(Requests, RefusesUnitsOfSomethingElse) {
  for (const char* const text : {"18", "18kg", "500 g", ":2kg", "100g:", "1:2kg"}) {
    EXPECT_TRUE(CheckUnit(text, "kg", "--limit mass").ok()) << text;
  }
  for (const char* const text : {"18mm", ":18 mm", "1kg:2MPa", "3Hz"}) {
    const absl::Status status = CheckUnit(text, "kg", "--limit mass");
    EXPECT_EQ(DetailOf(status).field, "--limit mass") << text;
  }
  EXPECT_EQ(CheckUnit("18mm", "kg", "--limit mass").message(),
            "--limit mass: 'mm' is no unit of it: it is in kg");
  EXPECT_FALSE(CheckUnit("2mm", "rad", "--limit tilt").ok());
  EXPECT_FALSE(CheckUnit("2mm", "", "--limit ratio").ok());
  EXPECT_FALSE(HasUnit("18:"));
  EXPECT_TRUE(HasUnit(":18 mm"));
}

// What the command line makes of `--modes TEXT` and `--size TEXT`.
struct Flags {
  int count = -1;
  double size = -1;
  std::string name;
};

std::string FlagsOf(const std::vector<std::string>& arguments, Flags& flags) {
  CLI::App app;
  CLI::App* const command = app.add_subcommand("analyze");
  command->add_option("--count", flags.count)->check(CLI::PositiveNumber);
  command->add_option("--size", flags.size);
  command->add_option("--name", flags.name);
  RequireDecimalNumbers(app);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  reversed.push_back("analyze");
  try {
    app.parse(std::move(reversed));
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

TEST(Requests, NumbersOfFlagsAreDecimal) {
  Flags flags;
  EXPECT_EQ(FlagsOf({"--count", "010", "--size", "-0.5", "--name", "0x10"}, flags), "");
  EXPECT_EQ(flags.count, 10);
  EXPECT_EQ(flags.size, -0.5);
  EXPECT_EQ(flags.name, "0x10");
  for (const char* const text : {"0x10", "inf", "nan", "1e400", "0b1", "1_0"}) {
    EXPECT_NE(FlagsOf({"--size", text}, flags).find("decimal notation"), std::string::npos) << text;
    EXPECT_NE(FlagsOf({"--count", text}, flags).find("decimal notation"), std::string::npos)
        << text;
  }
}

TEST(Requests, JsonMayBeginWithAByteOrderMark) {
  v1::Metric metric;
  const absl::Status read = ReadJson("\xEF\xBB\xBF{\"name\": \"mass\"}", "case.json", metric);
  ASSERT_TRUE(read.ok()) << read;
  EXPECT_EQ(metric.name(), "mass");
  const absl::Status wide = ReadJson(std::string("{\0\"\0", 4), "case.json", metric);
  EXPECT_EQ(DetailOf(wide).field, "case.json");
  EXPECT_NE(wide.message().find("UTF-16"), absl::string_view::npos) << wide;
}

std::string TextOf(double value, const std::string& unit) {
  v1::Metric metric;
  metric.set_value(value);
  metric.set_unit(unit);
  return MetricText(metric);
}

// As `mortise call` reads and prints messages whose types it learns from the gateway.
TEST(Requests, LabelsAreJsonObjects) {
  google::protobuf::DynamicMessageFactory factory;
  const std::unique_ptr<google::protobuf::Message> request(
      factory.GetPrototype(v1::CreatePlanRequest::descriptor())->New());
  const absl::Status read =
      ReadJson(R"({"external_ids": ["100-4711/A"], "labels": {"customer": "acme", "draft": ""}})",
               "request", *request);
  ASSERT_TRUE(read.ok()) << read;
  v1::CreatePlanRequest sent;
  ASSERT_TRUE(sent.ParseFromString(request->SerializeAsString()));
  EXPECT_EQ(sent.external_ids(0), "100-4711/A");
  EXPECT_EQ(sent.labels().at("customer"), "acme");
  EXPECT_TRUE(sent.labels().contains("draft"));
  EXPECT_EQ(ToJson(*request)["labels"],
            (nlohmann::ordered_json{{"customer", "acme"}, {"draft", ""}}));
  EXPECT_EQ(DetailOf(ReadJson(R"({"labels": {"customer": 7}})", "request", *request)).field,
            "request: labels[\"customer\"]");
  EXPECT_EQ(DetailOf(ReadJson(R"({"labels": ["customer=acme"]})", "request", *request)).field,
            "request: labels");
}

TEST(Requests, MetricsHaveUnitsThatPeopleUse) {
  EXPECT_EQ(TextOf(0.0125, "m"), "12.5 mm");
  EXPECT_EQ(TextOf(3.5e7, "Pa"), "35 MPa");
  EXPECT_EQ(TextOf(-3.5e7, "Pa"), "-35 MPa");
  EXPECT_EQ(TextOf(59.75, "Pa"), "59.75 Pa");
  EXPECT_EQ(TextOf(-81.2, "Pa"), "-81.2 Pa");
  EXPECT_EQ(TextOf(2.25, "kg"), "2.25 kg");
}

}  // namespace
}  // namespace mortise::cli
