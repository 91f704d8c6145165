// Requests as parameters of URLs.
#include "gateway/contract/query_message.h"

#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/base/errors.h"
#include "gateway/contract/contract.h"
#include "gateway/contract/transcoder.h"

namespace mortise::gateway {
namespace {

using Json = nlohmann::json;
using Parameters = std::map<std::string, std::string>;

class QueryMessageTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::string> Read(const std::string& type, const Parameters& parameters) const {
    return JsonOfQuery(*contract_->pool().FindMessageTypeByName("mortise.v1." + type), parameters);
  }

  // What the message says that the parameters make, by way of its bytes.
  Json Again(const std::string& type, const Parameters& parameters) const {
    const auto json = Read(type, parameters);
    if (!json.ok()) return json.status().ToString();
    const auto& descriptor = *contract_->pool().FindMessageTypeByName("mortise.v1." + type);
    const auto bytes = transcoder_.ToBinary(descriptor, *json);
    if (!bytes.ok()) return bytes.status().ToString();
    return Json::parse(transcoder_.ToJson(descriptor, *bytes).value_or(""), nullptr, false);
  }

  const std::unique_ptr<const Contract> contract_ = Contract::Load();
  const Transcoder transcoder_{*contract_};
};

TEST_F(QueryMessageTest, FieldsAreNamedByTheirPaths) {
  EXPECT_EQ(Again("ExportDesignRequest", {{"name", "templates/table"},
                                          {"format", "STEP"},
                                          {"revision", "3"},
                                          {"parameters[0].name", "length"},
                                          {"parameters[0].value", "1.5"},
                                          {"parameters[1].name", "style"},
                                          {"parameters[1].choice", "round"}}),
            Json::parse(R"({"name":"templates/table","revision":"3","format":"STEP",
                "parameters":[{"name":"length","value":1.5},{"name":"style","choice":"round"}]})"));
  EXPECT_EQ(Again("ListItemsRequest", {{"filter.externalId", "4711"},
                                       {"filter.labels[site]", "Hamburg"},
                                       {"filter.created_from", "2026-01-15T00:00:00Z"}}),
            Json::parse(R"({"filter":{"externalId":"4711","labels":{"site":"Hamburg"},
                "createdFrom":"2026-01-15T00:00:00Z"}})"));
  EXPECT_EQ(Again("ListItemsRequest", {}), Json::object());
  EXPECT_EQ(Again("ListOperationsRequest", {{"omit_results", "true"}}),
            Json({{"omitResults", true}}));
}

TEST_F(QueryMessageTest, ListsMayBeLong) {
  Parameters parameters;
  for (int i = 0; i < 12; ++i) parameters["q[" + std::to_string(i) + "]"] = std::to_string(i);
  EXPECT_EQ(Again("ExportAssemblyRequest", parameters),
            Json::parse(R"({"q":[0,1,2,3,4,5,6,7,8,9,10,11]})"));
}

TEST_F(QueryMessageTest, TheWholeMayBeJson) {
  EXPECT_EQ(*Read("ListItemsRequest", {{"message", R"({"kind":"BOLT"})"}}), R"({"kind":"BOLT"})");
  EXPECT_EQ(
      DetailOf(Read("ListItemsRequest", {{"message", "{}"}, {"kind", "BOLT"}}).status()).field,
      "message");
}

TEST_F(QueryMessageTest, WhatIsNoFieldIsNamed) {
  for (const char* name :
       {"nom", "name.x", "filter.nothing", "parameters", "parameters.name", "name[0]",
        "parameters[1].name", "parameters[-1].name", "parameters[x].name", "parameters[].name",
        "parameters[99999999999].name", "parameters[0", "", ".", "name.", "filter..creator", "[0]",
        "parameters[0]name"}) {
    const auto json = Read("ExportDesignRequest", {{name, "1"}});
    EXPECT_EQ(json.status().code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_EQ(DetailOf(json.status()).field, name);
  }
  EXPECT_FALSE(Read("ListItemsRequest", {{"pageSize", "1"}, {"page_size", "2"}}).ok());
  EXPECT_FALSE(Read("ListItemsRequest", {{"filter", "x"}, {"filter.creator", "y"}}).ok());
  std::string deep = "filter";
  for (int i = 0; i < 100; ++i) deep += ".filter";
  EXPECT_FALSE(Read("ListItemsRequest", {{deep, "x"}}).ok());
}

}  // namespace
}  // namespace mortise::gateway
