// Pages of other origins: those that were stated, and all others.
#include <gmock/gmock.h>

#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using Headers = std::map<std::string, std::string>;

constexpr char kOrigin[] = "https://plm.example";
const std::string kMethod = "/mortise.v1.CatalogService/GetItem";

class CrossOriginTest : public GatewayTest {
 protected:
  void StartWith(std::vector<std::string> origins) {
    GatewayOptions options = Options();
    options.cors_origins = std::move(origins);
    StartGateway(options);
  }

  HttpAnswer Ask(const std::string& method, const Headers& headers, const std::string& body = "") {
    return Http(gateway_->addresses().http, method, kMethod, headers, body);
  }
};

TEST_F(CrossOriginTest, APageThatWasStatedMayCall) {
  StartWith({kOrigin, "http://localhost:5173"});
  for (const char* origin : {kOrigin, "http://localhost:5173"}) {
    const HttpAnswer preflight =
        Ask("OPTIONS", {{"Origin", origin},
                        {"Access-Control-Request-Method", "POST"},
                        {"Access-Control-Request-Headers", "authorization,content-type"}});
    EXPECT_EQ(preflight.status, 204);
    EXPECT_EQ(preflight.headers.at("access-control-allow-origin"), origin);
    EXPECT_THAT(preflight.headers.at("access-control-allow-methods"), HasSubstr("POST"));
    EXPECT_EQ(preflight.headers.at("access-control-allow-headers"), "authorization,content-type");
    EXPECT_EQ(preflight.headers.count("access-control-allow-credentials"), 0u);
  }
  const HttpAnswer call = Ask("POST", {{"Origin", kOrigin}, {"Content-Type", "application/json"}},
                              R"({"name":"items/a"})");
  EXPECT_EQ(call.status, 200);
  EXPECT_EQ(call.headers.at("access-control-allow-origin"), kOrigin);
  EXPECT_THAT(call.headers.at("access-control-expose-headers"), HasSubstr("ETag"));
  // Failures are read by the page, too.
  EXPECT_EQ(Ask("DELETE", {{"Origin", kOrigin}}).headers.at("access-control-allow-origin"),
            kOrigin);
}

TEST_F(CrossOriginTest, NoOtherPageGetsLeave) {
  StartWith({kOrigin});
  for (const char* origin : {"https://evil.example", "https://plm.example.evil.example", "null",
                             "http://plm.example", "https://plm.example:444", ""}) {
    const HttpAnswer answer =
        Ask("OPTIONS", {{"Origin", origin}, {"Access-Control-Request-Method", "POST"}});
    EXPECT_EQ(answer.headers.count("access-control-allow-origin"), 0u) << origin;
    EXPECT_EQ(answer.headers.count("access-control-allow-methods"), 0u) << origin;
    EXPECT_EQ(answer.headers.at("vary"), "Origin") << origin;
  }
}

TEST_F(CrossOriginTest, NoPageGetsLeaveWhereNoneWasStated) {
  StartWith({});
  const HttpAnswer answer =
      Ask("OPTIONS", {{"Origin", kOrigin}, {"Access-Control-Request-Method", "POST"}});
  EXPECT_EQ(answer.headers.count("access-control-allow-origin"), 0u);
  EXPECT_EQ(answer.headers.count("access-control-allow-headers"), 0u);
}

TEST_F(CrossOriginTest, OriginsThatWouldMeanAnybodyAreRefused) {
  for (const char* origin :
       {"*", "null", "", "plm.example", "https://", "https://plm.example/", "https://*.example",
        "https://a\r\nb", "ftp://plm.example", "https://user@plm.example", "https://PLM.example"}) {
    GatewayOptions options = Options();
    options.cors_origins = {origin};
    const auto gateway = Gateway::Start(options);
    ASSERT_FALSE(gateway.ok()) << origin;
    EXPECT_THAT(std::string(gateway.status().message()), HasSubstr("cors-origin")) << origin;
  }
}

}  // namespace
}  // namespace mortise::gateway
