// Failures in the words of the command line.
#include "cli/client/field_sources.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/base/field_violations.h"

namespace mortise::cli {
namespace {

FieldSources Sources() {
  FieldSources sources;
  sources.AddEach("parameters", "--set", {"length=9", "width=0.8"});
  sources.AddFile("specification", "front.json");
  sources.AddEach("specification.objectives", "--minimize", {"mass"}, 2);
  sources.Add("rules.kerf", "--kerf");
  return sources;
}

absl::Status Named(const std::string& field) { return Sources().Name(InvalidField(field, "no")); }

TEST(FieldSources, NamesWhatGaveTheField) {
  EXPECT_EQ(Named("parameters[0].value").message(), "--set length: no");
  EXPECT_EQ(DetailOf(Named("parameters[1].name")).field, "--set width");
  EXPECT_EQ(DetailOf(Named("parameters[1].name")).reason, "FIELD_INVALID");
  EXPECT_EQ(Named("parameters").message(), "--set: no");
  EXPECT_EQ(Named("rules.kerf").message(), "--kerf: no");
  EXPECT_EQ(Named("specification.objectives[2].metric").message(), "--minimize mass: no");
}

TEST(FieldSources, SaysOnceWhatIsWrongWithSeveralFieldsOfOneFlag) {
  FieldSources sources;
  sources.Add("max_size", "--max-size");
  const absl::Status named = sources.Name(InvalidFields(
      {{"max_size.x", "no"}, {"max_size.y", "no"}, {"max_size.z", "no"}, {"limit", "no"}}));
  const std::vector<FieldViolation> violations = ViolationsOf(named);
  ASSERT_EQ(violations.size(), 2u) << named;
  EXPECT_EQ(violations[0].field, "--max-size");
  EXPECT_EQ(violations[1].field, "limit");
}

TEST(FieldSources, NamesThePlaceInAFile) {
  EXPECT_EQ(Named("specification.bounds[1].maximum").message(),
            "front.json: bounds[1].maximum: no");
  EXPECT_EQ(Named("specification").message(), "front.json: no");
}

TEST(FieldSources, LeavesTheRestAsItIs) {
  EXPECT_EQ(Named("rules").message(), "rules: no");
  EXPECT_EQ(Named("rules.kerf_width").message(), "rules.kerf_width: no");
  EXPECT_EQ(Named("").message(), ": no");
  EXPECT_TRUE(Sources().Name(absl::OkStatus()).ok());
  const absl::Status missing = Sources().Name(ResourceNotFound("templates/x"));
  EXPECT_EQ(missing, ResourceNotFound("templates/x"));
  // A message that does not begin with its field keeps its words.
  const absl::Status large =
      Sources().Name(WithDetail(absl::ResourceExhaustedError("too many"), {"X", "rules.kerf"}));
  EXPECT_EQ(large.message(), "too many");
  EXPECT_EQ(DetailOf(large).field, "--kerf");
}

TEST(FieldSources, NamesWhatIsTooLarge) {
  EXPECT_EQ(Sources().Name(TooLarge("rules.kerf", "1 m")).message(), "--kerf is larger than 1 m");
}

TEST(FieldSources, NamesEveryFinding) {
  const auto named = ViolationsOf(
      Sources().Name(InvalidFields({{"parameters[0].value", "a"}, {"rules.trim", "b"}})));
  ASSERT_EQ(named.size(), 2u);
  EXPECT_EQ(named[0].field, "--set length");
  EXPECT_EQ(named[1].field, "rules.trim");
}

}  // namespace
}  // namespace mortise::cli
