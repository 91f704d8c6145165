// Files that are no assemblies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "cli/commands/command_line.h"
#include "common/base/files.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ImportCommand : public ::testing::Test {
 protected:
  // What is said of importing a file of these bytes; no gateway is reached.
  std::string Refusal(const std::string& name, const std::string& bytes,
                      const std::vector<std::string>& flags = {}) {
    const std::filesystem::path file = folder_.path() / name;
    EXPECT_TRUE(WriteFile(file, bytes).ok());
    std::vector<std::string> arguments = {"assembly", "import", file.string()};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    Output output(Output::Form::kSilent);
    return std::string(RunCommandLine(arguments, Session(), output).message());
  }

  const mortise::testing::TemporaryFolder folder_;
};

TEST_F(ImportCommand, FilesOfOtherFormatsAreCalledThat) {
  for (const char* const name : {"chair.dae", "chair.fbx", "chair"}) {
    const std::string refusal = Refusal(name, "<?xml version=\"1.0\"?>");
    EXPECT_THAT(refusal, AllOf(HasSubstr("no format that is imported"), HasSubstr(".glb"),
                               Not(HasSubstr("column"))))
        << name;
    EXPECT_THAT(Refusal(name, "Kaydara FBX", {"--id", "chair"}), Not(HasSubstr("--id"))) << name;
  }
}

TEST_F(ImportCommand, FaultsOfTextsHaveTheirPlace) {
  EXPECT_THAT(Refusal("chair.textproto", "nmae: 'assemblies/chair'"), HasSubstr("nmae"));
}

}  // namespace
}  // namespace mortise::cli
