// Messages in gzip, both ways, over HTTP.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "gateway/http/compression.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;

class GzipTest : public GatewayTest {
 protected:
  void SetUp() override { StartGateway(Options()); }

  HttpAnswer Call(const std::string& body, std::map<std::string, std::string> headers) {
    headers.emplace("Content-Type", "application/json");
    return Http(gateway_->addresses().http, "POST", "/mortise.v1.CatalogService/GetItem", headers,
                body);
  }

  static std::string Compressed(const std::string& text) { return GzipWriter().Add(text, true); }
};

TEST_F(GzipTest, RequestsAreExpanded) {
  const std::string name = "items/" + std::string(100000, 'x');
  const HttpAnswer answer =
      Call(Compressed(nlohmann::json{{"name", name}}.dump()), {{"Content-Encoding", "gzip"}});
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(nlohmann::json::parse(answer.body)["name"], name);
}

TEST_F(GzipTest, LargeAnswersAreCompressedForWhoTakesIt) {
  const std::string request = nlohmann::json{{"name", "items/" + std::string(5000, 'x')}}.dump();
  const HttpAnswer answer = Call(request, {{"Accept-Encoding", "deflate, gzip;q=0.5"}});
  EXPECT_EQ(answer.headers.at("content-encoding"), "gzip");
  EXPECT_THAT(answer.headers.at("vary"), HasSubstr("Accept-Encoding"));
  EXPECT_LT(answer.body.size(), 1000u);
  const auto text = ExpandGzip(answer.body, 10000);
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_THAT(*text, HasSubstr("xxxx"));
  for (const char* accepted : {"", "br", "gzip;q=0", "*;q=0"}) {
    EXPECT_EQ(Call(request, {{"Accept-Encoding", accepted}}).headers.count("content-encoding"), 0u)
        << accepted;
  }
  EXPECT_EQ(Call(R"({"name":"items/a"})", {{"Accept-Encoding", "gzip"}})
                .headers.count("content-encoding"),
            0u)
      << "small ones stay as they are";
}

TEST_F(GzipTest, WhatExpandsTooFarOrIsDamagedIsRefused) {
  const std::string bomb = Compressed(std::string(std::size_t{200} << 20, ' '));
  ASSERT_LT(bomb.size(), kMaximalBodyBytes);
  EXPECT_EQ(Call(bomb, {{"Content-Encoding", "gzip"}}).status, 429);
  const std::string sound = Compressed(R"({"name":"items/a"})");
  for (const std::string& body : {std::string(), std::string("{}"),
                                  sound.substr(0, sound.size() - 1), sound + "x", sound + sound}) {
    EXPECT_EQ(Call(body, {{"Content-Encoding", "gzip"}}).status, 400);
  }
  EXPECT_EQ(Call(sound, {{"Content-Encoding", "gzip"}}).status, 200) << "and nothing is held";
}

}  // namespace
}  // namespace mortise::gateway
