// Tags as they are typed for what a command makes.
#include "cli/client/tag_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "mortise/v1/fabplanner.pb.h"

namespace mortise::cli {
namespace {

using testing::ElementsAre;
using testing::Pair;
using testing::UnorderedElementsAre;

// The request that a command makes of these arguments.
absl::StatusOr<v1::CreatePlanRequest> RequestOf(const std::vector<std::string>& arguments) {
  CLI::App app;
  TagOptions options;
  std::string subject;
  app.add_option("subject", subject);
  CommandFlags flags(app);
  AddTagOptions(flags, options);
  app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  v1::CreatePlanRequest request;
  request.set_template_(subject);
  MORTISE_RETURN_IF_ERROR(AddTags(options, &request));
  return request;
}

TEST(TagOptions, EveryFlagTakesOneText) {
  const auto request =
      RequestOf({"--external-id", "100-4711/A", "--label", "customer=acme", "--label", "note=a=b",
                 "--external-id", "[1,2]", "--label", "draft=", "table"});
  ASSERT_TRUE(request.ok()) << request.status();
  EXPECT_EQ(request->template_(), "table");
  EXPECT_THAT(request->external_ids(), ElementsAre("100-4711/A", "[1,2]"));
  EXPECT_THAT(request->labels(), UnorderedElementsAre(Pair("customer", "acme"), Pair("note", "a=b"),
                                                      Pair("draft", "")));
}

TEST(TagOptions, FaultsNameTheFlag) {
  for (const char* const text : {"customer", "=acme", ""}) {
    const absl::Status status = RequestOf({"--label", text}).status();
    EXPECT_EQ(status.message(), absl::StrCat("--label: '", text, "' is not of the form KEY=VALUE"));
  }
  EXPECT_EQ(RequestOf({"--label", "a=1", "--label", "a=2"}).status().message(),
            "--label: 'a' is there twice");
}

TEST(TagOptions, FieldsOfServicesAreFlags) {
  CLI::App app;
  TagOptions options{.external_ids = {"one", "two\n"}, .labels = {"a=1"}};
  CommandFlags flags(app);
  AddTagOptions(flags, options);
  const FieldSources sources = flags.Sources();
  EXPECT_EQ(DetailOf(sources.Name(InvalidField("external_ids[1]", "is wrong"))).field,
            "--external-id two\n");
  EXPECT_EQ(DetailOf(sources.Name(InvalidField("external_ids", "are too many"))).field,
            "--external-id");
  EXPECT_EQ(DetailOf(sources.Name(InvalidField("labels", "are wrong"))).field, "--label");
}

}  // namespace
}  // namespace mortise::cli
