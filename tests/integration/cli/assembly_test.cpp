// `mortise assembly` against a catalog process with the collection that ships.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "absl/strings/str_cat.h"
#include "cli/client/ending_signals.h"
#include "cli/commands/command_line.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "mortise/v1/events.grpc.pb.h"
#include "tests/integration/services/filled_catalog.h"
#include "tests/support/box_scenes.h"
#include "tests/support/round_parts.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Collection() { return mortise::testing::ShippedCollection().string(); }

class AssemblyCommand : public ::testing::Test {
 protected:
  AssemblyCommand() { session_.gateway.address = process_.address(); }

  // The document of `mortise assembly ARGUMENTS`.
  absl::StatusOr<Json> Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "assembly");
    Output output(Output::Form::kSilent);
    MORTISE_RETURN_IF_ERROR(RunCommandLine(arguments, session_, output));
    return Json::parse(output.last_document());
  }

  std::string File(const std::string& name, const std::string& text) {
    const std::filesystem::path path = folder_.path() / name;
    EXPECT_TRUE(WriteFile(path, text).ok());
    return path.string();
  }

  // The message of a refusal, which begins with what is at fault.
  std::string Refusal(const std::vector<std::string>& arguments) {
    const auto result = Run(arguments);
    EXPECT_FALSE(result.ok());
    return std::string(result.status().message());
  }

  const mortise::testing::TemporaryFolder folder_;
  const mortise::testing::FilledCatalog process_;
  Session session_;
};

TEST_F(AssemblyCommand, ListsAndShows) {
  const auto list = Run({"list"});
  ASSERT_TRUE(list.ok()) << list.status();
  EXPECT_GE(list->size(), 3u);
  const auto shown = Run({"show", "bookshelf"});
  ASSERT_TRUE(shown.ok()) << shown.status();
  EXPECT_EQ((*shown)["assembly"], "assemblies/bookshelf");
  EXPECT_FALSE((*shown)["sizes"].empty());
}

TEST_F(AssemblyCommand, ShowsWhatHoldsPartsTogether) {
  ::testing::internal::CaptureStdout();
  Output output(Output::Form::kText);
  const absl::Status shown = RunCommandLine({"assembly", "show", "bookshelf"}, session_, output);
  const std::string text = ::testing::internal::GetCapturedStdout();
  ASSERT_TRUE(shown.ok()) << shown;
  for (const char* part :
       {"connection", "held by", "screw", "contact across x", " connections, "}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

// Two gibibytes of nothing, which take no room on the disk.
TEST_F(AssemblyCommand, RefusesFilesThatAreTooLargeBeforeTheyAreRead) {
  const auto peak_kilobytes = [] {
    rusage usage = {};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  for (const char* name : {"large.obj", "large.step"}) {
    const std::string file = File(name, "#");
    std::filesystem::resize_file(file, std::uintmax_t{2} << 30);
    const long before = peak_kilobytes();
    EXPECT_THAT(Refusal({"import", file}), AllOf(HasSubstr(file), HasSubstr("67108864 bytes")));
    EXPECT_LT(peak_kilobytes() - before, 256 * 1024) << "it has been read";
  }
}

TEST_F(AssemblyCommand, ImportsDrawingsThatOutgrowAMessage) {
  const auto drawing = ReadFile(Collection() + "/drawings/wall_shelf.step");
  ASSERT_TRUE(drawing.ok()) << drawing.status();
  // Comments that cannot be packed to less than a message.
  std::string padded = *drawing;
  std::string comments;
  std::mt19937_64 random(5);
  while (comments.size() < 10'000'000) {
    absl::StrAppend(&comments, "/* ", absl::Hex(random()), " */\n");
  }
  const std::size_t data = padded.find("DATA;");
  ASSERT_NE(data, std::string::npos);
  padded.insert(data + std::string("DATA;").size(), "\n" + comments);
  const std::string file = File("large.step", padded);
  const auto imported = Run({"import", file, "--annotations",
                             Collection() + "/drawings/wall_shelf.textproto", "--id", "large"});
  ASSERT_TRUE(imported.ok()) << imported.status();
  EXPECT_EQ((*imported)[0]["name"], "assemblies/large");
  EXPECT_EQ((*imported)[0]["revision"], 1);

  // What is wrong with it is said of the file.
  const std::string cut = File("cut.step", padded.substr(0, padded.size() - 2000));
  EXPECT_THAT(Refusal({"import", cut}), HasSubstr("cut.step"));
  const std::string huge = File("huge.step", std::string((64 << 20) + 1, ' '));
  EXPECT_THAT(Refusal({"import", huge}), AllOf(HasSubstr("huge.step"), HasSubstr("67108864")));
}

TEST_F(AssemblyCommand, ImportsMeshes) {
  const std::string table =
      mortise::testing::ObjOf(mortise::testing::OneComponent(mortise::testing::TableParts()), 1000);
  const std::string file = File("Old Table.obj", table);
  const auto imported = Run({"import", file, "--unit", "mm", "--up", "z", "--label", "site=web",
                             "--external-id", "web-17"});
  ASSERT_TRUE(imported.ok()) << imported.status();
  EXPECT_EQ((*imported)[0]["name"], "assemblies/old-table");
  const auto wider = Run({"adjust", "old-table", "--set", "part 1.x=1.5", "--glb",
                          (folder_.path() / "t.glb").string()});
  ASSERT_TRUE(wider.ok()) << wider.status();
  EXPECT_EQ((*wider)["parts"].size(), 5u);
  const auto few = Run({"import", file, "--unit", "mm", "--most-parts", "2", "--id", "few"});
  ASSERT_TRUE(few.ok()) << few.status();
  const auto shown = Run({"show", "few"});
  ASSERT_TRUE(shown.ok()) << shown.status();

  EXPECT_THAT(Refusal({"import", file, "--unit", "cubit"}), HasSubstr("--unit"));
  EXPECT_THAT(Refusal({"import", file, "--up", "w"}), HasSubstr("--up"));
  EXPECT_THAT(Refusal({"import", file, "--most-parts", "500"}), HasSubstr("--most-parts"));
  EXPECT_THAT(Refusal({"import", file, file, "--unit", "mm"}), HasSubstr("--unit"));
  EXPECT_THAT(Refusal({"import", Collection() + "/drawings/wall_shelf.step", "--unit", "mm"}),
              HasSubstr("--unit"));
  EXPECT_THAT(Refusal({"import", File("empty.ply", "")}), HasSubstr("empty.ply"));
}

TEST_F(AssemblyCommand, AdjustsGoesOnFromThereAndWritesFiles) {
  const auto higher = Run({"adjust", "bookshelf", "--set", "side 1.z=2.2 m"});
  ASSERT_TRUE(higher.ok()) << higher.status();
  EXPECT_NEAR((*higher)["reached"][0].get<double>(), 2.2, 1e-9);
  const std::string from = File("higher.json", higher->dump());
  const std::string glb = (folder_.path() / "shelf.glb").string();
  const auto wider = Run({"adjust", "bookshelf", "--from", from, "--set", "shelf 1.x.size=1000mm",
                          "--set", "side 1.z.minimum=0", "--strict", "--glb", glb});
  ASSERT_TRUE(wider.ok()) << wider.status();
  EXPECT_NEAR((*wider)["reached"][0].get<double>(), 1, 1e-9);
  double top = 0;
  for (const Json& part : (*wider)["parts"]) {
    top = std::max(top, part["maximum"]["z"].get<double>());
  }
  EXPECT_NEAR(top, 2.2, 1e-6) << "as it was made before";
  EXPECT_EQ(ReadFile(glb).value_or("").substr(0, 4), "glTF");
}

// A wall 2 m long, 10 mm thick and 30 mm high with a ridge of 1 mm on its face, in STL.
std::string RidgedWall() {
  const std::array<std::array<double, 2>, 7> outline = {
      {{0, 0}, {2000, 0}, {2000, 10}, {300.5, 10}, {300, 20}, {299.5, 10}, {0, 10}}};
  std::string text = "solid wall\n";
  const auto add = [&](const std::array<std::array<int, 2>, 3>& corners) {
    absl::StrAppend(&text, "facet normal 0 0 0\nouter loop\n");
    for (const auto& [corner, z] : corners) {
      const auto& [x, y] = outline[static_cast<std::size_t>(corner)];
      absl::StrAppend(&text, "vertex ", x, " ", y, " ", z, "\n");
    }
    absl::StrAppend(&text, "endloop\nendfacet\n");
  };
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {0, 5, 6}, {3, 4, 5}}) {
    add({{{a, 30}, {b, 30}, {c, 30}}});
    add({{{a, 0}, {c, 0}, {b, 0}}});
  }
  for (int i = 0; i < 7; ++i) {
    const int next = (i + 1) % 7;
    add({{{i, 0}, {next, 0}, {next, 30}}});
    add({{{i, 0}, {next, 30}, {i, 30}}});
  }
  return text + "endsolid wall\n";
}

// A slider that runs into a ridge only where nobody tried it, as a template.
TEST_F(AssemblyCommand, FailsOnFaultsOfADesignIfStrict) {
  File("wall.stl", RidgedWall());
  const std::string track = File("track.textproto", R"(name: "assemblies/track"
parts { name: "base" position { y: -0.01 z: -0.02 } size { x: 2 y: 0.05 z: 0.02 } }
parts { name: "wall" size { x: 2 y: 0.02 z: 0.03 } shape: "wall.stl" }
parts { name: "slider" position { x: 0.7 y: 0.015 } size { x: 0.001 y: 0.02 z: 0.02 } })");
  ASSERT_EQ(Run({"import", track}).status(), absl::OkStatus());
  EXPECT_THAT(Refusal({"adjust", "track", "--strict", "--set", "slider.x.center=300mm"}),
              AllOf(HasSubstr("1 fault"), HasSubstr("'slider'")));
  const std::string file = File("template.textproto", R"(# proto-message: mortise.v1.Template
name: "templates/track"
assembly {
  assembly: "assemblies/track"
  handles { parameter: "place" measure { element: "slider" axis: X kind: CENTER } }
})");
  Output output(Output::Form::kSilent);
  ASSERT_EQ(RunCommandLine({"catalog", "import", file}, session_, output), absl::OkStatus());
  std::vector<std::string> evaluate = {"catalog", "evaluate", "track", "--set", "place=300mm"};
  EXPECT_EQ(RunCommandLine(evaluate, session_, output), absl::OkStatus());
  EXPECT_EQ(Json::parse(output.last_document())["faults"].size(), 1u);
  EXPECT_EQ(Json::parse(output.last_document())["structure"]["description"], "always the same");
  evaluate.push_back("--strict");
  const absl::Status refused = RunCommandLine(evaluate, session_, output);
  EXPECT_EQ(DetailOf(refused).reason, "DESIGN_FAULTY") << refused;
  EXPECT_THAT(std::string(refused.message()), AllOf(HasSubstr("'slider'"), HasSubstr("'wall'")));
  evaluate[4] = "place=700mm";
  EXPECT_EQ(RunCommandLine(evaluate, session_, output), absl::OkStatus());
}

TEST_F(AssemblyCommand, PrintsTheStructureOfADesign) {
  Output output(Output::Form::kText);
  ::testing::internal::CaptureStdout();
  const absl::Status done = RunCommandLine({"catalog", "evaluate", "bookshelf"}, session_, output);
  const std::string printed = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(done, absl::OkStatus());
  EXPECT_THAT(printed, AllOf(HasSubstr("structure: "), HasSubstr("shelf 1: 6")));
}

TEST_F(AssemblyCommand, NamesTheFlagAtFault) {
  EXPECT_THAT(Refusal({"adjust", "bookshelf", "--set", "lid.z=2"}),
              HasSubstr("--set lid.z: there is no element 'lid'"));
  EXPECT_THAT(Refusal({"adjust", "bookshelf", "--set", "Shelf.x=1"}),
              HasSubstr("there is no element 'Shelf'; did you mean 'shelf"));
  for (const char* set : {"side 1", "side 1=2", "side 1.w=2", "side 1.z", ".z"}) {
    EXPECT_THAT(Refusal({"adjust", "bookshelf", "--set", set}), HasSubstr("--set")) << set;
  }
  EXPECT_THAT(Refusal({"adjust", "bookshelf", "--set", "side 1.z=high"}), HasSubstr("'high'"));
  EXPECT_THAT(Refusal({"adjust", "bookshelf", "--from", File("odd.json", "[1]")}),
              HasSubstr("odd.json"));
  EXPECT_THAT(Refusal({"adjust", "bookshelf", "--from", File("short.json", "{\"q\": [1]}")}),
              HasSubstr("--from"));
  const std::string words = File("words.json", R"({"q": [1, "a", 2, null]})");
  EXPECT_THAT(Refusal({"adjust", "bookshelf", "--from", words}),
              AllOf(HasSubstr(words + ": q[1]"), HasSubstr(words + ": q[3]")));
  EXPECT_THAT(Refusal({"sample", "bookshelf", "--count", "0"}), HasSubstr("--count"));
  EXPECT_THAT(Refusal({"show", "nothing"}), HasSubstr("assemblies/nothing"));
  EXPECT_THAT(
      Refusal({"adjust", "bookshelf", "--strict", "--set", "side 1.z=2.2", "--set", "side 2.z=2"}),
      HasSubstr("cannot hold together"));
}

TEST_F(AssemblyCommand, SamplesAlikeForASeed) {
  const auto first = Run({"sample", "bookshelf", "--count", "3", "--seed", "5"});
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(first->size(), 3u);
  EXPECT_EQ(*first, *Run({"sample", "bookshelf", "--count", "3", "--seed", "5"}));
  EXPECT_NE(*first, *Run({"sample", "bookshelf", "--count", "3", "--seed", "6"}));
}

TEST_F(AssemblyCommand, ImportsOrNamesThePlace) {
  const std::string shelf = Collection() + "/assemblies/bookshelf.textproto";
  const auto same = Run({"import", shelf});
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ((*same)[0]["change"], "none");
  std::string text = ReadFile(shelf).value_or("");
  const std::size_t at = text.find("title:");
  ASSERT_NE(at, std::string::npos);
  const std::string renamed = File(
      "renamed.textproto", text.substr(0, at) + "title: 'Mine'" + text.substr(text.find('\n', at)));
  const auto changed = Run({"import", renamed});
  ASSERT_TRUE(changed.ok()) << changed.status();
  EXPECT_EQ((*changed)[0]["change"], "updated");
  EXPECT_EQ((*changed)[0]["revision"], 2);

  EXPECT_THAT(Refusal({"import", File("wrong.textproto", "name: 'assemblies/a'\nparts { x: 1 }")}),
              HasSubstr("wrong.textproto"));
  EXPECT_THAT(Refusal({"import", File("empty.textproto", "name: 'assemblies/a'")}),
              HasSubstr("empty.textproto"));
  EXPECT_THAT(Refusal({"import", (folder_.path() / "none").string()}), HasSubstr("none"));
}

TEST_F(AssemblyCommand, TellsOfShapesWithAllElse) {
  const std::string file = File("shapes.textproto",
                                "name: 'assemblies/shapes' parts { name: 'a' shape: 'absent.step' "
                                "size { x: 1 y: 1 z: 1 } } parts { name: '' shape: 'odd.txt' "
                                "item: 'items/none' }");
  const std::string refusal = Refusal({"import", file});
  EXPECT_THAT(refusal, AllOf(HasSubstr(file + ": parts[0].shape: cannot read"),
                             HasSubstr(file + ": parts[1].shape"), HasSubstr("is neither STEP"),
                             HasSubstr(file + ": parts[1].name"),
                             HasSubstr(file + ": parts[1].item"), HasSubstr("4 findings")));
}

// The file as the gateway writes it.
TEST_F(AssemblyCommand, ImportsJson) {
  const std::string bench = File("bench.json", R"({"name": "assemblies/json-bench", "parts": [
    {"name": "seat", "position": {"z": 0.4}, "size": {"x": 1, "y": 0.3, "z": 0.02}},
    {"name": "left", "size": {"x": 0.02, "y": 0.3, "z": 0.4}, "role": "PRINCIPAL"},
    {"name": "right", "position": {"x": 0.98}, "size": {"x": 0.02, "y": 0.3, "z": 0.4}}]})");
  const auto imported = Run({"import", bench});
  ASSERT_TRUE(imported.ok()) << imported.status();
  EXPECT_EQ((*imported)[0]["name"], "assemblies/json-bench");
  const std::string odd = File("odd.json", R"({"title": 3, "parts": [{"role": "NONE"}, 7]})");
  EXPECT_THAT(Refusal({"import", odd}),
              AllOf(HasSubstr(odd + ": title: 3 must be a text"),
                    HasSubstr(odd + ": parts[0].role"), HasSubstr(odd + ": parts[1]: must be")));
}

// Files that cannot be read: all that is wrong with all of them.
TEST_F(AssemblyCommand, TellsEveryPlaceOfAFileThatCannotBeRead) {
  const std::string text = File("faults.textproto",
                                "name: 'assemblies/faults'\n"
                                "titel: 'Faults'\n"
                                "parts {\n"
                                "  name: 'a' name: 'b'\n"
                                "  size { x: 'wide' y: 1 z: 1 }\n"
                                "}\n"
                                "parts { ) }\n");
  const std::string json = File("faults.json", R"({"name": "assemblies/faults", "titel": "Faults",
      "parts": [{"name": "a", "size": {"x": 1, "x": 2, "y": "wide"}}], "name": "b"})");
  EXPECT_THAT(Refusal({"import", text, json}),
              AllOf(HasSubstr("8 findings"), HasSubstr(text + ": line 2, column 1: there is no"),
                    HasSubstr(text + ": line 4, column 13: 'name' is there twice"),
                    HasSubstr(text + ": line 5, column 13: must be a number"),
                    HasSubstr(text + ": line 7, column 9"), HasSubstr(json + ": titel"),
                    HasSubstr(json + ": parts[0].size.x: is there twice"),
                    HasSubstr(json + ": parts[0].size.y: \"wide\" must be a number"),
                    HasSubstr(json + ": name: is there twice")));
  EXPECT_THAT(std::string(Run({"show", "faults"}).status().message()), HasSubstr("there is no"));
  // Of annotations, too.
  const std::string step = (folder_.path() / "shelf.step").string();
  ASSERT_TRUE(Run({"export", "bookshelf", "-o", step}).ok());
  const std::string annotations =
      File("annotations.textproto", "parts { itme: 'a' }\nparts { role: NONE left_out: maybe }");
  EXPECT_THAT(Refusal({"import", step, "--annotations", annotations}),
              AllOf(HasSubstr("3 findings"), HasSubstr(annotations + ": line 1, column 9"),
                    HasSubstr(annotations + ": line 2, column 15"),
                    HasSubstr(annotations + ": line 2, column 30")));
}

TEST_F(AssemblyCommand, ExportsAndImportsStep) {
  const std::string step = (folder_.path() / "My Shelf.step").string();
  const auto written = Run({"export", "bookshelf", "--out", step});
  ASSERT_TRUE(written.ok()) << written.status();
  const auto bare = Run({"import", step});
  ASSERT_TRUE(bare.ok()) << bare.status();
  EXPECT_EQ((*bare)[0]["name"], "assemblies/my-shelf");
  EXPECT_EQ((*bare)[0]["change"], "created");
  EXPECT_FALSE((*bare)[0]["notes"].empty());

  const std::string text = File("shelf.textproto",
                                "parts { product: 'screw-4x40' role: CONNECTING "
                                "item: 'items/screw-4x40' }");
  const auto annotated = Run({"import", step, "--annotations", text});
  ASSERT_TRUE(annotated.ok()) << annotated.status();
  EXPECT_EQ((*annotated)[0]["change"], "updated");
  const auto kept = Run({"import", step});
  ASSERT_TRUE(kept.ok()) << kept.status();
  EXPECT_EQ((*kept)[0]["change"], "none");
  EXPECT_THAT((*kept)[0]["notes"].dump(), HasSubstr("kept the annotations of revision 2"));
  const auto dropped = Run({"import", step, "--drop-annotations"});
  ASSERT_TRUE(dropped.ok()) << dropped.status();
  EXPECT_EQ((*dropped)[0]["change"], "updated");
  EXPECT_THAT(Refusal({"import", step, "--drop-annotations", "--annotations", text}),
              HasSubstr("--drop-annotations"));
  const std::string json = File("shelf.json", "{\"name\": \"assemblies/json-shelf\"}");
  const auto named = Run({"import", step, "--annotations", json});
  ASSERT_TRUE(named.ok()) << named.status();
  EXPECT_EQ((*named)[0]["name"], "assemblies/json-shelf");
  const auto other = Run({"import", step, "--annotations", json, "--id", "other"});
  ASSERT_TRUE(other.ok()) << other.status();
  EXPECT_EQ((*other)[0]["name"], "assemblies/other");
}

// Ctrl-C as soon as the catalog has told how far it is.
TEST_F(AssemblyCommand, CancelsAnImportAndTellsWhatBecameOfIt) {
  const std::string step = File("pin board.step", mortise::testing::PinBoardStep(58));
  const auto stub = v1::EventService::NewStub(process_.channel());
  grpc::ClientContext following;
  v1::FollowEventsRequest follow;
  follow.add_type_prefixes("assembly.importing");
  const auto reader = stub->FollowEvents(&following, follow);
  std::jthread interrupting([&] {
    v1::Event event;
    if (reader->Read(&event)) ::kill(::getpid(), SIGINT);
  });
  const absl::Status ended = Run({"import", step}).status();
  following.TryCancel();
  interrupting.join();
  reader->Finish();
  EXPECT_TRUE(absl::IsCancelled(ended)) << ended;
  EXPECT_EQ(ExitCodeOf(ended), 128 + SIGINT);
  EXPECT_THAT(std::string(ended.message()),
              HasSubstr("assemblies/pin-board was cancelled; nothing of it is stored"));
}

TEST_F(AssemblyCommand, ExportsWhatWasAdjusted) {
  const auto higher = Run({"adjust", "bookshelf", "--set", "side 1.z=2.2"});
  ASSERT_TRUE(higher.ok()) << higher.status();
  const std::string at = File("higher.json", higher->dump());
  const std::string glb = (folder_.path() / "shelf.glb").string();
  const auto written = Run({"export", "bookshelf", "--at", at, "--format", "glb", "-o", glb});
  ASSERT_TRUE(written.ok()) << written.status();
  EXPECT_EQ(ReadFile(glb).value_or("").substr(0, 4), "glTF");
  EXPECT_THAT(
      Refusal({"export", "bookshelf", "--at", File("short.json", "{\"q\": [1]}"), "-o", glb}),
      HasSubstr("--at"));
  EXPECT_THAT(Refusal({"export", "nothing", "-o", glb}), HasSubstr("assemblies/nothing"));
}

TEST_F(AssemblyCommand, NamesTheFileAtFaultOfStepImports) {
  const std::string cut = File("cut.step", "ISO-10303-21;\nHEADER;");
  EXPECT_THAT(Refusal({"import", cut}), HasSubstr("cut.step"));
  EXPECT_THAT(Refusal({"import", File("nothing.step", "")}),
              AllOf(HasSubstr("nothing.step"), HasSubstr("is empty")));
  const std::string step = (folder_.path() / "shelf.step").string();
  ASSERT_TRUE(Run({"export", "bookshelf", "-o", step}).ok());
  const std::string wrong = File("wrong.textproto", "parts { parts: 'nobody' }");
  EXPECT_THAT(Refusal({"import", step, "--annotations", wrong}), HasSubstr("wrong.textproto"));
  EXPECT_THAT(Refusal({"import", step, "--annotations", File("odd.json", "[]")}),
              HasSubstr("odd.json"));
  EXPECT_THAT(Refusal({"import", step, "--id", "No such/Id"}), HasSubstr("--id"));
  const std::string shelf = Collection() + "/assemblies/bookshelf.textproto";
  EXPECT_THAT(Refusal({"import", shelf, "--id", "x"}), HasSubstr("--id"));
}

}  // namespace
}  // namespace mortise::cli
