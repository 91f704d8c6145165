// Filters of lists as they are typed.
#include "cli/client/filter_options.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/time_util.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "common/base/errors.h"

namespace mortise::cli {
namespace {

using google::protobuf::util::TimeUtil;
using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;

const absl::TimeZone kEast = absl::FixedTimeZone(2 * 3600);
const absl::Time kNow = absl::FromCivil(absl::CivilSecond(2026, 11, 26, 20, 0, 0), kEast);

// A time as a person types it, in UTC.
std::string Utc(const std::string& text) {
  const auto time = ParseTime(text, "--since", kNow, kEast);
  if (!time.ok()) return std::string(time.status().message());
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E*S", *time, absl::UTCTimeZone());
}

absl::StatusOr<v1::ResourceFilter> FilterOf(const FilterOptions& options) {
  return ParseFilter(options, kNow, kEast);
}

TEST(FilterOptions, TimesAreIso8601) {
  const std::pair<const char*, const char*> times[] = {
      {"2026-11-26", "2026-11-25T22:00:00"},  // midnight here
      {"2026-11-26T20:25", "2026-11-26T18:25:00"},
      {"2026-11-26T20:25:30", "2026-11-26T18:25:30"},
      {"2026-11-26T20:25:30.5", "2026-11-26T18:25:30.5"},
      {"2026-11-26T20:25Z", "2026-11-26T20:25:00"},
      {"2026-11-26T20:25:30Z", "2026-11-26T20:25:30"},
      {"2026-11-26T20:25:30-05:00", "2026-11-27T01:25:30"},
  };
  for (const auto& [text, utc] : times) EXPECT_EQ(Utc(text), utc) << text;
}

TEST(FilterOptions, DurationsAreBeforeNow) {
  const std::pair<const char*, const char*> times[] = {
      {"0s", "2026-11-26T18:00:00"},    {"90s", "2026-11-26T17:58:30"},
      {"15min", "2026-11-26T17:45:00"}, {"2h", "2026-11-26T16:00:00"},
      {"1.5h", "2026-11-26T16:30:00"},  {"7d", "2026-11-19T18:00:00"},
      {"3w", "2026-11-05T18:00:00"},
  };
  for (const auto& [text, utc] : times) EXPECT_EQ(Utc(text), utc) << text;
}

TEST(FilterOptions, OtherTimesAreRefusedWithTheForms) {
  for (const char* const text :
       {"", "yesterday", "7", "7m", "7 months", "-2h", "2026-13-01", "2026-02-30", "26.11.2026",
        "2026-11-26 20:25", "2026-11-26T20:25:30+", "2026-11-26Z", "2hours", "0x10h"}) {
    const absl::Status status = ParseTime(text, "--before", kNow, kEast).status();
    EXPECT_EQ(DetailOf(status).field, "--before") << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr("2026-11-26T20:25")) << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr("7d")) << text;
  }
  for (const char* const text : {"infinite-past", "infinite-future", "99999d99", "1e300d"}) {
    EXPECT_FALSE(ParseTime(text, "--before", kNow, kEast).ok()) << text;
  }
}

TEST(FilterOptions, EveryFlagIsAPartOfTheFilter) {
  const auto filter = FilterOf({.external_id = "100-4711/A",
                                .labels = {"customer=acme", "note=a=b", "draft"},
                                .creator = "ada",
                                .since = "2h",
                                .before = "2026-11-26T18:00Z"});
  ASSERT_TRUE(filter.ok()) << filter.status();
  EXPECT_EQ(filter->external_id(), "100-4711/A");
  EXPECT_THAT(filter->labels(), UnorderedElementsAre(Pair("customer", "acme"), Pair("note", "a=b"),
                                                     Pair("draft", "")));
  EXPECT_EQ(filter->creator(), "users/ada");
  EXPECT_EQ(TimeUtil::ToString(filter->created_from()), "2026-11-26T16:00:00Z");
  EXPECT_EQ(TimeUtil::ToString(filter->created_before()), "2026-11-26T18:00:00Z");
}

TEST(FilterOptions, WhatIsNotGivenFiltersNothing) {
  const auto filter = FilterOf({});
  ASSERT_TRUE(filter.ok()) << filter.status();
  EXPECT_EQ(filter->ByteSizeLong(), 0u);
}

TEST(FilterOptions, CreatorsMayBeServices) {
  EXPECT_EQ(FilterOf({.creator = "users/ada"})->creator(), "users/ada");
  EXPECT_EQ(FilterOf({.creator = "services/plm"})->creator(), "services/plm");
}

TEST(FilterOptions, LabelsWithoutAKeyOrAValueAreRefused) {
  for (const char* const text : {"", "=acme", "customer="}) {
    EXPECT_EQ(DetailOf(FilterOf({.labels = {text}}).status()).field, "--label") << text;
  }
  EXPECT_EQ(FilterOf({.labels = {"a=1", "a"}}).status().message(), "--label: 'a' is there twice");
}

TEST(FilterOptions, FieldsOfServicesAreFlags) {
  CLI::App app;
  FilterOptions options;
  CommandFlags declared(app);
  AddFilterOptions(declared, options);
  const FieldSources sources = declared.Sources();
  const std::pair<const char*, const char*> flags[] = {{"filter.external_id", "--external-id"},
                                                       {"filter.labels", "--label"},
                                                       {"filter.creator", "--creator"},
                                                       {"filter.created_from", "--since"},
                                                       {"filter.created_before", "--before"}};
  for (const auto& [field, flag] : flags) {
    EXPECT_EQ(DetailOf(sources.Name(InvalidField(field, "is wrong"))).field, flag);
  }
}

TEST(FilterOptions, ALabelIsOneArgument) {
  CLI::App app;
  FilterOptions options;
  std::string kind;
  app.add_option("kind", kind);
  CommandFlags flags(app);
  AddFilterOptions(flags, options);
  app.parse(std::vector<std::string>{"fronts", "b", "--label", "a=1", "--label"});
  EXPECT_EQ(kind, "fronts");
  EXPECT_EQ(options.labels, (std::vector<std::string>{"a=1", "b"}));
}

}  // namespace
}  // namespace mortise::cli
