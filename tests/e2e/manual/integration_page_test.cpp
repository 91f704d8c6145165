// docs/integration.md: the whole job by curl alone, as one script on a real house.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "tests/e2e/command.h"
#include "tests/e2e/manual/manual.h"

namespace mortise::e2e {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class IntegrationPage : public ::testing::Test {
 protected:
  IntegrationPage() {
    std::filesystem::create_directories(folder_);
    const char* source = std::getenv("MORTISE_SOURCE_DIR");
    std::filesystem::create_directory_symlink(
        std::filesystem::path(source == nullptr ? "." : source) / "collection",
        folder_ / "collection");
    house_ = BackgroundCommand::InShell(
        "mortise up --insecure-development --any-ports --workers 2 --virtual-cell --time-scale 500",
        folder_, (folder_ / "up.log").string());
  }
  ~IntegrationPage() override {
    house_.reset();
    std::filesystem::remove_all(folder_);
  }

  std::string Read(const std::string& name) const { return ReadFile(folder_ / name).value_or(""); }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("mortise-integration-" + NewIdentifier());
  std::unique_ptr<BackgroundCommand> house_;
};

TEST_F(IntegrationPage, DoesTheWholeJob) {
  ASSERT_TRUE(AwaitHouse(folder_ / ".mortise")) << Read("up.log");
  std::string script = "set -o pipefail\n";
  for (const ManualBlock& block : ReadManual("docs/integration.md")) {
    if (block.mark == "integration") script += block.text;
  }
  for (int step = 1; step <= 20; ++step) {
    EXPECT_THAT(script, HasSubstr("\n# " + std::to_string(step) + ". "));
  }
  const CommandResult result = Shell(StandIns(folder_ / ".mortise").Replace(script), folder_);
  ASSERT_EQ(result.exit_code, 0) << result.out << result.error;

  EXPECT_THAT(Read("design.glb"), StartsWith("glTF"));
  EXPECT_THAT(Read("stress.png"), HasSubstr("PNG"));
  EXPECT_THAT(Read("front.csv"), HasSubstr("mass"));
  EXPECT_THAT(Read("bill-of-materials.csv"), HasSubstr(","));
  EXPECT_THAT(Read("bill.csv"), HasSubstr("0,1,,assembly,templates/plm-table,"));
  const auto bill = nlohmann::json::parse(Read("bill.json"));
  EXPECT_EQ(bill["billTree"]["nodes"][0]["kind"], "ASSEMBLY");
  EXPECT_THAT(Read("bill.xlsx"), StartsWith("PK"));
  EXPECT_THAT(Read("items.csv"), HasSubstr("items/hex-bolt"));
  EXPECT_THAT(Read("secret.json"), HasSubstr("whsec_"));
  EXPECT_THAT(Read("order.json"), HasSubstr("COMPLETED"));
  EXPECT_THAT(Read("audit.json"), HasSubstr("FabPlannerService/ReleaseWorkOrder"));
  EXPECT_FALSE(nlohmann::json::parse(Read("events.json"))["events"].empty());
  EXPECT_THAT(result.out, HasSubstr("304"));
  bool step_file = false;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    step_file |= entry.path().extension() == ".step";
  }
  EXPECT_TRUE(step_file) << "under the name that the house proposed";
}

}  // namespace
}  // namespace mortise::e2e
