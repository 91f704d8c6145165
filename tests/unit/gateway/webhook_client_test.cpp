// Addresses that webhooks may call, and signatures.
#include "gateway/webhook_client.h"

#include <gtest/gtest.h>

#include <utility>

#include "common/base/errors.h"

namespace mortise::gateway {
namespace {

TEST(WebhookUrl, TakesHttpAndHttps) {
  const auto plain = ParseWebhookUrl("http://plm.example/hook?x=1#part");
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_FALSE(plain->secure);
  EXPECT_EQ(plain->host, "plm.example");
  EXPECT_EQ(plain->port, "80");
  EXPECT_EQ(plain->target, "/hook?x=1");
  const auto secure = ParseWebhookUrl("https://[2001:db8::1]:8443");
  ASSERT_TRUE(secure.ok()) << secure.status();
  EXPECT_TRUE(secure->secure);
  EXPECT_EQ(secure->host, "2001:db8::1");
  EXPECT_EQ(secure->port, "8443");
  EXPECT_EQ(secure->target, "/");
  EXPECT_EQ(ParseWebhookUrl("https://host?x")->target, "/?x");
}

TEST(WebhookUrl, RefusesOtherThings) {
  for (const std::string& bad :
       {std::string(), std::string("host"), std::string("ftp://host/"), std::string("file:///etc"),
        std::string("http://"), std::string("http:///path"), std::string("http://user:word@host/"),
        std::string("http://host:port/"), std::string("http://host:123456/"),
        std::string("http://host:65536/"), std::string("http://host:0/"),
        std::string("http://[::1"), std::string("http://[::1]x/"), std::string("http://ho st/"),
        std::string("http://host/\r\nX: y"), "http://host/" + std::string(3000, 'a')}) {
    EXPECT_FALSE(ParseWebhookUrl(bad).ok()) << bad.substr(0, 40);
  }
}

TEST(WebhookAddress, RefusesWhatIsNobodysBusiness) {
  auto allowed = [](const char* text, bool loopback = false) {
    return IsAllowedAddress(boost::asio::ip::make_address(text), loopback);
  };
  EXPECT_TRUE(allowed("93.184.216.34"));
  EXPECT_TRUE(allowed("10.1.2.3"));
  EXPECT_TRUE(allowed("2001:db8::1"));
  for (const char* bad : {"127.0.0.1", "127.8.9.1", "::1", "0.0.0.0", "::", "169.254.169.254",
                          "224.0.0.1", "255.255.255.255", "fe80::1", "ff02::1",
                          "::ffff:169.254.169.254", "::ffff:127.0.0.1", "0.1.2.3"}) {
    EXPECT_FALSE(allowed(bad)) << bad;
  }
  EXPECT_TRUE(allowed("127.0.0.1", true));
  EXPECT_TRUE(allowed("::ffff:127.0.0.1", true));
  EXPECT_FALSE(allowed("169.254.169.254", true));
}

TEST(WebhookHost, IsRefusedWhereDeliveriesWouldBe) {
  const auto check = [](const std::string& url, bool loopback = false) {
    return CheckWebhookHost(*ParseWebhookUrl(url), loopback);
  };
  // Also in the older spellings of 127.0.0.1 and 169.254.169.254.
  for (const char* bad : {"http://127.0.0.1:9/hook", "https://[::1]/", "http://127.1/",
                          "http://2130706433/", "http://0x7f000001/",
                          "http://169.254.169.254/latest/", "http://2852039166/", "http://0.0.0.0/",
                          "http://[fe80::1]/", "http://[::ffff:127.0.0.1]/", "http://224.0.0.1/"}) {
    const absl::Status status = check(bad);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad;
    EXPECT_EQ(DetailOf(status).field, "url") << bad;
  }
  EXPECT_TRUE(check("http://127.0.0.1:9/hook", true).ok());
  EXPECT_FALSE(check("http://169.254.169.254/latest/", true).ok());
  EXPECT_TRUE(check("https://192.0.2.1/hook").ok());
  EXPECT_TRUE(check("http://10.1.2.3:8080/").ok()) << "private networks are where PLM systems are";
}

TEST(WebhookSignature, IsAnHmacOverTimeAndBody) {
  // echo -n '1800000000.{}' | openssl dgst -sha256 -hmac secret
  EXPECT_EQ(SignWebhook("secret", 1800000000, "{}"),
            "t=1800000000,v1=bb7079132825ac793cea8c013c1dd24d926b9b02132245b10588d9e5c0df70d7");
}

}  // namespace
}  // namespace mortise::gateway
