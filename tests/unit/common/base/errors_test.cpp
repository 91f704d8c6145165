#include "common/base/errors.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

TEST(Errors, EveryFactoryCarriesCodeReasonAndField) {
  struct Case {
    absl::Status status;
    absl::StatusCode code;
    std::string reason;
    std::string field;
  };
  const Case cases[] = {
      {InvalidField("q[1]", "is not finite"), absl::StatusCode::kInvalidArgument, "FIELD_INVALID",
       "q[1]"},
      {ResourceNotFound("items/x"), absl::StatusCode::kNotFound, "RESOURCE_NOT_FOUND", "items/x"},
      {ResourceExists("items/x"), absl::StatusCode::kAlreadyExists, "RESOURCE_EXISTS", "items/x"},
      {StaleRevision("items/x", 2, 3), absl::StatusCode::kAborted, "STALE_REVISION", "items/x"},
      {StaleAttempt("tasks/x", 1, 2), absl::StatusCode::kAborted, "STALE_ATTEMPT", "tasks/x"},
      {TooLarge("mesh", "4 MiB"), absl::StatusCode::kResourceExhausted, "TOO_LARGE", "mesh"},
      {RoleRequired("M", "ADMIN"), absl::StatusCode::kPermissionDenied, "ROLE_REQUIRED", "M"},
      {NotBuilt("M"), absl::StatusCode::kUnimplemented, "NOT_BUILT", "M"},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(c.status.code(), c.code) << c.status;
    EXPECT_EQ(DetailOf(c.status).reason, c.reason) << c.status;
    EXPECT_EQ(DetailOf(c.status).field, c.field) << c.status;
    EXPECT_FALSE(c.status.message().empty());
  }
}

TEST(Errors, StaleRevisionNamesBothRevisions) {
  const std::string message(StaleRevision("items/x", 2, 3).message());
  EXPECT_NE(message.find("revision 3"), std::string::npos) << message;
  EXPECT_NE(message.find("not 2"), std::string::npos) << message;
}

TEST(UnderField, PutsThePrefixBeforeFieldAndMessage) {
  const absl::Status status = UnderField("requests[3]", InvalidField("q[1]", "is not finite"));
  EXPECT_EQ(DetailOf(status).field, "requests[3].q[1]");
  EXPECT_EQ(DetailOf(status).reason, "FIELD_INVALID");
  EXPECT_EQ(status.message(), "requests[3].q[1]: is not finite");
  EXPECT_TRUE(UnderField("x", absl::OkStatus()).ok());
  const absl::Status whole = UnderField("assembly", PreconditionFailed("UNBOUNDED", "can grow"));
  EXPECT_EQ(DetailOf(whole).field, "assembly");
  EXPECT_EQ(DetailOf(whole).reason, "UNBOUNDED");
  EXPECT_EQ(whole.message(), "assembly: can grow");
}

TEST(DetailOf, IsEmptyForForeignStatuses) {
  EXPECT_EQ(DetailOf(absl::InternalError("x")).reason, "");
  EXPECT_EQ(DetailOf(absl::OkStatus()).field, "");
}

}  // namespace
}  // namespace mortise
