#include "common/rpc/identity.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "common/base/errors.h"
#include "mortise/v1/access.pb.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::rpc {
namespace {

class IdentityTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_OK(CreateIdentityKey(folder_.path(), "gateway"));
    ASSERT_OK(CreateIdentityKey(folder_.path(), "pareto"));
    gateway_ = Signer("gateway");
    verifier_ = *IdentityVerifier::Load({.folder = folder_.path(), .clock = Clock()});
  }

  std::function<absl::Time()> Clock() {
    return [this] { return now_; };
  }

  std::unique_ptr<IdentitySigner> Signer(const std::string& issuer) {
    return *IdentitySigner::Load(folder_.path(), issuer, Clock());
  }

  // The reason for which `bytes` is refused.
  std::string Refusal(const std::string& bytes) {
    const auto identity = verifier_->Verify(bytes);
    EXPECT_EQ(identity.status().code(), absl::StatusCode::kUnauthenticated);
    EXPECT_EQ(DetailOf(identity.status()).reason, "IDENTITY_INVALID");
    return std::string(identity.status().message());
  }

  testing::TemporaryFolder folder_;
  absl::Time now_ = absl::FromUnixSeconds(1700000000);
  std::unique_ptr<IdentitySigner> gateway_;
  std::unique_ptr<IdentityVerifier> verifier_;
};

TEST_F(IdentityTest, WhatIsSignedIsVerified) {
  const auto identity = verifier_->Verify(gateway_->Sign("users/ada", Role::kOperator, "r-1"));
  ASSERT_OK(identity);
  EXPECT_EQ(identity->subject, "users/ada");
  EXPECT_EQ(identity->role, Role::kOperator);
  EXPECT_EQ(identity->trace_id, "r-1");
  EXPECT_EQ(identity->issuer, "gateway");
  EXPECT_EQ(identity->expires_at - identity->issued_at, kIdentityLifetime);
}

TEST_F(IdentityTest, ExpiresWithSomeAllowanceForClocks) {
  const std::string bytes = gateway_->Sign("users/ada", Role::kViewer, "r", absl::Seconds(60));
  now_ += absl::Seconds(64);
  EXPECT_OK(verifier_->Verify(bytes));
  now_ += absl::Seconds(2);
  EXPECT_EQ(Refusal(bytes), "the identity has expired");
}

TEST_F(IdentityTest, RefusesTheFuture) {
  const std::string bytes = gateway_->Sign("users/ada", Role::kViewer, "r");
  now_ -= absl::Seconds(6);
  EXPECT_NE(Refusal(bytes).find("future"), std::string::npos);
}

TEST_F(IdentityTest, OneThatWasVerifiedBeforeStillHasItsTime) {
  const std::string bytes = gateway_->Sign("users/ada", Role::kOperator, "");
  for (int i = 0; i < 3; ++i) {
    const auto identity = verifier_->Verify(bytes);
    ASSERT_OK(identity);
    EXPECT_EQ(identity->subject, "users/ada");
    EXPECT_EQ(identity->role, Role::kOperator);
  }
  const absl::Time signed_at = now_;
  now_ = signed_at - absl::Seconds(6);
  EXPECT_NE(Refusal(bytes).find("future"), std::string::npos);
  now_ = signed_at + kIdentityLifetime + absl::Seconds(6);
  EXPECT_EQ(Refusal(bytes), "the identity has expired");
}

TEST_F(IdentityTest, WhenKeysAreReadAgainIssuersThatAreGoneAreForgotten) {
  const std::string pareto = Signer("pareto")->SignService(Role::kViewer, "");
  EXPECT_OK(verifier_->Verify(pareto));
  std::filesystem::remove(folder_.path() / "pareto.pub");
  ASSERT_OK(CreateIdentityKey(folder_.path(), "simulator"));
  now_ += absl::Seconds(1);
  EXPECT_OK(verifier_->Verify(Signer("simulator")->SignService(Role::kViewer, "")));
  EXPECT_EQ(Refusal(pareto), "the identity's issuer is not trusted");
}

TEST_F(IdentityTest, RefusesForgery) {
  v1::SignedIdentity envelope;
  ASSERT_TRUE(envelope.ParseFromString(gateway_->Sign("users/ada", Role::kViewer, "r")));
  v1::Identity claim;
  ASSERT_TRUE(claim.ParseFromString(envelope.identity()));
  claim.add_roles(v1::ADMIN);
  envelope.set_identity(claim.SerializeAsString());
  EXPECT_EQ(Refusal(envelope.SerializeAsString()), "the identity's signature is wrong");
}

TEST_F(IdentityTest, RefusesEveryFlippedBit) {
  const std::string bytes = gateway_->Sign("users/ada", Role::kViewer, "r");
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = bytes;
      changed[i] = static_cast<char>(changed[i] ^ (1 << bit));
      const auto identity = verifier_->Verify(changed);
      EXPECT_FALSE(identity.ok()) << "byte " << i << " bit " << bit;
    }
  }
}

TEST_F(IdentityTest, RefusesNonsense) {
  EXPECT_EQ(Refusal(std::string("\xff\xff\xff", 3)), "the identity is malformed");
  EXPECT_EQ(Refusal(""), "the identity's issuer is not trusted");
}

TEST_F(IdentityTest, AServiceVouchesOnlyForItself) {
  const auto pareto = Signer("pareto");
  const auto own = verifier_->Verify(pareto->SignService(Role::kDesigner, "r"));
  ASSERT_OK(own);
  EXPECT_EQ(own->subject, "services/pareto");
  EXPECT_EQ(Refusal(pareto->Sign("users/ada", Role::kAdmin, "r")),
            "the identity's issuer may not vouch for its subject");
}

TEST_F(IdentityTest, TheSignerSignsForFiveMinutesAtMost) {
  const auto identity =
      verifier_->Verify(gateway_->Sign("users/ada", Role::kViewer, "r", absl::Hours(9)));
  ASSERT_OK(identity);
  EXPECT_EQ(identity->expires_at, now_ + kIdentityLifetime);
}

TEST_F(IdentityTest, ANewIssuerIsFoundWithoutRestart) {
  ASSERT_OK(CreateIdentityKey(folder_.path(), "simulator"));
  const std::string bytes = Signer("simulator")->SignService(Role::kViewer, "r");
  EXPECT_EQ(Refusal(bytes), "the identity's issuer is not trusted") << "read a moment ago";
  now_ += absl::Seconds(1);
  EXPECT_OK(verifier_->Verify(bytes));
}

TEST_F(IdentityTest, AnotherHousesKeyIsNotOurs) {
  testing::TemporaryFolder other;
  ASSERT_OK(CreateIdentityKey(other.path(), "gateway"));
  const auto stranger = *IdentitySigner::Load(other.path(), "gateway", Clock());
  EXPECT_EQ(Refusal(stranger->Sign("users/ada", Role::kAdmin, "r")),
            "the identity's signature is wrong");
}

TEST_F(IdentityTest, ThePrivateKeyIsPrivateAndNeverReplaced) {
  struct stat info;
  ASSERT_EQ(stat((folder_.path() / "gateway.key").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600u);
  EXPECT_EQ(CreateIdentityKey(folder_.path(), "gateway").code(), absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(CreateIdentityKey(folder_.path(), "../evil").code(),
            absl::StatusCode::kInvalidArgument);
}

TEST_F(IdentityTest, AFolderWithoutKeysTrustsNobody) {
  testing::TemporaryFolder empty;
  EXPECT_EQ(IdentityVerifier::Load({.folder = empty.path()}).status().code(),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(IdentitySigner::Load(empty.path(), "gateway").status().code(),
            absl::StatusCode::kNotFound);
}

TEST(RoleTest, NamesGoBothWays) {
  for (const Role role : {Role::kViewer, Role::kDesigner, Role::kOperator, Role::kAdmin}) {
    EXPECT_EQ(*ParseRole(RoleName(role), "role"), role);
  }
  EXPECT_EQ(DetailOf(ParseRole("root", "roles[0]").status()).field, "roles[0]");
}

}  // namespace
}  // namespace mortise::rpc
