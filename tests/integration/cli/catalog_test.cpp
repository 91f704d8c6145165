// `mortise catalog` against a catalog process: items from CSV and JSON, all or none; filters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "absl/strings/str_replace.h"
#include "cli/commands/command_line.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "tests/integration/services/service_under_test.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kMaterials[] = R"(materials {
  name: "materials/steel" title: "Steel" density: 7850 youngs_modulus: 210e9 poissons_ratio: 0.3
  strength: 235e6
}
materials {
  name: "materials/beech" title: "Beech" density: 700 youngs_modulus: 13e9 poissons_ratio: 0.36
  strength: 40e6
  orthotropic {
    youngs_modulus_l: 13e9 youngs_modulus_r: 2.13e9 youngs_modulus_t: 1.08e9
    shear_modulus_lr: 1.53e9 shear_modulus_lt: 1.01e9 shear_modulus_rt: 0.436e9
    poissons_ratio_lr: 0.45 poissons_ratio_lt: 0.51 poissons_ratio_rt: 0.75
  }
}
)";

constexpr char kItems[] =
    "name,title,kind,material,designation,length_mm,width_mm,thickness_mm,measure.bore_mm,price,"
    "currency,price_date,price_is_example\r\n"
    "items/bolt,\"Bolt, M8\",BOLT,materials/steel,ISO 4014 - M8 x 40,40,8,8,,0.31,EUR,2026-01-15,"
    "true\r\n"
    "items/ring,\"Ring\r\nof two lines\",WASHER,materials/steel,,22,22,7,8,1.42,EUR,2026-01-15,"
    "true\r\n"
    "items/peg,Peg,DOWEL,materials/beech,,35,8,8,,0.05,EUR,2026-01-15,true\r\n";

class CatalogCommand : public ::testing::Test {
 protected:
  CatalogCommand() {
    session_.gateway.address = process_.address();
    EXPECT_TRUE(Run({"import", File("materials.textproto", kMaterials)}).ok());
  }

  std::string File(const std::string& name, const std::string& text) {
    const std::filesystem::path path = folder_.path() / name;
    EXPECT_TRUE(WriteFile(path, text).ok());
    return path.string();
  }

  // The document of `mortise catalog ARGUMENTS`.
  absl::StatusOr<Json> Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "catalog");
    return RunAny(arguments);
  }

  // The document of `mortise ARGUMENTS`.
  absl::StatusOr<Json> RunAny(const std::vector<std::string>& arguments) {
    Output output(Output::Form::kSilent);
    MORTISE_RETURN_IF_ERROR(RunCommandLine(arguments, session_, output));
    return Json::parse(output.last_document());
  }

  std::string Refusal(const std::vector<std::string>& arguments) {
    const auto result = Run(arguments);
    EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(result.status().message());
  }

  std::vector<std::string> Names(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "list");
    const auto list = Run(arguments);
    EXPECT_TRUE(list.ok()) << list.status();
    std::vector<std::string> names;
    for (const Json& entry : list.value_or(Json::array())) names.push_back(entry["name"]);
    return names;
  }

  std::vector<std::string> Changes(const std::vector<std::string>& files) {
    std::vector<std::string> arguments = {"import"};
    arguments.insert(arguments.end(), files.begin(), files.end());
    const auto imported = Run(arguments);
    EXPECT_TRUE(imported.ok()) << imported.status();
    std::vector<std::string> changes;
    for (const Json& entry : imported.value_or(Json::array())) changes.push_back(entry["change"]);
    return changes;
  }

  const mortise::testing::TemporaryFolder folder_;
  const mortise::testing::ServiceUnderTest process_{"mortise-catalog", {}};
  Session session_;
};

TEST_F(CatalogCommand, FoldersAreNoFiles) {
  EXPECT_THAT(Refusal({"import", folder_.path().string()}), HasSubstr("is a folder, not a file"));
}

// Of very many faults the first are listed, and the others counted.
TEST_F(CatalogCommand, TellsHowManyMoreFaultsThereAre) {
  std::string csv = "name,title,kind,material,length,width,thickness,price,currency,price_date\n";
  for (int i = 0; i < 120; ++i) {
    csv += "items/w-" + std::to_string(i) + ",A,BOARD,materials/steel,y,1,z,x,EUR,2026-01-15\n";
  }
  const std::string refusal = Refusal({"import", File("faults.csv", csv)});
  EXPECT_THAT(refusal, HasSubstr("line 34, column 5 (length)"));
  EXPECT_THAT(refusal, HasSubstr("files: have 260 more faults"));
}

TEST_F(CatalogCommand, ImportsItemsFromCsvAndBackFromJson) {
  const std::string csv = File("items.csv", kItems);
  EXPECT_EQ(Changes({csv}), std::vector<std::string>(3, "created"));
  EXPECT_EQ(Changes({csv}), std::vector<std::string>(3, "none"));
  const auto ring = Run({"show", "items/ring"});
  ASSERT_TRUE(ring.ok()) << ring.status();
  EXPECT_EQ((*ring)["title"], "Ring\r\nof two lines");
  EXPECT_EQ((*ring)["measures"][0]["size"], 0.008);
  // What `list --json` prints can be imported, here with another price.
  const auto list = Run({"list", "items"});
  ASSERT_TRUE(list.ok()) << list.status();
  Json dearer = *list;
  dearer[0]["price"]["amount"] = 0.35;
  EXPECT_EQ(Changes({File("items.json", dearer.dump(2))}),
            (std::vector<std::string>{"updated", "none", "none"}));
  // Both revisions are there.
  EXPECT_EQ((*Run({"show", "items/bolt"}))["price"]["amount"], 0.35);
  EXPECT_EQ((*Run({"show", "items/bolt", "--revision", "1"}))["price"]["amount"], 0.31);
  EXPECT_EQ(Run({"show", "items/bolt", "--revision", "3"}).status().code(),
            absl::StatusCode::kNotFound);
  EXPECT_THAT(Refusal({"show", "items/bolt", "--revision", "-1"}), HasSubstr("revision"));
  EXPECT_EQ((*Run({"show", "materials/steel", "--revision", "1"}))["revision"], "1");
  EXPECT_EQ(Run({"show", "materials/steel", "--revision", "2"}).status().code(),
            absl::StatusCode::kNotFound);
}

TEST_F(CatalogCommand, NamesEveryFaultOfEveryFileAndStoresNothing) {
  const std::string sound = File("sound.csv", kItems);
  const std::string unreadable = File(
      "unreadable.csv", absl::StrReplaceAll(kItems, {{"items/", "items/x-"}, {"BOLT", "BOLD"}}));
  const std::string ragged = File("ragged.csv", std::string(kItems) + "items/short,Short\r\n");
  const std::string json = File("faulty.json", "[\n{\"name\": \"items/y\", \"colour\": 1}\n]");
  EXPECT_THAT(
      Refusal({"import", sound, unreadable, ragged, json}),
      AllOf(HasSubstr(unreadable + ": line 2, column 3 (kind): 'BOLD'"),
            HasSubstr(ragged + ": line 6, column 1: the row has 2 cells"),
            HasSubstr(json + ": line 2: items[0]"), HasSubstr("colour"), Not(HasSubstr(sound))));
  // What can be read, but makes no sense.
  const std::string senseless = File(
      "senseless.csv", absl::StrReplaceAll(kItems, {{"items/", "items/z-"},
                                                    {"materials/beech", "materials/cheese"},
                                                    {"22,22,7,8,1.42", "22,-22,7,8,1.42"},
                                                    {"0.31,EUR,2026-01-15", "0.31,EURO,today"}}));
  EXPECT_THAT(
      Refusal({"import", sound, senseless}),
      AllOf(HasSubstr("4 findings"),
            HasSubstr(senseless + ": line 2, column 11 (currency): items/z-bolt.price.currency"),
            HasSubstr(senseless + ": line 2, column 12 (price_date): items/z-bolt.price_date"),
            HasSubstr(senseless + ": line 4, column 7 (width_mm): items/z-ring.dimensions[Y].size"),
            HasSubstr(senseless + ": line 5, column 4 (material): items/z-peg.material")));
  // What cannot be converted, all of it too.
  const std::string bare = File("bare.textproto",
                                "# proto-message: mortise.v1.Template\n"
                                "name: 'templates/bare' parts { name: 'a' item: 'items/bolt' }");
  EXPECT_THAT(
      Refusal({"import", bare}),
      AllOf(HasSubstr("5 findings"), HasSubstr(bare + ": templates/bare.parts[0].length_axis"),
            HasSubstr(bare + ": templates/bare.parts[0].thickness_axis"),
            HasSubstr(bare + ": templates/bare.parts[0].body"),
            HasSubstr(bare + ": templates/bare.parameters"),
            HasSubstr(bare + ": templates/bare.parts[0].item")));
  EXPECT_THAT(Refusal({"import", sound, sound}),
              HasSubstr(sound + ": line 2, column 1 (name): items/bolt: is there twice"));
  EXPECT_TRUE(Names({"items"}).empty());
}

// One answer, whatever keeps each from being taken: cells, rows, other files, the catalog.
TEST_F(CatalogCommand, TellsFaultsOfEveryKindAtOnce) {
  const std::string materials = File("brass.csv",
                                     "name,density,youngs_modulus,poissons_ratio,strength\n"
                                     "materials/brass,heavy,1e11,0.6,2e8\n"
                                     "materials/short,1\n");
  const std::string none = "shapes/" + std::string(64, 'a');
  const std::string items =
      File("parts.csv",
           "name,kind,material,length_mm,width_mm,thickness_mm,price,currency,price_date,shape\n"
           "items/a,BOLT,materials/brass,4O,8,8,-1,EUR,2026-01-15,\n"
           "items/b,BOLT,materials/unobtainium,40,8,8,1,EURO,2026-01-15,absent.step\n"
           "items/b,BOLD,materials/short,40,8,8,1,EUR,today," +
               none + "\n");
  const std::string json = File(
      "more.json",
      "{\"items\": [{\"name\": \"items/c\", \"kind\": \"BOLD\", \"material\": "
      "\"materials/steel\",\n"
      "\"dimensions\": [{\"axis\": \"X\", \"size\": \"wide\"}, {\"axis\": \"X\", \"size\": -1}],\n"
      "\"price\": {\"currency\": \"EUR\"}, \"price_basis\": \"PER_PIECE\", \"price_date\": "
      "\"2026-02-30\"}]}");
  const std::string refusal = Refusal({"import", materials, items, json});
  EXPECT_THAT(refusal, HasSubstr("16 findings"));
  for (const std::string& fault : std::vector<std::string>{
           materials + ": line 2, column 2 (density): 'heavy' is no number",
           materials + ": line 3, column 1: the row has 2 cells",
           materials + ": line 2, column 4 (poissons_ratio): materials/brass.poissons_ratio",
           items + ": line 2, column 4 (length_mm): '4O' is no number",
           items + ": line 2, column 7 (price): items/a.price.amount",
           items + ": line 3, column 3 (material): items/b.material",
           items + ": line 3, column 8 (currency): items/b.price.currency",
           items + ": line 3, column 10 (shape): items/b.shape",
           items + ": line 4, column 1 (name): items/b: is there twice",
           items + ": line 4, column 2 (kind): 'BOLD'",
           items + ": line 4, column 9 (price_date): items/b.price_date",
           items + ": line 4, column 10 (shape): items/b.shape: there is no shape '" + none,
           json + ": line 1: items[0].kind: \"BOLD\"",
           json + ": line 1: items[0].dimensions[0].size: \"wide\"",
           json + ": line 1: items/c.dimensions[1].axis: is given twice",
           json + ": line 1: items/c.price_date"}) {
    EXPECT_THAT(refusal, HasSubstr(fault));
  }
  EXPECT_TRUE(Names({"items"}).empty());
}

TEST_F(CatalogCommand, OfVeryManyFaultsNamesTheFirst) {
  std::string text = "name,kind,material,length,width,thickness,price,currency,price_date\n";
  for (int i = 0; i < 150; ++i) {
    text += "items/i" + std::to_string(i) + ",NUT,materials/air,1,1,1,1,EUR,2026-01-15\n";
  }
  EXPECT_THAT(
      Refusal({"import", File("many.csv", text)}),
      AllOf(HasSubstr("items/i99."), Not(HasSubstr("items/i100.")), HasSubstr("50 more faults")));
}

TEST_F(CatalogCommand, DeletesWhatNothingUses) {
  Changes({File("items.csv", kItems)});
  EXPECT_EQ(Run({"delete", "materials/beech"}).status().code(),
            absl::StatusCode::kFailedPrecondition);
  const auto stale = Run({"delete", "items/peg", "--revision", "2"}).status();
  EXPECT_EQ(stale.code(), absl::StatusCode::kAborted);
  const auto deleted = Run({"delete", "items/peg"});
  ASSERT_TRUE(deleted.ok()) << deleted.status();
  EXPECT_EQ(*deleted, Json({{"name", "items/peg"}, {"revision", 1}}));
  EXPECT_TRUE(Run({"delete", "materials/beech", "--revision", "1"}).ok());
  EXPECT_EQ(Names({"items"}), (std::vector<std::string>{"items/bolt", "items/ring"}));
  EXPECT_EQ(Run({"delete", "items/peg"}).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(Run({"delete", "table"}).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(CatalogCommand, ExternalIdsAndLabelsComeWithFiles) {
  Changes({File("items.csv", kItems)});
  Json items = *Run({"list", "items"});
  items[0]["external_ids"] = {"100-4711/A", "[2]"};
  items[0]["labels"] = {{"customer", "acme"}, {"draft", ""}};
  EXPECT_EQ(Changes({File("items.json", items.dump(2))}),
            (std::vector<std::string>{"updated", "none", "none"}));
  const auto bolt = Run({"show", "items/bolt"});
  ASSERT_TRUE(bolt.ok()) << bolt.status();
  EXPECT_EQ((*bolt)["external_ids"], items[0]["external_ids"]);
  EXPECT_EQ((*bolt)["labels"], items[0]["labels"]);
  EXPECT_EQ((*bolt)["creator"], "users/developer");
  items[0]["labels"] = {{"customer", 7}};
  items[1]["labels"] = {{"-", "x"}};
  EXPECT_THAT(Refusal({"import", File("faulty.json", items.dump(2))}),
              AllOf(HasSubstr("items[0].labels[\"customer\"]"), HasSubstr("7 must be a text")));
}

TEST_F(CatalogCommand, ExternalIdsAndLabelsAreChangedAndFound) {
  Changes({File("items.csv", kItems)});
  const auto labelled =
      RunAny({"label", "items/bolt", "customer=acme", "draft=", "--external-id", "100-4711/A"});
  ASSERT_TRUE(labelled.ok()) << labelled.status();
  EXPECT_EQ((*labelled)["revision"], "2");
  ASSERT_TRUE(RunAny({"label", "materials/steel", "customer=acme"}).ok());
  using Expected = std::vector<std::string>;
  EXPECT_EQ(Names({"items", "--label", "customer=acme"}), Expected{"items/bolt"});
  EXPECT_EQ(Names({"items", "--label", "draft", "--external-id", "100-4711/A"}),
            Expected{"items/bolt"});
  EXPECT_EQ(Names({"items", "--label", "customer=b"}), Expected{});
  EXPECT_EQ(Names({"items", "--external-id", "100-4711"}), Expected{});
  EXPECT_EQ(Names({"items", "--creator", "developer", "--since", "1h"}).size(), 3u);
  EXPECT_EQ(Names({"items", "--creator", "ada"}), Expected{});
  EXPECT_EQ(Names({"items", "--before", "2020-01-01"}), Expected{});
  const auto found = RunAny({"find", "100-4711/A"});  // of what this process has
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->size(), 1u);
  EXPECT_EQ((*found)[0]["name"], "items/bolt");
  EXPECT_EQ(RunAny({"list", "materials", "--label", "customer"})->size(), 1u);
  const auto cleared =
      RunAny({"label", "items/bolt", "customer-", "draft-", "--no-external-id", "100-4711/A"});
  ASSERT_TRUE(cleared.ok()) << cleared.status();
  EXPECT_EQ((*cleared)["labels"], Json::object());
  EXPECT_EQ(RunAny({"find", "100-4711/A"})->size(), 0u);
  // What a label may not be is the service's to say, and told by what was typed.
  const absl::Status refused = RunAny({"label", "items/bolt", "a b=1"}).status();
  EXPECT_EQ(DetailOf(refused).field, "change") << refused;
  EXPECT_EQ(DetailOf(Run({"list", "items", "--label", "a b"}).status()).field, "--label");
}

TEST_F(CatalogCommand, ListsWhatTheFiltersSay) {
  Changes({File("items.csv", kItems)});
  using Expected = std::vector<std::string>;
  EXPECT_EQ(Names({"items"}), (Expected{"items/bolt", "items/peg", "items/ring"}));
  EXPECT_EQ(Names({"--kind", "bolt"}), Expected{"items/bolt"});
  EXPECT_EQ(Names({"--kind", "DRAWER_SLIDE"}), Expected{});
  EXPECT_EQ(Names({"--kind", "drawer-slide"}), Expected{});
  EXPECT_EQ(Names({"items", "--material", "steel"}), (Expected{"items/bolt", "items/ring"}));
  EXPECT_EQ(Names({"--material", "materials/beech"}), Expected{"items/peg"});
  EXPECT_EQ(Names({"--text", "m8 iso"}), Expected{"items/bolt"});
  EXPECT_EQ(Names({"--text", "m8", "--kind", "nut"}), Expected{});
  EXPECT_THAT(Refusal({"list", "--kind", "bold"}), AllOf(HasSubstr("kind"), HasSubstr("WASHER")));
  EXPECT_THAT(Refusal({"list", "--material", "cheese"}),
              AllOf(HasSubstr("material"), HasSubstr("materials/cheese")));
  EXPECT_THAT(Refusal({"list", "--text", std::string(201, 'x')}), HasSubstr("text"));
  EXPECT_THAT(Refusal({"list", "templates", "--kind", "bolt"}), HasSubstr("PARTS, ASSEMBLY"));
  EXPECT_THAT(Refusal({"list", "templates", "--material", "steel"}), HasSubstr("only items"));
  EXPECT_THAT(Refusal({"list", "materials", "--kind", "bolt"}), HasSubstr("--kind"));
  EXPECT_THAT(Refusal({"list", "items", "--item", "bolt"}), HasSubstr("only templates"));
  EXPECT_THAT(Refusal({"list", "items", "--elasticity", "isotropic"}), HasSubstr("only materials"));
  EXPECT_THAT(Refusal({"list", "--item", "none"}), HasSubstr("items/none"));
  EXPECT_EQ(Names({"--elasticity", "orthotropic"}), Expected{"materials/beech"});
  EXPECT_EQ(Names({"materials", "--elasticity", "isotropic"}), Expected{"materials/steel"});
  EXPECT_EQ(Names({"materials", "--text", "BEE"}), Expected{"materials/beech"});
  EXPECT_EQ(Names({"--item", "bolt"}), Expected{});
  EXPECT_EQ(Names({"templates", "--kind", "cad"}), Expected{});
}

}  // namespace
}  // namespace mortise::cli
