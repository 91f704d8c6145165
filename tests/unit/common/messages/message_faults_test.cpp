// What is said of messages that people wrote as JSON or as protobuf text, all of it at once.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "common/messages/json_faults.h"
#include "common/messages/text_faults.h"
#include "mortise/v1/assembly.pb.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

template <typename Message>
std::vector<FieldViolation> FaultsOf(const std::string& json) {
  Message message;
  const auto read = google::protobuf::util::JsonStringToMessage(json, &message);
  return JsonFaults(json, *Message::descriptor(), read);
}

template <typename Message>
std::vector<std::string> FieldsOf(const std::string& json) {
  std::vector<std::string> fields;
  for (const FieldViolation& fault : FaultsOf<Message>(json)) fields.push_back(fault.field);
  return fields;
}

// "line:column", each.
template <typename Message>
std::vector<std::string> PlacesOf(const std::string& text) {
  std::vector<std::string> places;
  for (const TextFault& fault : TextFaults(text, *Message::descriptor())) {
    places.push_back(std::to_string(fault.line) + ":" + std::to_string(fault.column));
  }
  return places;
}

// Protobuf's reader takes 0x10 for 16 where it stands in quotes.
TEST(JsonFaults, NumbersInQuotesAreDecimal) {
  EXPECT_THAT(FieldsOf<v1::Item>(R"({"price": {"amount": "0x10"}, "dimensions": [{"size": "1.5"},
      {"size": "0X1p-1"}, {"size": "1e400"}, {"size": "inf"}, {"size": "1_0"}]})"),
              ElementsAre("price.amount", "dimensions[1].size", "dimensions[2].size",
                          "dimensions[3].size", "dimensions[4].size"));
  EXPECT_THAT(FieldsOf<v1::Item>(R"({"price": {"amount": "0x10"}})"), ElementsAre("price.amount"));
  EXPECT_EQ(FaultsOf<v1::Item>(R"({"price": {"amount": "0x10"}})")[0].message,
            "\"0x10\" must be a number");
  EXPECT_THAT(FieldsOf<v1::Item>(R"({"price": {"amount": "16"}, "title": "0x10"})"), IsEmpty());
}

TEST(JsonFaults, NamesEveryFieldAtFault) {
  EXPECT_THAT(FieldsOf<v1::Assembly>(R"({"title": 3, "titel": "a", "parts": [
      {"name": "a", "role": "NONE", "size": {"x": "wide", "w": 1}}, 7, {"size": [1, 2]},
      {"position": {"x": true}}], "joints": {"name": [1]}})"),
              ElementsAre("title", "titel", "parts[0].role", "parts[0].size.x", "parts[0].size.w",
                          "parts[1]", "parts[2].size", "parts[3].position.x", "joints.name"));
  const auto told = FaultsOf<v1::Assembly>(R"({"title": 3, "titel": "a"})");
  ASSERT_THAT(told, SizeIs(2));
  EXPECT_EQ(told[0].message, "3 must be a text");
  EXPECT_EQ(told[1].message, "there is no field of this name; did you mean 'title'?");
}

TEST(JsonFaults, NamesFieldsThatAreThereTwice) {
  EXPECT_THAT(FieldsOf<v1::ListItemsRequest>(R"({"pageSize": 3, "page_size": 4})"),
              ElementsAre("page_size"));
  EXPECT_THAT(FieldsOf<v1::Assembly>(R"({"name": "a", "title": "t", "parts": [
      {"name": "a"}, {"name": "b", "size": {"x": 1, "x": 1}, "name": null}], "name": "a"})"),
              ElementsAre("parts[1].size.x", "parts[1].name", "name"));
  EXPECT_THAT(FieldsOf<v1::Assembly>(R"({"name": "a", "name": 1, "parts": [{"w": 1, "w": 2}]})"),
              ElementsAre("name", "name", "parts[0].w", "parts[0].w", "parts[0].w"));
}

TEST(JsonFaults, NamesEntriesByTheirKeys) {
  EXPECT_THAT(
      FieldsOf<v1::TemplateBundle>(R"({"items": [{"labels": {"a": 1, "b": "2", "c": []}},
      {"labels": {"d": null}}, {"labels": []}, {"labels": "e"}, {"labels": {"f": "", "f": ""}}]})"),
      ElementsAre("items[0].labels[\"a\"]", "items[0].labels[\"c\"]", "items[1].labels[\"d\"]",
                  "items[2].labels", "items[3].labels", "items[4].labels[\"f\"]"));
  EXPECT_THAT(FieldsOf<v1::Item>(R"({"labels": {"d": null}})"), ElementsAre("labels[\"d\"]"));
  EXPECT_THAT(FieldsOf<v1::Item>(R"({"externalIds": ["1"], "labels": {"a.b/c": ""}})"), IsEmpty());
}

TEST(JsonFaults, TakesWhatTheReaderTakes) {
  for (const char* json :
       {R"({})", R"({"name": null, "parts": null})",
        R"({"parts": [{"size": {"x": "1.5", "y": "NaN", "z": 1e3}, "role": 1}]})",
        R"({"create_time": "2026-01-02T03:04:05Z", "revision": "9007199254740993"})",
        R"({"revision": 3.0})", R"( {"title": "caf\u00e9", "digest": ""} )"}) {
    EXPECT_THAT(FaultsOf<v1::Assembly>(json), IsEmpty()) << json;
  }
}

TEST(JsonFaults, NamesWhatExcludesEachOther) {
  const auto faults = FaultsOf<v1::Template>(R"({"cad": {}, "cage": {}, "titel": ""})");
  ASSERT_THAT(faults, SizeIs(2));
  EXPECT_EQ(faults[0].field, "cage");
  EXPECT_THAT(faults[0].message, HasSubstr("cad, cage"));
  const auto places = TextFaults("cad {} cage {} titel: ''", *v1::Template::descriptor());
  ASSERT_THAT(places, SizeIs(2));
  EXPECT_EQ(places[0].column, 8);
  EXPECT_THAT(places[0].message, HasSubstr("cad, cage"));
}

// Values that could be read beside one that could not are not told.
TEST(JsonFaults, TellsNothingOfValuesThatCanBeRead) {
  EXPECT_THAT(FieldsOf<v1::Assembly>(R"({"parts": [{"size": {"x": "1.5", "y": "NaN", "z": 1e3},
      "role": 1, "shape": null}], "createTime": "2026-01-02T03:04:05Z", "revision": "90071992547",
      "joints": [], "titel": ""})"),
              ElementsAre("titel"));
  EXPECT_THAT(FieldsOf<v1::Assembly>(R"({"revision": 1.5, "create_time": "yesterday"})"),
              ElementsAre("revision", "create_time"));
  EXPECT_THAT(FieldsOf<v1::ListItemsRequest>(R"({"page_size": 99999999999, "kind": "SPOON"})"),
              ElementsAre("page_size", "kind"));
}

TEST(JsonFaults, SaysWhereTextIsNotJson) {
  for (const std::string& json :
       {std::string("{"), std::string("[]"), std::string("{\"name\":}"), std::string("nonsense"),
        std::string("{} trailing"), std::string("\xff\xfe"), std::string("{\"name\":\"\xc3\x28\"}"),
        std::string("{name: 'a'}"), std::string("{'name': 'a'}"), std::string(),
        std::string(100000, '[')}) {
    const auto faults = FaultsOf<v1::Assembly>(json);
    ASSERT_THAT(faults, SizeIs(1)) << json.substr(0, 20);
    EXPECT_EQ(faults[0].field, "");
  }
  const auto faults = FaultsOf<v1::Assembly>("{\"titel\": 1,\n \"parts\": [1}");
  ASSERT_THAT(faults, SizeIs(3));
  EXPECT_EQ(faults[1].field, "parts[0]");
  EXPECT_THAT(faults[2].message, HasSubstr("line 2, column"));
  EXPECT_THAT(FieldsOf<v1::Assembly>(R"({"titel": 1, "parts": [{"size": {"x": 1e999}}]})"),
              ElementsAre("titel", "parts[0].size.x"));
}

// Python's json writes them so, among others.
TEST(JsonFaults, SaysHowToWriteWhatJsonHasNotNumbersFor) {
  for (const auto& [word, name] :
       std::vector<std::pair<std::string, std::string>>{{"NaN", "NaN"},
                                                        {"nan", "NaN"},
                                                        {"-nan", "NaN"},
                                                        {"Infinity", "Infinity"},
                                                        {"-Infinity", "-Infinity"},
                                                        {"inf", "Infinity"},
                                                        {"-inf", "-Infinity"}}) {
    for (const char* const rest : {R"(}}, {"name": "b"}]})", R"( , "y": 1}}]})", ""}) {
      const auto faults = FaultsOf<v1::Assembly>(
          R"({"title": "a", "parts": [{"name": "a"}, {"size": {"x": )" + word + rest);
      ASSERT_THAT(faults, SizeIs(1)) << word << rest;
      EXPECT_EQ(faults[0].field, "parts[1].size.x") << word << rest;
      EXPECT_EQ(faults[0].message, "JSON has no " + name + "; write \"" + name + "\", in quotes");
    }
  }
  for (const char* const other : {"-", "nanometre", "Inf1", "none", "-x"}) {
    const auto faults =
        FaultsOf<v1::Assembly>(R"({"parts": [{"size": {"x": )" + std::string(other) + "}}]}");
    ASSERT_THAT(faults, SizeIs(1)) << other;
    EXPECT_EQ(faults[0].field, "") << other;
  }
}

TEST(JsonFaults, TellsTheFirstOfVeryMany) {
  std::string json = "{\"parts\": [";
  for (int i = 0; i < 1000; ++i) json += "{\"w\": 1},";
  json += "{}]}";
  EXPECT_THAT(FaultsOf<v1::Assembly>(json), SizeIs(40));
}

// Of a large body the second look must not take longer than reading it did.
TEST(JsonFaults, TakesLessTimeThanReading) {
  std::string json = "{\"parts\": [";
  for (int i = 0; i < 20000; ++i) {
    json +=
        R"({"name": "part )" + std::to_string(i) +
        R"(", "position": {"x": 0.125, "y": 0.25, "z": 1.5}, "size": {"x": 1, "y": 1, "z": 2}},)";
  }
  json += "{}]}";
  using Clock = std::chrono::steady_clock;
  Clock::duration reading = Clock::duration::max(), looking = Clock::duration::max();
  for (int i = 0; i < 3; ++i) {  // others may be busy
    v1::Assembly message;
    const auto start = Clock::now();
    const auto read = google::protobuf::util::JsonStringToMessage(json, &message);
    const auto between = Clock::now();
    EXPECT_THAT(JsonFaults(json, *v1::Assembly::descriptor(), read), IsEmpty());
    reading = std::min(reading, between - start);
    looking = std::min(looking, Clock::now() - between);
  }
  EXPECT_LT(looking, reading);
}

TEST(TextFaults, NamesEveryPlaceAtFault) {
  EXPECT_THAT(
      PlacesOf<v1::Assembly>(R"(name: 3
titel: "a"  # a comment
parts {
  role: NONE
  size { x: "wide" w { v: 1 } }
  name: "a" name: "b"
  position: 4
}
parts: [ { w: 1 }, 7 ]
title { name: 1 }
)"),
      ElementsAre("1:7", "2:1", "4:9", "5:13", "5:20", "6:13", "7:13", "9:12", "9:20", "10:7"));
}

TEST(TextFaults, GoesAsFarAsTheTextCanBeUnderstood) {
  EXPECT_THAT(PlacesOf<v1::Assembly>("titel: 1\nparts { w: 1 }\nparts { ="),
              ElementsAre("1:1", "2:9", "3:9"));
  EXPECT_THAT(PlacesOf<v1::Assembly>("titel: 1\nparts { name: 'a'"), ElementsAre("1:1", "2:18"));
  EXPECT_THAT(PlacesOf<v1::Assembly>("titel 1 title: 'open\n"), ElementsAre("1:1", "1:7", "2:1"));
  EXPECT_THAT(PlacesOf<v1::Assembly>(std::string(100000, '{')), SizeIs(1));
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "parts {";
  EXPECT_THAT(TextFaults(deep, *v1::Assembly::descriptor()), SizeIs(2));
}

TEST(TextFaults, KnowsWhatEntriesHave) {
  EXPECT_THAT(PlacesOf<v1::Item>("labels { key: \"a\" value: 1 }\n"
                                 "labels { key: \"b\" worth: \"2\" }\n"
                                 "labels: \"c\"\n"),
              ElementsAre("1:26", "2:19", "3:9"));
  EXPECT_THAT(PlacesOf<v1::Item>("labels { key: \"a\" value: \"1\" } labels { key: \"b\" }"),
              IsEmpty());
}

TEST(TextFaults, TellsNothingOfWhatCanBeRead) {
  const std::string text = R"(
    name: "assemblies/" 'a' title: 'b';
    revision: 0x10, parts: [{ name: "c" size: < x: 1f y: -.5 z: inf > role: PRINCIPAL }, {}]
    parts { role: 1 position { x: nan y: 1e3 } })";
  v1::Assembly message;
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message));
  EXPECT_THAT(PlacesOf<v1::Assembly>(text), IsEmpty());
}

}  // namespace
}  // namespace mortise
