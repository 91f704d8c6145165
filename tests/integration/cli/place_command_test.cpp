// `mortise catalog place` against a catalog process: the deck on the terrains that ship, and faults
// of files and flags.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/commands/command_line.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "tests/integration/services/filled_catalog.h"
#include "tests/support/status_assertions.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

class PlaceCommand : public ::testing::Test {
 protected:
  PlaceCommand() { session_.gateway.address = process_.address(); }

  // The document of `mortise catalog place deck ARGUMENTS`.
  absl::StatusOr<Json> Place(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"catalog", "place", "deck"});
    Output output(Output::Form::kSilent);
    MORTISE_RETURN_IF_ERROR(RunCommandLine(arguments, session_, output));
    return Json::parse(output.last_document());
  }

  std::string Refusal(std::vector<std::string> arguments) {
    const auto result = Place(std::move(arguments));
    EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument) << result.status();
    return std::string(result.status().message());
  }

  static std::string Shipped(const std::string& file) {
    return "ground=" + (mortise::testing::ShippedCollection() / "designs/deck" / file).string();
  }

  std::string File(const std::string& name, const std::string& text) {
    const std::filesystem::path path = folder_.path() / name;
    EXPECT_OK(WriteFile(path, text));
    return "ground=" + path.string();
  }

  const mortise::testing::TemporaryFolder folder_;
  const mortise::testing::FilledCatalog process_;
  Session session_;
};

TEST_F(PlaceCommand, PutsTheDeckOnTheTerrainsThatShip) {
  ASSERT_OK_AND_ASSIGN(const Json hillside,
                       Place({"--height-field", Shipped("hillside.asc"), "--origin",
                              "451230,5411872", "--datum", "312.4m", "--label", "customer=acme"}));
  EXPECT_EQ(hillside["title"], "Deck on hillside");
  EXPECT_EQ(hillside["placed_template"], "templates/deck");
  EXPECT_EQ(hillside["height_fields"][0]["datum"], 312.4);
  EXPECT_EQ(hillside["labels"]["customer"], "acme");
  ASSERT_OK_AND_ASSIGN(const Json hollow, Place({"--height-field", Shipped("hollow.csv"), "--title",
                                                 "the hollow", "--revision", "1"}));
  EXPECT_EQ(hollow["title"], "Deck on the hollow");
  ASSERT_OK_AND_ASSIGN(const Json bank, Place({"--height-field", Shipped("bank.obj")}));
  EXPECT_NE(bank["name"], hollow["name"]);
}

TEST_F(PlaceCommand, TellsWhatIsWrongWithFilesAndFlags) {
  EXPECT_THAT(Refusal({"--height-field", File("bad.csv", "x,y,z\n0,0,1\n1,0,one\n")}),
              HasSubstr("bad.csv: line 3, column 3"));
  EXPECT_THAT(Refusal({"--height-field", "ground"}), HasSubstr("--height-field"));
  EXPECT_THAT(Refusal({"--height-field", Shipped("hollow.csv"), "--datum", "high"}),
              HasSubstr("--datum"));
  EXPECT_THAT(Refusal({"--height-field", Shipped("hollow.csv"), "--unit", "furlong"}),
              HasSubstr("--unit"));
  EXPECT_THAT(Refusal({"--height-field", Shipped("hillside.asc")}),
              AllOf(HasSubstr("ground 'ground' is known for x "), HasSubstr("--height-field")));
  const std::string hollow = Shipped("hollow.csv");
  EXPECT_THAT(Refusal({"--height-field", "grass" + hollow.substr(6)}),
              HasSubstr("the template has no ground 'grass'; it has 'ground'"));
}

}  // namespace
}  // namespace mortise::cli
