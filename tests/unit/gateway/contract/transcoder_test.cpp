// JSON to messages and back, and what is said about JSON that does not fit.
#include "gateway/contract/transcoder.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "gateway/contract/contract.h"
#include "mortise/v1/catalog.pb.h"
#include "mortise/v1/events.pb.h"
#include "mortise/v1/fabplanner.pb.h"
#include "mortise/v1/operations.pb.h"
#include "mortise/v1/types.pb.h"

namespace mortise::gateway {
namespace {

using testing::HasSubstr;

class TranscoderTest : public testing::Test {
 protected:
  const google::protobuf::Descriptor& Type(const std::string& name) const {
    return *contract_->pool().FindMessageTypeByName("mortise.v1." + name);
  }

  // The failure of reading `json` as a message of that type.
  absl::Status Failure(const std::string& type, std::string_view json) const {
    return transcoder_.ToBinary(Type(type), json).status();
  }

  const std::unique_ptr<const Contract> contract_ = Contract::Load();
  const Transcoder transcoder_{*contract_};
};

TEST_F(TranscoderTest, ReadsAndWritesMessages) {
  const auto binary = transcoder_.ToBinary(
      Type("Event"),
      R"({"stream":"catalog","number":"9007199254740993","time":"2026-01-02T03:04:05Z"})");
  ASSERT_TRUE(binary.ok()) << binary.status();
  v1::Event event;
  ASSERT_TRUE(event.ParseFromString(*binary));
  EXPECT_EQ(event.number(), 9007199254740993);
  const auto json = transcoder_.ToJson(Type("Event"), *binary);
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_EQ(nlohmann::json::parse(*json)["number"], "9007199254740993");
  EXPECT_EQ(nlohmann::json::parse(*json)["time"], "2026-01-02T03:04:05Z");
}

TEST_F(TranscoderTest, ReadsTheResultOfAnOperation) {
  v1::Operation operation;
  v1::Money money;
  money.set_currency("EUR");
  operation.mutable_result()->PackFrom(money);
  const auto json = transcoder_.ToJson(Type("Operation"), operation.SerializeAsString());
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_EQ(nlohmann::json::parse(*json)["result"]["currency"], "EUR");
}

TEST_F(TranscoderTest, ReadsAndWritesLabels) {
  const nlohmann::json request = {{"template", "templates/table"},
                                  {"externalIds", {"100-4711/A", "2"}},
                                  {"labels", {{"customer", "acme & sons"}, {"draft", ""}}}};
  const auto binary = transcoder_.ToBinary(Type("CreatePlanRequest"), request.dump());
  ASSERT_TRUE(binary.ok()) << binary.status();
  v1::CreatePlanRequest read;
  ASSERT_TRUE(read.ParseFromString(*binary));
  EXPECT_EQ(read.labels().size(), 2u);
  EXPECT_EQ(read.labels().at("customer"), "acme & sons");
  EXPECT_EQ(read.labels().at("draft"), "");
  const auto json = transcoder_.ToJson(Type("CreatePlanRequest"), *binary);
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_EQ(nlohmann::json::parse(*json), request);
}

TEST_F(TranscoderTest, NamesLabelsAtFault) {
  const auto field = [this](const std::string& type, const std::string& json) {
    const absl::Status refused = Failure(type, json);
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << json;
    return DetailOf(refused).field;
  };
  EXPECT_EQ(field("CreatePlanRequest", R"({"labels":{"a":"1","b":2}})"), "labels[\"b\"]");
  EXPECT_EQ(field("CreatePlanRequest", R"({"labels":{"a":{"b":"c"}}})"), "labels[\"a\"]");
  EXPECT_EQ(field("CreatePlanRequest", R"({"labels":{"a":["b"]}})"), "labels[\"a\"]");
  EXPECT_EQ(field("CreatePlanRequest", R"({"labels":{"a":null}})"), "labels[\"a\"]");
  EXPECT_EQ(field("CreatePlanRequest", R"({"labels":{"a":"1","a":"2"}})"), "labels[\"a\"]");
  EXPECT_EQ(field("CreatePlanRequest", R"({"labels":["a"]})"), "labels");
  EXPECT_EQ(field("CreatePlanRequest", R"({"labels":"a=1"})"), "labels");
  EXPECT_EQ(field("UpdatePlanRequest", R"({"plan":{"labels":{"a":1}}})"), "plan.labels[\"a\"]");
  EXPECT_EQ(field("ListPlansRequest", R"({"filter":{"labels":{"a":1}}})"), "filter.labels[\"a\"]");
  EXPECT_EQ(field("ListPlansRequest", R"({"filter":{"label":{}}})"), "filter.label");
}

TEST_F(TranscoderTest, NamesUnknownFields) {
  const absl::Status root = Failure("GetItemRequest", R"({"nmae":"items/x"})");
  EXPECT_EQ(root.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(root).field, "nmae");
  const absl::Status nested =
      Failure("EvaluateTemplateRequest", R"({"parameters":[{"name":"a"},{"valu":1}]})");
  EXPECT_EQ(DetailOf(nested).field, "parameters[1].valu") << nested;
}

TEST_F(TranscoderTest, NamesFieldsOfTheWrongType) {
  const absl::Status number =
      Failure("EvaluateTemplateRequest", R"({"parameters":[{"value":"wide"}]})");
  EXPECT_EQ(number.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(number).field, "parameters[0].value") << number;
  EXPECT_EQ(DetailOf(Failure("Operation", R"({"state":"DANCING"})")).field, "state");
  EXPECT_EQ(Failure("Event", R"({"number":"12x"})").code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(Failure("Event", R"({"time":"yesterday"})").code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(Failure("ReadEventsRequest", R"({"limit":1e20})").code(),
            absl::StatusCode::kInvalidArgument);
}

TEST_F(TranscoderTest, NamesEveryFieldAtFault) {
  const auto fields = [](const absl::Status& refused) {
    std::vector<std::string> names;
    for (const FieldViolation& violation : AllViolationsOf(refused)) {
      names.push_back(violation.field);
    }
    return names;
  };
  EXPECT_THAT(fields(Failure("EvaluateTemplateRequest",
                             R"({"nmae":"a","revision":"last","parameters":[{"value":"wide"},
                                {"name":1,"value":2},7]})")),
              testing::ElementsAre("nmae", "revision", "parameters[0].value", "parameters[1].name",
                                   "parameters[2]"));
  EXPECT_THAT(
      fields(Failure("ListItemsRequest", R"({"pageSize":1,"text":"a","page_size":2,"text":"b"})")),
      testing::ElementsAre("page_size", "text"));
  EXPECT_THAT(fields(Failure("GetItemRequest", R"({"nmae":"a",)")),
              testing::ElementsAre("nmae", "request"));
}

TEST_F(TranscoderTest, NamesTheNumberThatJsonHasNot) {
  const absl::Status refused = Failure("EvaluateTemplateRequest",
                                       R"({"parameters":[{"name":"a","value":1},{"value":NaN}]})");
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(refused).field, "parameters[1].value") << refused;
  EXPECT_THAT(std::string(refused.message()), HasSubstr("write \"NaN\", in quotes"));
}

TEST_F(TranscoderTest, RefusesWhatIsNotJson) {
  for (const std::string& bad :
       {std::string("{"), std::string("[]"), std::string("{\"name\":}"), std::string("nonsense"),
        std::string("{} trailing"), std::string("{name:\"items/a\"}"), std::string("{'name':'a'}"),
        std::string(), std::string("\xff\xfe"), std::string("{\"name\":\"\xc3\x28\"}"),
        std::string(100000, '[')}) {
    EXPECT_EQ(Failure("GetItemRequest", bad).code(), absl::StatusCode::kInvalidArgument)
        << bad.substr(0, 20);
  }
}

TEST_F(TranscoderTest, RefusesBytesThatAreNoMessage) {
  const std::string cut_short(
      "\x0a\x20"
      "abc");
  EXPECT_EQ(transcoder_.ToJson(Type("Event"), cut_short).status().code(),
            absl::StatusCode::kInternal);
}

}  // namespace
}  // namespace mortise::gateway
