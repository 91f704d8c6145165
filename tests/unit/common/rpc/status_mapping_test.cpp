#include "common/rpc/status_mapping.h"

#include <grpcpp/support/status.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "google/rpc/status.pb.h"

namespace mortise::rpc {
namespace {

void ExpectSurvives(const absl::Status& status) {
  const absl::Status back = FromGrpc(ToGrpc(status));
  EXPECT_EQ(back.code(), status.code());
  EXPECT_EQ(back.message(), status.message());
  EXPECT_EQ(DetailOf(back).reason, DetailOf(status).reason);
  EXPECT_EQ(DetailOf(back).field, DetailOf(status).field);
}

TEST(StatusMappingTest, TheWholeCatalogueSurvives) {
  ExpectSurvives(absl::OkStatus());
  ExpectSurvives(InvalidField("parameters[2].value", "must be at least 0.3"));
  ExpectSurvives(ResourceNotFound("templates/table"));
  ExpectSurvives(ResourceExists("items/board"));
  ExpectSurvives(StaleRevision("items/board", 3, 4));
  ExpectSurvives(StaleAttempt("tasks/1", 1, 2));
  ExpectSurvives(TooLarge("mesh", "1 GiB"));
  ExpectSurvives(PreconditionFailed("BRIDGE_BUSY", "the bridge is busy"));
  ExpectSurvives(RoleRequired("A/B", "admin"));
  ExpectSurvives(IdentityInvalid("expired"));
  ExpectSurvives(PeerUnavailable("simulator", "gone"));
  ExpectSurvives(StorageFailed("/x", "full"));
  ExpectSurvives(NotBuilt("composer"));
  ExpectSurvives(absl::CancelledError("plain"));
}

TEST(StatusMappingTest, FieldsAreViolationsAndResourcesMetadata) {
  const google::rpc::Status invalid = ToProto(InvalidField("a.b", "bad"));
  ASSERT_EQ(invalid.details_size(), 2);
  google::rpc::BadRequest bad_request;
  ASSERT_TRUE(invalid.details(1).UnpackTo(&bad_request));
  EXPECT_EQ(bad_request.field_violations(0).field(), "a.b");

  const google::rpc::Status missing = ToProto(ResourceNotFound("items/x"));
  ASSERT_EQ(missing.details_size(), 1);
  google::rpc::ErrorInfo info;
  ASSERT_TRUE(missing.details(0).UnpackTo(&info));
  EXPECT_EQ(info.reason(), "RESOURCE_NOT_FOUND");
  EXPECT_EQ(info.domain(), "mortise.dev");
  EXPECT_EQ(info.metadata().at("resource"), "items/x");
}

TEST(StatusMappingTest, NeverUnknown) {
  EXPECT_EQ(ToGrpc(absl::UnknownError("?")).error_code(), grpc::StatusCode::INTERNAL);
}

TEST(StatusMappingTest, MessagesFitIntoHeadersAndAreUtf8) {
  const grpc::Status longest = ToGrpc(InvalidField("f", std::string(100000, 'x')));
  EXPECT_LT(longest.error_message().size(), 2100u);
  EXPECT_LT(longest.error_details().size(), 6000u);

  const grpc::Status broken = ToGrpc(absl::InternalError("caf\xc3\xa9 \xff\xc3 \xed\xa0\x80."));
  EXPECT_EQ(broken.error_message(), "caf\xc3\xa9 ?? ???.");
}

// What an HTTP/2 client counts against its limit of 8 KiB, other headers left aside.
std::size_t HeaderBytes(const grpc::Status& status) {
  std::size_t bytes = status.error_details().size() * 4 / 3;
  for (const char c : status.error_message()) bytes += c >= ' ' && c <= '~' && c != '%' ? 1 : 3;
  return bytes;
}

TEST(StatusMappingTest, TheLongestFailuresFitIntoHeaders) {
  constexpr std::size_t kRoom = 7400;
  std::string umlauts;
  while (umlauts.size() < 10000) umlauts += "ü";
  for (const std::string& text : {std::string(10000, 'x'), umlauts, std::string(10000, '\0')}) {
    EXPECT_LT(HeaderBytes(ToGrpc(InvalidField(text, text))), kRoom);
    EXPECT_LT(HeaderBytes(ToGrpc(ResourceNotFound(text))), kRoom);
    EXPECT_LT(HeaderBytes(ToGrpc(PreconditionFailed(text, text, text))), kRoom);
    const std::vector<FieldViolation> many(100, {text, text});
    EXPECT_LT(HeaderBytes(ToGrpc(InvalidFields(many))), kRoom);
    EXPECT_LT(HeaderBytes(ToGrpc(InvalidFields({{"a", text}, {text, "b"}}))), kRoom);
  }
}

TEST(StatusMappingTest, EveryFieldAtFaultArrives) {
  std::vector<FieldViolation> sent;
  for (int i = 0; i < 30; ++i) {
    sent.push_back({"parts[" + std::to_string(i) + "].item", "there is no item 'items/x'"});
  }
  const absl::Status back = FromGrpc(ToGrpc(UnderField("template", InvalidFields(sent))));
  const std::vector<FieldViolation> came = ViolationsOf(back);
  ASSERT_EQ(came.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(came[i].field, "template." + sent[i].field);
    EXPECT_EQ(came[i].message, sent[i].message);
  }
  EXPECT_EQ(DetailOf(back).field, "template.parts[0].item");
  EXPECT_EQ(back.message().rfind("30 findings: template.parts[0].item: there is no", 0), 0u);
  EXPECT_TRUE(ViolationsOf(FromGrpc(ToGrpc(InvalidField("a", "b")))).empty());
}

TEST(StatusMappingTest, ForeignDetailsAreIgnored) {
  const absl::Status status =
      FromGrpc(grpc::Status(grpc::StatusCode::NOT_FOUND, "gone", "not a protobuf \xff"));
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(DetailOf(status).reason, "");
}

}  // namespace
}  // namespace mortise::rpc
