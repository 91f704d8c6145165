// A flag is declared once: it is parsed, shown in the help, and named in faults of its field.
#include "cli/client/command_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "common/base/errors.h"

namespace mortise::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct CutOptions {
  std::string design;
  std::vector<std::string> parameters;
  double kerf = 0.003;
  int copies = 1;
};

// A command "cut" whose service finds what is wrong with the field `fault`.
class CommandFlagsTest : public testing::Test {
 protected:
  CommandFlagsTest() {
    CommandFlags flags(*app_.add_subcommand("cut", "Cut a design"));
    flags.Add("design", options_->design, "What to cut", "plan.template")->required();
    flags.Add("--set", options_->parameters, "NAME=VALUE", "plan.parameters");
    flags.Add("--kerf", options_->kerf, "Width of a saw cut", "rules.kerf");
    flags.Add("--copies", options_->copies, "How many");
    flags.AlsoGives("--set", "points[0]");
    flags.Run(session_, [this, options = options_](Session&, Output&) {
      parsed_ = *options;
      return fault_.empty() ? absl::OkStatus() : InvalidField(fault_, "is wrong");
    });
  }

  absl::Status Run(const std::vector<std::string>& arguments, const std::string& fault = "") {
    fault_ = fault;
    app_.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    Output output(Output::Form::kSilent);
    return session_.command(session_, output);
  }

  std::string FaultOf(const std::string& field) {
    return DetailOf(Run({"cut", "table", "--set", "length=2", "--set", "width=1"}, field)).field;
  }

  CLI::App app_;
  Session session_;
  std::shared_ptr<CutOptions> options_ = std::make_shared<CutOptions>();
  CutOptions parsed_;
  std::string fault_;
};

TEST_F(CommandFlagsTest, ParsesWhatWasDeclared) {
  EXPECT_TRUE(Run({"cut", "table", "--set", "length=2", "--kerf", "0.004", "--copies", "3"}).ok());
  EXPECT_EQ(parsed_.design, "table");
  EXPECT_THAT(parsed_.parameters, ElementsAre("length=2"));
  EXPECT_EQ(parsed_.kerf, 0.004);
  EXPECT_EQ(parsed_.copies, 3);
}

TEST_F(CommandFlagsTest, HelpShowsEachFlag) {
  const std::string help = app_.get_subcommand("cut")->help();
  for (const char* const text : {"--set", "NAME=VALUE", "--kerf", "Width of a saw cut", "design"}) {
    EXPECT_THAT(help, HasSubstr(text));
  }
}

TEST_F(CommandFlagsTest, FaultsOfFieldsNameTheFlag) {
  EXPECT_EQ(FaultOf("rules.kerf"), "--kerf");
  EXPECT_EQ(FaultOf("plan.template"), "design");
  EXPECT_EQ(FaultOf("plan.parameters[1].value"), "--set width");
  EXPECT_EQ(FaultOf("plan.parameters"), "--set");
  EXPECT_EQ(FaultOf("points[0].x"), "--set");
  EXPECT_EQ(FaultOf("copies"), "copies") << "no flag says that it gives this field";
}

TEST_F(CommandFlagsTest, CommandsMayNameSourcesThatDependOnWhatWasGiven) {
  CommandFlags flags(*app_.add_subcommand("look", "Look at a design"));
  flags.Run(session_, [](FieldSources& sources, Session&, Output&) {
    sources.Add("q", "--from");
    return InvalidField("q[2]", "is wrong");
  });
  EXPECT_EQ(DetailOf(Run({"look"})).field, "--from");
}

}  // namespace
}  // namespace mortise::cli
