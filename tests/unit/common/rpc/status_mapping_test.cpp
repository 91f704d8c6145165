#include "common/rpc/status_mapping.h"

#include <grpcpp/support/status.h>
#include <gtest/gtest.h>

#include "common/base/errors.h"
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

TEST(StatusMappingTest, ForeignDetailsAreIgnored) {
  const absl::Status status =
      FromGrpc(grpc::Status(grpc::StatusCode::NOT_FOUND, "gone", "not a protobuf \xff"));
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(DetailOf(status).reason, "");
}

}  // namespace
}  // namespace mortise::rpc
