// Scripts of `mortise compose run`, in two houses: what they make, and what they say when a line
// fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/files.h"
#include "tests/e2e/command.h"
#include "tests/e2e/running_house.h"
#include "tests/support/temporary_folder.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kTable =
    "# A table that is wider than the one it comes from.\n"
    "new %s --title \"Wide table\"\n"
    "add dining-table --group frame --id frame\n"
    "add dining-table --group top --id top --at \"0.82, 0.44, 0.74\"\n"
    "snap top\n"
    "connect top\n"
    "undo\n"
    "redo\n"
    "drag --node \"long apron 1\" --control width --to 1.5m\n"
    "save\n";

class ComposeRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<RunningHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  void SetUp() override { ASSERT_TRUE(house_->Serving()) << house_->Log(); }

  // The script of the table, of a model of this name.
  static std::string Table(const std::string& model) {
    std::string script = kTable;
    return script.replace(script.find("%s"), 2, model);
  }

  std::filesystem::path Write(const std::string& script) const {
    std::filesystem::path path = folder_.path() / "script.txt";
    EXPECT_TRUE(WriteFile(path, script).ok());
    return path;
  }

  static CommandResult Ask(std::vector<std::string> arguments, const RunningHouse& house) {
    arguments.insert(arguments.begin(), {"--gateway", house.GrpcAddress()});
    return Mortise(arguments);
  }

  CommandResult Run(const std::string& script, std::vector<std::string> flags = {}) const {
    flags.insert(flags.begin(), {"compose", "run", Write(script).string()});
    return Ask(flags, *house_);
  }

  // What came of it, as the one document that is printed.
  Json Document(const std::string& script, std::vector<std::string> flags = {},
                const RunningHouse& house = *house_) const {
    flags.insert(flags.begin(), {"--json", "compose", "run", Write(script).string()});
    const CommandResult result = Ask(flags, house);
    EXPECT_EQ(result.exit_code, 0) << result.error << result.out;
    return Json::parse(result.out, nullptr, false);
  }

  static Json Model(const std::string& id) {
    return Json::parse(Ask({"--json", "compose", "show", id}, *house_).out, nullptr, false);
  }

  const mortise::testing::TemporaryFolder folder_;
  static std::unique_ptr<RunningHouse> house_;
};

std::unique_ptr<RunningHouse> ComposeRun::house_;

TEST_F(ComposeRun, GivesTheSameModelInEveryHouse) {
  const Json here = Document(Table("same-table"));
  EXPECT_EQ(here["template"], "templates/same-table");
  EXPECT_EQ(here["model"], "models/same-table");
  EXPECT_EQ(here["components"], 2);
  EXPECT_EQ(here["warnings"], Json::array());
  EXPECT_EQ(here["digest"].get<std::string>().size(), 64u);
  const RunningHouse other;
  ASSERT_TRUE(other.Serving()) << other.Log();
  const Json there = Document(Table("same-table"), {}, other);
  EXPECT_EQ(there, here);
  const CommandResult planned = Ask({"plan", "same-table"}, *house_);
  EXPECT_EQ(planned.exit_code, 0) << planned.error;
}

TEST_F(ComposeRun, ComposesAnewWhatIsThereAlready) {
  const Json first = Document(Table("again"));
  const CommandResult refused = Run(Table("again"));
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.error, AllOf(HasSubstr("line 2"), HasSubstr("models/again"),
                                   HasSubstr("--anew"), HasSubstr("--model")));
  const Json second = Document(Table("again"), {"--anew"});
  EXPECT_EQ(second["digest"], first["digest"]);
  EXPECT_EQ(first["template_revision"], 1);
  EXPECT_EQ(second["template"], "templates/again");
  const Json third = Document(Table("again"), {"--model", "again-3", "--template", "third"});
  EXPECT_EQ(third["model"], "models/again-3");
  EXPECT_EQ(third["template"], "templates/third");
  EXPECT_EQ(Model("again-3")["parts"], Model("again")["parts"]);
}

TEST_F(ComposeRun, AnewTakesTheTitleOfTheScript) {
  Document(Table("titled"), {"--unsaved"});
  std::string renamed = Table("titled");
  renamed.replace(renamed.find("Wide"), 4, "Long");
  Document(renamed, {"--anew"});
  EXPECT_EQ(Model("titled")["title"], "Long table");
}

TEST_F(ComposeRun, NamesTheLineThatFailsAndGoesOnFromThere) {
  std::string script = Table("failing");
  const std::size_t at = script.find("--to 1.5m");
  script.replace(at, 9, "--to long");
  const CommandResult failed = Run(script);
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.error, AllOf(HasSubstr("line 9"), HasSubstr("--to"),
                                  HasSubstr("as line 8 left it"), HasSubstr("--from-line 9")));
  const Json left = Model("failing");
  EXPECT_EQ(left["last_step"], "connect top");
  EXPECT_EQ(left["components"].size(), 2u);
  const Json mended = Document(Table("failing"), {"--from-line", "9"});
  Document(Table("whole"));
  EXPECT_EQ(Model("failing")["parts"], Model("whole")["parts"]);
  EXPECT_EQ(mended["template"], "templates/failing");
}

TEST_F(ComposeRun, DoesNothingWhereAnyLineIsNoCommand) {
  const std::string script = "new nothing\nadd\nadd dining-table --flavour sweet\nlist\nfly top\n";
  const CommandResult refused = Run(script);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.error, AllOf(HasSubstr("line 2"), HasSubstr("line 3"), HasSubstr("line 4"),
                                   HasSubstr("line 5"), HasSubstr("flavour")));
  EXPECT_NE(Ask({"compose", "show", "nothing"}, *house_).exit_code, 0);
  EXPECT_THAT(Run(Table("late"), {"--from-line", "99"}).error, HasSubstr("--from-line"));
}

TEST_F(ComposeRun, DrawsEveryStepAndTellsOfIt) {
  const std::filesystem::path pictures = folder_.path() / "pictures";
  const CommandResult result = Run(Table("drawn"), {"--unsaved", "--pictures", pictures.string()});
  EXPECT_EQ(result.exit_code, 0) << result.error;
  EXPECT_THAT(result.error, AllOf(HasSubstr("snap top"), HasSubstr("connect top")));
  EXPECT_THAT(result.out, HasSubstr("Wide table"));
  for (const char* const name : {"003-add.png", "004-add.png", "005-snap.png", "006-connect.png",
                                 "007-undo.png", "008-redo.png", "009-drag.png"}) {
    EXPECT_EQ(ReadFile(pictures / name).value_or("").substr(1, 3), "PNG") << name;
  }
  EXPECT_FALSE(std::filesystem::exists(pictures / "002-new.png"));
  EXPECT_NE(ReadFile(pictures / "004-add.png").value(),
            ReadFile(pictures / "005-snap.png").value());
}

// Each composition that ships is held together, and can be planned and exported.
TEST_F(ComposeRun, WhatShipsCanBeBuilt) {
  const char* const source = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path root = source == nullptr ? "." : source;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(root / "collection/compositions")) {
    const std::string script = ReadFile(entry.path()).value_or("");
    const Json made = Document(script);
    ASSERT_TRUE(made.is_object()) << entry.path();
    EXPECT_EQ(made["warnings"], Json::array()) << entry.path();
    const std::string saved = made["template"].get<std::string>().substr(10);
    const CommandResult planned = Ask({"plan", saved}, *house_);
    EXPECT_EQ(planned.exit_code, 0) << saved << ": " << planned.error;
    const std::filesystem::path step = folder_.path() / "design.step";
    const CommandResult exported =
        Ask({"catalog", "evaluate", saved, "--strict", "--step", step.string()}, *house_);
    EXPECT_EQ(exported.exit_code, 0) << saved << ": " << exported.error;
    EXPECT_EQ(ReadFile(step).value_or("").substr(0, 12), "ISO-10303-21") << saved;
    ++count;
  }
  EXPECT_GE(count, 8);
}

TEST_F(ComposeRun, SavesAtTheEndWhatTheScriptDoesNot) {
  std::string script = Table("unsaved");
  script.erase(script.find("save\n"));
  EXPECT_EQ(Document(Table("unsaved"), {"--unsaved"})["template"], "");
  EXPECT_EQ(Document(script, {"--anew"})["template"], "templates/unsaved");
}

}  // namespace
}  // namespace mortise::e2e
