// Items as a table, out and in.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "gateway/http/compression.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;
using Headers = std::map<std::string, std::string>;

const std::string kHeader =
    "name,kind,material,length,width,thickness,price,currency,price_date\r\n";

std::string Row(const std::string& name, const std::string& price = "0.5") {
  return name + ",SCREW,materials/steel,0.04,0.004,0.004," + price + ",EUR,2026-01-15\r\n";
}

class ItemsCsvTest : public GatewayTest {
 protected:
  void SetUp() override { StartGateway(Options()); }

  HttpAnswer Ask(const std::string& method, const std::string& target, Headers headers = {},
                 const std::string& body = "") {
    return Http(gateway_->addresses().http, method, target, headers, body);
  }

  HttpAnswer Import(const std::string& table, Headers headers = {}) {
    headers.emplace("Content-Type", "text/csv; charset=utf-8");
    return Ask("POST", "/items.csv", headers, table);
  }
};

TEST_F(ItemsCsvTest, AllPagesAreOneTable) {
  const HttpAnswer answer = Ask("GET", "/items.csv?kind=BOLT");
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_THAT(answer.headers.at("content-type"), StartsWith("text/csv"));
  EXPECT_THAT(answer.headers.at("content-disposition"), HasSubstr("items.csv"));
  EXPECT_THAT(answer.body, StartsWith("\xef\xbb\xbfname,title,kind,"));
  EXPECT_THAT(answer.body, HasSubstr("\r\nitems/a,\"Screw, \"\"small\"\"\",BOLT,"));
  EXPECT_THAT(answer.body, HasSubstr("\r\nitems/b,\"Bohle, größer\",BOLT,"));
  EXPECT_EQ(
      Ask("GET", "/items.csv?kind=BOLT", {{"If-None-Match", answer.headers.at("etag")}}).status,
      304);
  EXPECT_EQ(Ask("HEAD", "/items.csv").body, "");
}

TEST_F(ItemsCsvTest, WrongFiltersAreNamed) {
  for (const char* filter : {"kind=NAIL", "sort=name", "page_size=5", "pageToken=x"}) {
    const HttpAnswer answer = Ask("GET", std::string("/items.csv?") + filter);
    EXPECT_EQ(answer.status, 400) << filter << answer.body;
    EXPECT_EQ(Json::parse(answer.body)["reason"], "FIELD_INVALID") << filter;
  }
}

TEST_F(ItemsCsvTest, ATableIsImported) {
  const std::string table = kHeader + Row("items/x") + Row("items/y");
  const HttpAnswer answer = Import(table, {{"Idempotency-Key", "plm-7"}});
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(Json::parse(answer.body)["createdCount"], 2);
  const HttpAnswer compressed =
      Import(GzipWriter().Add(table, true), {{"Content-Encoding", "gzip"}});
  EXPECT_EQ(compressed.status, 200) << compressed.body;
}

TEST_F(ItemsCsvTest, EveryFaultHasItsPlace) {
  const HttpAnswer unread = Import(kHeader + Row("items/x", "cheap") + "items/y,SCREW\r\n");
  EXPECT_EQ(unread.status, 400);
  const Json faults = Json::parse(unread.body)["fields"];
  ASSERT_EQ(faults.size(), 2u) << unread.body;
  EXPECT_THAT(faults.dump(), HasSubstr("line 2, column 7 (price)"));
  EXPECT_THAT(faults.dump(), HasSubstr("line 3"));
  const HttpAnswer refused = Import(kHeader + Row("items/x") + Row("items/bad"));
  EXPECT_EQ(refused.status, 400);
  EXPECT_EQ(Json::parse(refused.body)["fields"][0]["field"],
            "line 3, column 7 (price): price.amount");
}

TEST_F(ItemsCsvTest, OtherBodiesAreRefused) {
  EXPECT_EQ(Import("", {{"Content-Type", "application/json"}}).status, 415);
  EXPECT_EQ(Import("").status, 400);
  EXPECT_EQ(Import(std::string(5 << 20, 'x')).status, 429);
  EXPECT_EQ(Ask("DELETE", "/items.csv").status, 405);
}

}  // namespace
}  // namespace mortise::gateway
