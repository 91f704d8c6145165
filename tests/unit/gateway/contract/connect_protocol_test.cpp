// Headers, envelopes and errors of the Connect protocol.
#include "gateway/contract/connect_protocol.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace mortise::gateway {
namespace {

TEST(ConnectProtocol, KnowsItsContentTypes) {
  EXPECT_FALSE(ParseContentType("application/json")->streaming);
  EXPECT_TRUE(ParseContentType("Application/JSON; charset=utf-8")->json);
  EXPECT_TRUE(ParseContentType("application/connect+json")->streaming);
  EXPECT_FALSE(ParseContentType("application/connect+proto")->json);
  EXPECT_FALSE(ParseContentType("text/plain").has_value());
  EXPECT_FALSE(ParseContentType("").has_value());
  for (const bool json : {false, true}) {
    for (const bool streaming : {false, true}) {
      const auto parsed = ParseContentType(ContentTypeOf({json, streaming}));
      ASSERT_TRUE(parsed.has_value());
      EXPECT_EQ(parsed->json, json);
      EXPECT_EQ(parsed->streaming, streaming);
    }
  }
}

TEST(ConnectProtocol, EnvelopesComeBackAsTheyWere) {
  const std::string long_payload(70000, 'x');
  const std::string body = Envelope(0, "one") + Envelope(0, "") + Envelope(0, long_payload);
  const auto payloads = SplitEnvelopes(body, 1 << 20);
  ASSERT_TRUE(payloads.ok()) << payloads.status();
  ASSERT_EQ(payloads->size(), 3u);
  EXPECT_EQ((*payloads)[0], "one");
  EXPECT_EQ((*payloads)[1], "");
  EXPECT_EQ((*payloads)[2], long_payload);
}

TEST(ConnectProtocol, RefusesMalformedEnvelopes) {
  const std::string good = Envelope(0, "payload");
  for (std::size_t cut = 1; cut < good.size(); ++cut) {
    EXPECT_EQ(SplitEnvelopes(std::string_view(good).substr(0, cut), 100).status().code(),
              absl::StatusCode::kInvalidArgument)
        << cut;
  }
  EXPECT_EQ(SplitEnvelopes(Envelope(0, "too long"), 4).status().code(),
            absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(SplitEnvelopes(Envelope(1, "zipped"), 100).status().code(),
            absl::StatusCode::kUnimplemented);
  EXPECT_EQ(SplitEnvelopes(Envelope(2, "{}"), 100).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(ConnectProtocol, ReadsTimeouts) {
  EXPECT_EQ(*ParseTimeout("1500"), absl::Milliseconds(1500));
  EXPECT_EQ(*ParseTimeout("9999999999"), absl::Milliseconds(9999999999));
  for (const char* bad : {"", "-1", "1.5", "12345678901", " 1", "1s"}) {
    EXPECT_FALSE(ParseTimeout(bad).ok()) << bad;
  }
}

TEST(ConnectProtocol, WritesErrors) {
  const ConnectError error{absl::StatusCode::kNotFound, "there is no \"x\"", {{"a.B", "\x01\x02"}}};
  const auto json = nlohmann::json::parse(ErrorJson(error));
  EXPECT_EQ(json["code"], "not_found");
  EXPECT_EQ(json["message"], "there is no \"x\"");
  EXPECT_EQ(json["details"][0]["type"], "a.B");
  EXPECT_EQ(json["details"][0]["value"], "AQI");
  EXPECT_EQ(HttpStatusOf(error.code), 404);
  EXPECT_EQ(ConnectCodeName(absl::StatusCode::kCancelled), "canceled");
}

TEST(ConnectProtocol, WritesTheEndOfStreams) {
  EXPECT_EQ(EndStreamJson(std::nullopt, {}), "{}");
  const auto json = nlohmann::json::parse(EndStreamJson(
      ConnectError{absl::StatusCode::kAborted, "later", {}}, {{"a", "1"}, {"a", "2"}}));
  EXPECT_EQ(json["error"]["code"], "aborted");
  EXPECT_EQ(json["metadata"]["a"], (nlohmann::json{"1", "2"}));
}

}  // namespace
}  // namespace mortise::gateway
