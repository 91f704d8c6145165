// Flags that a command does not know are refused by their names, and files that are too large
// before they are read.
#include "cli/commands/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "cli/words/unknown_words.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;

// The most memory that this process has had.
long PeakKilobytes() {
  rusage usage = {};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// What is said of a command line; empty if nothing is wrong with it. Nothing is run.
std::string Refusal(std::vector<std::string> arguments) {
  CLI::App app;
  Session session;
  BuildCommandLine(app, session);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    return "";
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
}

TEST(CommandLine, AHouseIsStartedByItsStateFolderOnly) {
  const std::string refusal = Refusal({"up", "--house", "there", "--insecure-development"});
  EXPECT_THAT(refusal, HasSubstr("--house"));
  EXPECT_THAT(refusal, HasSubstr("--state"));
  EXPECT_THAT(Refusal({"--house", "there", "up"}), HasSubstr("--house"));
  EXPECT_EQ(Refusal({"up", "--state", "there", "--insecure-development"}), "");
}

TEST(CommandLine, AHouseThatRunsIsNamedEitherWay) {
  for (const char* const command : {"down", "status"}) {
    EXPECT_EQ(Refusal({command, "--house", "there"}), "");
    EXPECT_EQ(Refusal({command, "--state", "there"}), "");
  }
}

TEST(CommandLine, CommandsWithoutAGatewayTakeNoneOfItsFlags) {
  const std::vector<std::vector<std::string>> commands = {
      {"up"}, {"down"}, {"keys", "folder"}, {"demo"}, {"completion", "bash"}};
  for (std::vector<std::string> command : commands) {
    EXPECT_EQ(Refusal(command), "") << command[0];
    for (const char* const flag : {"--gateway", "--token-file", "--authority"}) {
      std::vector<std::string> with = command;
      with.insert(with.end(), {flag, "127.0.0.1:7000"});
      EXPECT_THAT(Refusal(with), HasSubstr(flag)) << command[0];
    }
  }
  EXPECT_THAT(Refusal({"demo", "--house", "there"}), HasSubstr("--house"));
  EXPECT_THAT(Refusal({"keys", "folder", "--house", "there"}), HasSubstr("--house"));
  EXPECT_EQ(Refusal({"catalog", "list", "--gateway", "127.0.0.1:7000", "--house", "there"}), "");
}

TEST(CommandLine, StatusMayBeAskedOfAGateway) {
  EXPECT_EQ(Refusal({"status", "--gateway", "127.0.0.1:7000", "--token-file", "token"}), "");
}

TEST(CommandLine, UnknownFlagsAreNamed) {
  for (const char* const command : {"up", "down", "status", "demo", "events"}) {
    EXPECT_THAT(Refusal({command, "--hous", "there"}), HasSubstr("--hous")) << command;
  }
}

// What is said of the words that nobody knows.
std::string Unknown(std::vector<std::string> arguments) {
  CLI::App app;
  Session session;
  BuildCommandLine(app, session);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError&) {
    return UnknownWords(app, arguments);
  }
  return "";
}

TEST(CommandLine, UnknownCommandsAreOfferedOthers) {
  EXPECT_EQ(Unknown({"catlog"}), "there is no command 'catlog'; did you mean 'catalog'?");
  EXPECT_EQ(Unknown({"catlog", "list", "items"}),
            "there is no command 'catlog'; did you mean 'catalog'?");
  EXPECT_EQ(Unknown({"catalog", "lits"}),
            "there is no command 'lits' of mortise catalog; did you mean 'list'?");
  EXPECT_THAT(Unknown({"operations", "frobnicate"}), HasSubstr("there are 'list', 'show'"));
  EXPECT_EQ(Unknown({"catalog", "list", "items"}), "");
}

TEST(CommandLine, UnknownOptionsAreOfferedOthers) {
  EXPECT_EQ(Unknown({"plan", "table", "--quantiy", "3"}),
            "there is no option '--quantiy' of mortise plan; did you mean '--quantity'?");
  EXPECT_EQ(Unknown({"catalog", "list", "--hous=there"}),
            "there is no option '--hous' of mortise catalog list; did you mean '--house'?");
  EXPECT_EQ(Unknown({"status", "--frobnicate"}),
            "there is no option '--frobnicate' of mortise status");
}

TEST(CommandLine, WordsTooManyAreNamed) {
  EXPECT_EQ(Unknown({"plan", "table", "chair"}), "'chair' is one word too many for mortise plan");
}

TEST(CommandLine, PortsAreOfListenersWithNumbers) {
  EXPECT_EQ(Refusal({"up", "--insecure-development", "--port", "gateway=8700", "--port",
                     "gateway-http=0"}),
            "");
  for (const char* const wrong : {"gateway", "gateway=", "gateway=x", "gateway=70000", "=1"}) {
    EXPECT_THAT(Refusal({"up", "--insecure-development", "--port", wrong}),
                HasSubstr("LISTENER=PORT"))
        << wrong;
  }
}

// Two gibibytes of nothing, which take no room on the disk.
TEST(CommandLine, AMeshThatIsTooLargeIsRefusedBeforeItIsRead) {
  const mortise::testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "large.obj";
  std::ofstream(file).put('#');
  std::filesystem::resize_file(file, std::uintmax_t{2} << 30);
  Session session;
  session.gateway.address = "127.0.0.1:1";  // where nobody is
  Output output(Output::Form::kSilent);
  const long before = PeakKilobytes();
  const absl::Status refused = RunCommandLine({"search", file.string()}, session, output);
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted) << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr(file.string()));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("67108864 bytes"));
  EXPECT_LT(PeakKilobytes() - before, 256 * 1024) << "it has been read";
}

}  // namespace
}  // namespace mortise::cli
