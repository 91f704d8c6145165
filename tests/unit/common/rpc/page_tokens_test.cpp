// Page tokens: each is of one list with one filter, whatever the size of the pages.
#include "common/rpc/page_tokens.h"

#include <gtest/gtest.h>

#include <string>

#include "common/base/errors.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::rpc {
namespace {

v1::ListItemsRequest BoltsOfSteel() {
  v1::ListItemsRequest request;
  request.set_kind(v1::BOLT);
  request.set_material("materials/steel");
  request.set_page_size(10);
  return request;
}

template <typename Request>
void ExpectRefused(const std::string& token, const Request& request) {
  const auto position = OpenPageToken(token, request);
  ASSERT_EQ(position.status().code(), absl::StatusCode::kInvalidArgument) << token;
  EXPECT_EQ(DetailOf(position.status()).field, "page_token");
}

TEST(PageTokens, GiveBackThePositionOnPagesOfAnySize) {
  v1::ListItemsRequest request = BoltsOfSteel();
  for (const std::string& position :
       {std::string("bolt-m8"), std::string("\0\xff/+=\n", 6), std::string(10'000, 'x')}) {
    const std::string token = SealPageToken(position, request);
    EXPECT_EQ(token.find_first_of("+/= \n"), std::string::npos) << "fits into a URL";
    request.set_page_size(500);
    request.set_page_token(token);
    EXPECT_EQ(OpenPageToken(token, request).value_or("refused"), position);
  }
}

TEST(PageTokens, AreEmptyAtTheEnds) {
  EXPECT_EQ(SealPageToken("", BoltsOfSteel()), "");
  EXPECT_EQ(OpenPageToken("", BoltsOfSteel()).value_or("refused"), "");
}

TEST(PageTokens, AreOfTheirListAndFilterOnly) {
  const std::string token = SealPageToken("bolt-m8", BoltsOfSteel());
  v1::ListItemsRequest other = BoltsOfSteel();
  other.set_kind(v1::NUT);
  ExpectRefused(token, other);
  other = BoltsOfSteel();
  other.clear_material();
  ExpectRefused(token, other);
  other = BoltsOfSteel();
  other.set_text("m8");
  ExpectRefused(token, other);
  ExpectRefused(SealPageToken("oak", v1::ListItemsRequest()), v1::ListMaterialsRequest());
}

TEST(PageTokens, CannotBeMadeUp) {
  const v1::ListItemsRequest request = BoltsOfSteel();
  const std::string token = SealPageToken("bolt-m8", request);
  for (const std::string& made_up :
       {std::string("bolt-m8"), std::string("no such token!"), std::string("a\0b", 3),
        std::string(100'000, 'a'), token + "A", token.substr(0, token.size() - 4),
        token.substr(0, 20), std::string(1, token[0] == 'A' ? 'B' : 'A') + token.substr(1)}) {
    ExpectRefused(made_up, request);
  }
}

TEST(PageTokens, AreSpeltInOneWay) {
  const v1::ListItemsRequest request = BoltsOfSteel();
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  for (const std::string position : {"bolt", "bolts", "bolt-8"}) {  // ends in 2, 4 and 0 spare bits
    const std::string token = SealPageToken(position, request);
    for (const char last : letters) {
      if (last == token.back()) continue;
      ExpectRefused(token.substr(0, token.size() - 1) + last, request);
    }
    for (const char* const added : {"=", "==", " ", "\n"}) ExpectRefused(token + added, request);
  }
}

}  // namespace
}  // namespace mortise::rpc
