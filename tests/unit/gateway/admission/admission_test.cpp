// From tokens to callers, and the rule of each method.
#include "gateway/admission/admission.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/gateway/contract/token_fixture.h"

namespace mortise::gateway {
namespace {

class AdmissionTest : public ::testing::Test {
 protected:
  AdmissionTest() {
    AdmissionOptions options;
    options.keys = &keys_;
    options.clock = [this] { return now_; };
    admission_ = std::make_unique<Admission>(std::move(options));
  }

  std::string Header(const nlohmann::json& roles, const std::string& subject = "ada") const {
    return "Bearer " +
           signer_.Sign(
               {{"sub", subject}, {"roles", roles}, {"exp", absl::ToUnixSeconds(now_) + 100}});
  }

  const TokenSigner signer_{"EdDSA"};
  absl::Time now_ = absl::FromUnixSeconds(1800000000);
  FixedKeys keys_{*TokenKeys::Parse(signer_.Pem())};
  std::unique_ptr<Admission> admission_;
  const std::unique_ptr<const Contract> contract_ = Contract::Load();
};

TEST_F(AdmissionTest, TakesTheHighestRoleItKnows) {
  const auto caller = admission_->Authenticate(Header({"viewer", "operator", "accountant"}));
  ASSERT_TRUE(caller.ok()) << caller.status();
  EXPECT_EQ((*caller)->subject, "users/ada");
  EXPECT_EQ((*caller)->role, rpc::Role::kOperator);
  EXPECT_EQ((*admission_->Authenticate(Header(nlohmann::json::array())))->role, rpc::Role::kNone);
  EXPECT_EQ((*admission_->Authenticate(Header({"viewer"}, "services/plm")))->subject,
            "services/plm");
  EXPECT_FALSE(admission_->Authenticate(Header({"viewer"}, "a\"b\n")).ok());
}

TEST_F(AdmissionTest, ForgetsATokenWhenItExpires) {
  const std::string header = Header({"viewer"});
  EXPECT_TRUE(admission_->Authenticate(header).ok());
  EXPECT_TRUE(admission_->Authenticate(header).ok());
  now_ += absl::Seconds(131);
  EXPECT_EQ(admission_->Authenticate(header).status().code(), absl::StatusCode::kUnauthenticated);
}

TEST_F(AdmissionTest, RefusesCallersWithoutAToken) {
  for (const char* header : {"", "Basic abc", "Bearer", "Bearer x.y.z"}) {
    EXPECT_EQ(admission_->Authenticate(header).status().code(), absl::StatusCode::kUnauthenticated);
  }
  Admission closed{AdmissionOptions()};
  EXPECT_FALSE(closed.Authenticate(Header({"admin"})).ok());
}

TEST_F(AdmissionTest, HoldsEveryMethodToItsRole) {
  for (const MethodRoute& method : contract_->methods()) {
    for (int role = 0; role <= 4; ++role) {
      const Caller caller{"users/ada", static_cast<rpc::Role>(role)};
      EXPECT_EQ(admission_->Authorize(method, caller).ok(), role >= method.role)
          << method.full_name << " as " << role;
    }
  }
  MethodRoute undeclared;
  EXPECT_FALSE(admission_->Authorize(undeclared, {"users/ada", rpc::Role::kAdmin}).ok());
}

TEST_F(AdmissionTest, SignsACallersIdentityEveryMinute) {
  const mortise::testing::TemporaryFolder folder;
  ASSERT_TRUE(rpc::CreateIdentityKey(folder.path(), "gateway").ok());
  const auto clock = [this] { return now_; };
  const auto signer = *rpc::IdentitySigner::Load(folder.path(), "gateway", clock);
  const auto verifier = *rpc::IdentityVerifier::Load({.folder = folder.path(), .clock = clock});
  AdmissionOptions options;
  options.signer = signer.get();
  options.clock = clock;
  Admission admission(std::move(options));

  const Caller ada{"users/ada", rpc::Role::kViewer};
  const std::string first = admission.SignedIdentity(ada);
  now_ += absl::Seconds(59);
  EXPECT_EQ(admission.SignedIdentity(ada), first);
  now_ += absl::Seconds(1);
  const std::string second = admission.SignedIdentity(ada);
  EXPECT_NE(second, first);
  EXPECT_EQ(verifier->Verify(second)->issued_at, now_);

  const auto identity =
      verifier->Verify(admission.SignedIdentity({"users/ada", rpc::Role::kAdmin}));
  EXPECT_EQ(identity->role, rpc::Role::kAdmin) << "a new role counts at once";
  EXPECT_EQ(verifier->Verify(admission.SignedIdentity({"users/bob", rpc::Role::kAdmin}))->subject,
            "users/bob");

  now_ -= absl::Minutes(10);
  EXPECT_TRUE(verifier->Verify(admission.SignedIdentity(ada)).ok()) << "after a clock was set back";
}

TEST_F(AdmissionTest, LetsDevelopersInWithoutATokenOnlyInDevelopment) {
  AdmissionOptions options;
  options.insecure_development = true;
  Admission open(std::move(options));
  EXPECT_EQ((*open.Authenticate(""))->role, rpc::Role::kAdmin);
  EXPECT_EQ(open.SignedIdentity(**open.Authenticate("")), "");
}

TEST(RequestId, AcceptsOnlyPlainOnes) {
  EXPECT_TRUE(IsRequestId("a-B_9."));
  EXPECT_TRUE(IsRequestId(std::string(128, 'x')));
  for (const std::string& bad :
       {std::string(), std::string(129, 'x'), std::string("a b"), std::string("a\"b"),
        std::string("a\nb"), std::string("\xc3\xa4")}) {
    EXPECT_FALSE(IsRequestId(bad));
  }
}

}  // namespace
}  // namespace mortise::gateway
