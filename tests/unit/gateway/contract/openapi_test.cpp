// The OpenAPI document: complete, and every reference in it leads somewhere.
#include "gateway/contract/openapi.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "gateway/contract/contract.h"

namespace mortise::gateway {
namespace {

using Json = nlohmann::json;

void CheckReferences(const Json& node, const Json& document) {
  if (node.is_object()) {
    if (const auto found = node.find("$ref"); found != node.end()) {
      const std::string target = found->get<std::string>().substr(1);
      EXPECT_TRUE(document.contains(Json::json_pointer(target))) << target;
    }
  }
  if (node.is_structured()) {
    for (const Json& child : node) CheckReferences(child, document);
  }
}

TEST(OpenApi, DescribesEveryMethod) {
  const auto contract = Contract::Load();
  const Json document = Json::parse(OpenApiDocument(*contract, "1.2.3"));
  EXPECT_EQ(document["openapi"], "3.1.0");
  EXPECT_EQ(document["info"]["version"], "1.2.3");
  for (const MethodRoute& method : contract->methods()) {
    ASSERT_TRUE(document["paths"].contains(method.path)) << method.path;
    EXPECT_FALSE(document["paths"][method.path]["post"]["summary"].get<std::string>().empty())
        << method.path << " has no comment";
  }
  CheckReferences(document, document);
}

TEST(OpenApi, WritesTypesAsTheirJsonForm) {
  const auto contract = Contract::Load();
  const Json document = Json::parse(OpenApiDocument(*contract, "1"));
  const Json& event = document["components"]["schemas"]["mortise.v1.Event"];
  EXPECT_EQ(event["properties"]["number"]["type"], "string");
  EXPECT_EQ(event["properties"]["time"]["format"], "date-time");
  const Json& operation = document["components"]["schemas"]["mortise.v1.Operation"];
  EXPECT_EQ(operation["properties"]["state"]["$ref"],
            "#/components/schemas/mortise.v1.Operation.State");
  EXPECT_FALSE(operation["properties"]["createTime"]["description"].get<std::string>().empty());
  EXPECT_TRUE(document["paths"].contains("/events"));
}

TEST(OpenApi, LabelsAreObjectsOfTexts) {
  const auto contract = Contract::Load();
  const Json document = Json::parse(OpenApiDocument(*contract, "1"));
  const Json& schemas = document["components"]["schemas"];
  for (const char* const type :
       {"Material", "Item", "Template", "Assembly", "Evaluator", "Front", "Analysis", "Plan",
        "WorkOrder", "Webhook", "Operation", "CreatePlanRequest", "ResourceFilter"}) {
    const Json& labels = schemas[std::string("mortise.v1.") + type]["properties"]["labels"];
    EXPECT_EQ(labels["type"], "object") << type;
    EXPECT_EQ(labels["additionalProperties"], Json({{"type", "string"}})) << type;
  }
  const Json& ids = schemas["mortise.v1.Plan"]["properties"]["externalIds"];
  EXPECT_EQ(ids["items"]["type"], "string");
  const Json& filter = schemas["mortise.v1.ListPlansRequest"]["properties"]["filter"];
  EXPECT_EQ(filter["$ref"], "#/components/schemas/mortise.v1.ResourceFilter");
  // Entries of maps are no types of their own.
  for (const auto& [name, schema] : schemas.items()) {
    EXPECT_EQ(name.find("LabelsEntry"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace mortise::gateway
