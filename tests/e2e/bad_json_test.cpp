// Bad requests at the HTTP door: each is answered with the code and the field that gRPC would tell.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "absl/strings/escaping.h"
#include "google/rpc/status.pb.h"
#include "tests/e2e/http_post.h"
#include "tests/e2e/running_house.h"

namespace mortise::e2e {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

constexpr char kGetItem[] = "/mortise.v1.CatalogService/GetItem";
constexpr char kListItems[] = "/mortise.v1.CatalogService/ListItems";
constexpr char kEvaluate[] = "/mortise.v1.CatalogService/EvaluateTemplate";
constexpr char kImportCatalog[] = "/mortise.v1.CatalogService/ImportCatalog";
constexpr char kUploadMesh[] = "/mortise.v1.RetrievalService/UploadMesh";
constexpr char kSearch[] = "/mortise.v1.RetrievalService/SearchShapes";
constexpr char kImport[] = "/mortise.v1.CatalogService/ImportTemplate";

constexpr std::size_t kEnvelopeHead = 5;  // bytes: flags, and the length in big-endian order

// A message as streams over HTTP have it.
std::string Envelope(const std::string& message) {
  std::string head(kEnvelopeHead, '\0');
  for (std::size_t i = 1; i < kEnvelopeHead; ++i) {
    head[i] = static_cast<char>(message.size() >> (8 * (kEnvelopeHead - 1 - i)));
  }
  return head + message;
}

class BadJsonTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = std::make_unique<RunningHouse>(); }
  static void TearDownTestSuite() { house_.reset(); }

  void SetUp() override {
    ASSERT_TRUE(house_->Serving()) << house_->Log();
    processes_ = house_->Processes();
  }
  void TearDown() override {
    EXPECT_EQ(house_->Processes(), processes_);
    const HttpAnswer good = Post(house_->HttpAddress(), kGetItem, "application/json",
                                 R"({"name":"items/board-38x89"})");
    EXPECT_EQ(good.status, 200) << good.body;
  }

  static HttpAnswer Send(const char* path, const std::string& body,
                         const std::string& content_type = "application/json") {
    return Post(house_->HttpAddress(), path, content_type, body);
  }

  // The failure must be the caller's, with `code`, and say `words`.
  static void ExpectRefused(const HttpAnswer& answer, const std::string& code,
                            const std::string& words) {
    EXPECT_GE(answer.status, 400) << answer.body;
    EXPECT_LT(answer.status, 500) << answer.body;
    const Json error = Json::parse(answer.body, nullptr, false);
    ASSERT_TRUE(error.is_object()) << answer.body;
    EXPECT_EQ(error.value("code", ""), code) << answer.body;
    EXPECT_THAT(error.value("message", ""), HasSubstr(words));
  }

  // Every field that a refusal names: its details are what gRPC clients get.
  static std::vector<std::string> FieldsOf(const HttpAnswer& answer) {
    const Json error = Json::parse(answer.body, nullptr, false);
    std::vector<std::string> fields;
    for (const Json& detail : error.value("details", Json::array())) {
      std::string value;
      google::rpc::BadRequest bad_request;
      if (detail.value("type", "") != "google.rpc.BadRequest") continue;
      EXPECT_TRUE(absl::Base64Unescape(detail.value("value", ""), &value));
      EXPECT_TRUE(bad_request.ParseFromString(value));
      for (const auto& violation : bad_request.field_violations()) {
        fields.push_back(violation.field());
      }
    }
    return fields;
  }

  static std::unique_ptr<RunningHouse> house_;
  std::map<std::string, pid_t> processes_;
};

std::unique_ptr<RunningHouse> BadJsonTest::house_;

// What clients without gRPC do with a mesh: all chunks in one body, each in an envelope.
TEST_F(BadJsonTest, AMeshThatIsUploadedIsSearchedWith) {
  const std::string mesh =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
  const auto upload = [&](std::size_t declared) {
    const std::size_t half = mesh.size() / 2;
    const Json chunks[] = {
        {{"totalSize", declared}, {"data", absl::Base64Escape(mesh.substr(0, half))}},
        {{"offset", half}, {"data", absl::Base64Escape(mesh.substr(half))}}};
    std::string body;
    for (const Json& chunk : chunks) body += Envelope(chunk.dump());
    return Send(kUploadMesh, body, "application/connect+json");
  };
  const HttpAnswer uploaded = upload(mesh.size());
  ASSERT_EQ(uploaded.status, 200) << uploaded.body;
  const std::string before = "\"sha256\":\"";
  const std::size_t at = uploaded.body.find(before);
  ASSERT_NE(at, std::string::npos) << uploaded.body;
  const std::string digest = uploaded.body.substr(at + before.size(), 64);
  const auto search = [](const std::string& of) {
    return Send(kSearch, Json{{"mesh", {{"upload", of}}}}.dump());
  };
  // It was read, so all that is missing is an index, which nobody has built.
  ExpectRefused(search(digest), "failed_precondition", "no index");
  ExpectRefused(search(std::string(64, '0')), "invalid_argument", "mesh.upload");

  // A stream fails in its last envelope.
  EXPECT_THAT(upload(mesh.size() + 1).body, HasSubstr("total_size"));
  EXPECT_THAT(upload(std::size_t{2} << 30).body, HasSubstr("resource_exhausted"));
}

TEST_F(BadJsonTest, WhatIsNoJsonIsRefused) {
  for (const std::string& body :
       {std::string("{"), std::string("no json"), std::string("[]"), std::string("\0\xFF", 2),
        std::string("{\"name\":\"caf\xE9\"}"), std::string(5000, '['),
        std::string("{\"name\":\"items/a\"} trailing"), std::string("{name:'items/a'}")}) {
    ExpectRefused(Send(kGetItem, body), "invalid_argument", "");
  }
}

TEST_F(BadJsonTest, WrongTypesAreRefusedByName) {
  ExpectRefused(Send(kGetItem, R"({"name":5})"), "invalid_argument", "name");
  ExpectRefused(Send(kGetItem, R"({"name":["items/a"]})"), "invalid_argument", "name");
  ExpectRefused(Send(kListItems, R"({"pageSize":"many"})"), "invalid_argument", "page_size");
  ExpectRefused(Send(kListItems, R"({"pageSize":99999999999})"), "invalid_argument", "page_size");
  ExpectRefused(Send(kListItems, R"({"pageSize":-1})"), "invalid_argument", "page_size");
  ExpectRefused(Send(kListItems, R"({"pageToken":"no such token!"})"), "invalid_argument",
                "page_token");
  ExpectRefused(Send(kListItems, R"({"kind":"SPOON"})"), "invalid_argument", "kind");
  ExpectRefused(Send(kListItems, R"({"kind":9999})"), "invalid_argument", "kind");
}

TEST_F(BadJsonTest, UnknownFieldsAreRefusedByName) {
  ExpectRefused(Send(kGetItem, R"({"name":"items/a","colour":"red"})"), "invalid_argument",
                "colour");
}

TEST_F(BadJsonTest, EveryFieldThatCannotBeReadIsTold) {
  const HttpAnswer answer = Send(kEvaluate, R"({"name":"templates/table","colour":"red",
      "parameters":[{"name":"length","value":"wide"},{"name":"width","value":1,"value":2}]})");
  ExpectRefused(answer, "invalid_argument", "3 findings");
  EXPECT_THAT(FieldsOf(answer),
              testing::ElementsAre("colour", "parameters[0].value", "parameters[1].value"));
}

TEST_F(BadJsonTest, FieldsThatAreThereTwiceAreRefused) {
  const HttpAnswer answer =
      Send(kListItems,
           R"({"pageSize":5,"kind":"DOWEL","text":"a","page_size":7,"kind":"NUT","text":""})");
  ExpectRefused(answer, "invalid_argument", "is there twice");
  EXPECT_THAT(FieldsOf(answer), testing::ElementsAre("page_size", "kind", "text"));
}

TEST_F(BadJsonTest, NumbersThatAreNoneAreRefusedByName) {
  for (const char* number : {R"("NaN")", R"("Infinity")", R"("-Infinity")"}) {
    ExpectRefused(Send(kEvaluate, std::string(R"({"name":"templates/table","parameters":[)") +
                                      R"({"name":"length","value":)" + number + "}]}"),
                  "invalid_argument", "parameters[0].value");
  }
  ExpectRefused(
      Send(kEvaluate,
           R"({"name":"templates/table","parameters":[{"name":"length","value":"1e999"}]})"),
      "invalid_argument", "value");
}

TEST_F(BadJsonTest, BodiesAboveTheLimitAreRefusedUnread) {
  const HttpAnswer answer =
      Post(house_->HttpAddress(), kGetItem, "application/json", "", std::size_t{5} << 20);
  ExpectRefused(answer, "resource_exhausted", "");
}

TEST_F(BadJsonTest, WrongContentTypesAreRefused) {
  for (const char* type : {"text/plain", "application/xml", "multipart/form-data", ""}) {
    const HttpAnswer answer = Send(kGetItem, R"({"name":"items/board-38x89"})", type);
    EXPECT_EQ(answer.status, 415) << type << ": " << answer.body;
  }
}

TEST_F(BadJsonTest, BytesThatAreNoMessageAreRefused) {
  ExpectRefused(Send(kGetItem, "\xFF\xFF\xFF", "application/proto"), "invalid_argument",
                "is not a message");
  ExpectRefused(Send(kGetItem, "\x0A\x04\x63\x61\x66\xE9", "application/proto"), "invalid_argument",
                "is not a message");
}

TEST_F(BadJsonTest, EveryFindingOfATemplateIsTold) {
  const HttpAnswer answer = Send(kImport, R"({"requestId":"bad-1","template":{
      "name":"templates/stool",
      "parameters":[{"name":"1st","unit":"m","minimum":2,"maximum":1},
                    {"name":"height","unit":"","minimum":0.4,"maximum":0.6,"defaultValue":0.5}],
      "parts":[{"name":"seat","item":"items/none","lengthAxis":"X","thicknessAxis":"Z",
                "box":{"x":{"from":"0","to":"depth"},"y":{"from":"0","to":"0.3"},
                       "z":{"from":"0","to":"0.02"}}}]}})");
  ExpectRefused(answer, "invalid_argument", "5 findings");
  EXPECT_THAT(FieldsOf(answer), testing::UnorderedElementsAre(
                                    "template.parameters[0].name", "template.parameters[0].maximum",
                                    "template.parameters[1].unit", "template.parts[0].item",
                                    "template.parts[0].box.x.to"));
}

TEST_F(BadJsonTest, AnImportIsStoredWholeOrNotAtAll) {
  const auto request = [](const std::string& id, const std::string& amount) {
    const std::string sizes = R"("dimensions":[{"axis":"X","size":0.035},{"axis":"Y","size":0.008},
        {"axis":"Z","size":0.008}],"priceBasis":"PER_PIECE","priceDate":"2026-01-15")";
    return R"({"requestId":")" + id + R"(","materials":[{"name":"materials/elm","title":"Elm",
        "density":560,"youngsModulus":9e9,"poissonsRatio":0.3,"strength":5e7}],"items":[
        {"name":"items/elm-peg","title":"Peg","kind":"DOWEL","material":"materials/elm",
         "price":{"currency":"EUR","amount":0.07},)" +
           sizes + R"(},
        {"name":"items/elm-pin","title":"Pin","kind":"DOWEL","material":"materials/elm",
         "price":{"currency":"EUR","amount":)" +
           amount + "}," + sizes + "}]}";
  };
  const HttpAnswer refused = Send(kImportCatalog, request("elm-1", "-1"));
  ExpectRefused(refused, "invalid_argument", "items[1].price.amount");
  EXPECT_THAT(FieldsOf(refused), testing::ElementsAre("items[1].price.amount"));
  EXPECT_EQ(Send(kGetItem, R"({"name":"items/elm-peg"})").status, 404);
  for (int repeat = 0; repeat < 2; ++repeat) {
    const HttpAnswer stored = Send(kImportCatalog, request("elm-2", "0.05"));
    EXPECT_EQ(stored.status, 200) << stored.body;
    EXPECT_EQ(Json::parse(stored.body, nullptr, false)["createdCount"], 3) << stored.body;
  }
  EXPECT_EQ(Send(kGetItem, R"({"name":"items/elm-peg"})").status, 200);
}

}  // namespace
}  // namespace mortise::e2e
