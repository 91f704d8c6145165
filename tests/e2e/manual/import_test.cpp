// `mortise catalog import`: designs into the catalog, all or none, and again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

// A peg of ash: a material of its own, and an item of it.
constexpr char kPegs[] = R"(# proto-message: mortise.v1.TemplateBundle
materials {
  name: "materials/ash"
  title: "Ash"
  density: 690
  youngs_modulus: 12.5e9
  poissons_ratio: 0.36
  strength: 40e6
}
items {
  name: "items/ash-peg-8x35"
  title: "Ash peg, 8 x 35 mm"
  kind: DOWEL
  material: "materials/ash"
  dimensions { axis: X size: 0.035 }
  dimensions { axis: Y size: 0.008 }
  dimensions { axis: Z size: 0.008 }
  price { currency: "EUR" amount: 0.07 }
  price_basis: PER_PIECE
  price_date: "2026-01-15"
  supplier: "Example Timber Merchant"
}
)";

// A plank on the floor.
constexpr char kPlank[] = R"(# proto-message: mortise.v1.Template
name: "templates/plank"
title: "Plank"
parameters {
  name: "length" title: "Length" unit: "m" minimum: 0.5 maximum: 2.0 default_value: 1.0
}
)";

class Import : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("mortise-import-" + NewIdentifier());
    std::filesystem::create_directories(folder_);
    house_ = BackgroundCommand::InShell("mortise up --insecure-development --any-ports --workers 1",
                                        folder_, (folder_ / "up.log").string());
    serving_ = AwaitHouse(folder_ / ".mortise");
  }
  static void TearDownTestSuite() {
    house_.reset();
    std::filesystem::remove_all(folder_);
  }

  void SetUp() override { ASSERT_TRUE(serving_) << ReadFile(folder_ / "up.log").value_or(""); }

  // A file with `text`, in which `from` is `to`.
  static std::string File(const std::string& name, const std::string& text,
                          std::vector<std::pair<std::string, std::string>> changes = {}) {
    const std::string path = (folder_ / name).string();
    EXPECT_TRUE(WriteFile(path, absl::StrReplaceAll(text, changes)).ok());
    return path;
  }

  // The collection's table under another name.
  static std::string TableAs(const std::string& name,
                             std::vector<std::pair<std::string, std::string>> changes = {}) {
    const std::filesystem::path source = std::getenv("MORTISE_SOURCE_DIR");
    const std::string text =
        ReadFile(source / "collection/designs/table/template.textproto").value_or("");
    changes.emplace_back("\"templates/table\"", "\"templates/" + name + "\"");
    return File(name + ".textproto", text, changes);
  }

  static Json Ask(std::vector<std::string> arguments, int expected_code = 0) {
    arguments.insert(arguments.begin(), {"--json", "--house", (folder_ / ".mortise").string()});
    const CommandResult result = Mortise(arguments);
    EXPECT_EQ(result.exit_code, expected_code) << result.out << result.error;
    return Json::parse(result.out, nullptr, false);
  }

  static Json Imported(const std::string& name, int revision, const std::string& change) {
    return {{"name", name}, {"revision", revision}, {"change", change}};
  }

  static std::filesystem::path folder_;
  static std::unique_ptr<BackgroundCommand> house_;
  static bool serving_;
};

std::filesystem::path Import::folder_;
std::unique_ptr<BackgroundCommand> Import::house_;
bool Import::serving_ = false;

TEST_F(Import, StoresOnceAndMakesRevisionsOfWhatDiffers) {
  const std::string pegs = File("pegs.textproto", kPegs);
  const std::string desk = TableAs("desk", {{"items/dowel-8x35", "items/ash-peg-8x35"}});
  EXPECT_EQ(Ask({"catalog", "import", pegs, desk}),
            Json::array({Imported("materials/ash", 1, "created"),
                         Imported("items/ash-peg-8x35", 1, "created"),
                         Imported("templates/desk", 1, "created")}));
  // Again, nothing happens.
  EXPECT_EQ(
      Ask({"catalog", "import", pegs, desk}),
      Json::array({Imported("materials/ash", 1, "none"), Imported("items/ash-peg-8x35", 1, "none"),
                   Imported("templates/desk", 1, "none")}));
  // The peg costs more: a revision of it. The template is as it was.
  const std::string dearer = File("dearer.textproto", kPegs, {{"amount: 0.07", "amount: 0.09"}});
  EXPECT_EQ(Ask({"catalog", "import", dearer}),
            Json::array({Imported("materials/ash", 1, "none"),
                         Imported("items/ash-peg-8x35", 2, "updated")}));
  EXPECT_DOUBLE_EQ(Ask({"catalog", "show", "items/ash-peg-8x35"})["price"]["amount"], 0.09);
  // A template that says something else is a revision of it, and the old one is still there.
  const std::string titled = TableAs("desk", {{"items/dowel-8x35", "items/ash-peg-8x35"},
                                              {"title: \"Table\"", "title: \"Desk\""}});
  EXPECT_EQ(Ask({"catalog", "import", titled}),
            Json::array({Imported("templates/desk", 2, "updated")}));
  EXPECT_EQ(Ask({"catalog", "show", "desk"})["title"], "Desk");
  EXPECT_EQ(
      Ask({"call", "catalog.GetTemplate", R"({"name":"templates/desk","revision":1})"})["title"],
      "Table");
  EXPECT_EQ(Ask({"catalog", "evaluate", "desk", "--set", "length=1500mm"})["parts"].size(), 9u);
}

TEST_F(Import, FaultyFilesNameEveryFaultAndStoreNothing) {
  // A material without weight, and a peg that is bought for less than nothing and has no kind.
  const std::string faulty = File("faulty.textproto", kPegs,
                                  {{"materials/ash", "materials/faulty-ash"},
                                   {"items/ash-peg-8x35", "items/faulty-peg"},
                                   {"density: 690", "density: -1"},
                                   {"amount: 0.07", "amount: -0.07"}});
  const std::string sound =
      File("sound.textproto", kPegs,
           {{"materials/ash", "materials/sound-ash"}, {"items/ash-peg-8x35", "items/sound-peg"}});
  const Json error = Ask({"catalog", "import", sound, faulty}, 1)["error"];
  EXPECT_EQ(error["code"], "INVALID_ARGUMENT");
  const std::string message = error["message"];
  EXPECT_THAT(message, HasSubstr(faulty + ": materials/faulty-ash.density"));
  EXPECT_THAT(message, HasSubstr(faulty + ": items/faulty-peg.price"));
  for (const char* name :
       {"materials/faulty-ash", "materials/sound-ash", "items/faulty-peg", "items/sound-peg"}) {
    EXPECT_EQ(Ask({"catalog", "show", name}, 1)["error"]["code"], "NOT_FOUND") << name;
  }
}

TEST_F(Import, TextThatCannotBeReadIsNamedByLineInEveryFile) {
  const std::string one = File("one.textproto", "items {\n  nmae: \"items/a\"\n  weight: 3\n}\n");
  const std::string two = File("two.textproto", "\n\nitems: 4 oops\n");
  const std::string message = Ask({"catalog", "import", one, two}, 1)["error"]["message"];
  EXPECT_THAT(message, HasSubstr(one));
  EXPECT_THAT(message, HasSubstr("line 2"));
  EXPECT_THAT(message, HasSubstr(two));
  EXPECT_THAT(message, HasSubstr("line 3"));
  EXPECT_EQ(Ask({"catalog", "import", (folder_ / "absent").string()}, 1)["error"]["code"],
            "INVALID_ARGUMENT");
}

TEST_F(Import, TemplateThatCannotBeBuiltStoresNeitherItselfNorItsItems) {
  const std::string pegs =
      File("more.textproto", kPegs,
           {{"materials/ash", "materials/more-ash"}, {"items/ash-peg-8x35", "items/more-peg"}});
  const std::string plank = File("plank.textproto", kPlank);
  const std::string bench = TableAs("bench", {{"items/dowel-8x35", "items/no-such-peg"}});
  const Json error = Ask({"catalog", "import", pegs, plank, bench}, 1)["error"];
  EXPECT_EQ(error["code"], "INVALID_ARGUMENT");
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("templates/plank"));
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("items/no-such-peg"));
  EXPECT_EQ(Ask({"catalog", "show", "items/more-peg"}, 1)["error"]["code"], "NOT_FOUND");
  EXPECT_EQ(Ask({"catalog", "show", "bench"}, 1)["error"]["code"], "NOT_FOUND");
}

TEST_F(Import, ChangedMaterialsAreNewRevisions) {
  const std::string oak = File(
      "oak.textproto", kPegs,
      {{"materials/ash", "materials/light-oak"}, {"items/ash-peg-8x35", "items/light-oak-peg"}});
  ASSERT_EQ(Ask({"catalog", "import", oak})[0]["change"], "created");
  const std::string denser = File("denser.textproto", kPegs,
                                  {{"materials/ash", "materials/light-oak"},
                                   {"items/ash-peg-8x35", "items/light-oak-peg"},
                                   {"density: 690", "density: 720"}});
  EXPECT_EQ(Ask({"catalog", "import", denser})[0]["change"], "updated");
  EXPECT_EQ(Ask({"catalog", "show", "materials/light-oak"})["density"], 720);
  EXPECT_EQ(Ask({"catalog", "show", "materials/light-oak", "--revision", "1"})["density"], 690);
}

TEST_F(Import, NamesAreThereOnce) {
  const std::string twice =
      File("twice.textproto", kPegs,
           {{"materials/ash", "materials/twice"}, {"items/ash-peg-8x35", "items/twice"}});
  EXPECT_THAT(Ask({"catalog", "import", twice, twice}, 1)["error"]["message"].get<std::string>(),
              HasSubstr("items/twice: is there twice"));
}

}  // namespace
}  // namespace mortise::e2e
