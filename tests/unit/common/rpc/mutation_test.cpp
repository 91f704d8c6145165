// Mutations through a real server: once for each request_id, audited, all in one transaction.
#include <gtest/gtest.h>

#include <thread>

#include "common/base/errors.h"
#include "common/rpc/mutation_log.h"
#include "mortise/v1/audit.pb.h"
#include "tests/unit/common/rpc/probe_server.h"

namespace mortise::testing {
namespace {

class MutationTest : public ProbeServerTest {
 protected:
  void SetUp() override {
    handlers_.keep = [this](const rpc::Call&, const KeepRequest& request,
                            store::Transaction& transaction) -> absl::StatusOr<Kept> {
      ++runs_;
      MORTISE_ASSIGN_OR_RETURN(const int64_t revision,
                               transaction.Put("kept", request.name(), request.value()));
      if (request.value() == "fail") return PreconditionFailed("TOLD_TO_FAIL", "told to fail");
      if (runs_ <= overtaken_) return rpc::PrepareAgain(absl::AbortedError("overtaken"));
      if (request.value() == "throw") throw std::runtime_error("told to throw");
      Kept kept;
      kept.set_name(request.name());
      kept.set_value(request.value());
      kept.set_times(revision);
      return kept;
    };
    handlers_.prepare = [this](const rpc::Call&,
                               const KeepRequest& request) -> absl::StatusOr<std::string> {
      ++prepared_;
      if (request.value().empty()) return InvalidField("value", "must be set");
      return "prepared " + request.value();
    };
    StartServer();
  }

  static KeepRequest Request(const std::string& id, const std::string& value) {
    KeepRequest request;
    request.set_request_id(id);
    request.set_name("a");
    request.set_value(value);
    return request;
  }

  absl::StatusOr<Kept> KeepSlowly(const KeepRequest& request) {
    Kept kept;
    const absl::Status status =
        rpc::FromGrpc(stub_->KeepSlowly(Context(rpc::Role::kDesigner).get(), request, &kept));
    if (!status.ok()) return status;
    return kept;
  }

  bool Exists(const std::string& key) {
    return store_
        ->Read([&](store::ReadTransaction& read) { return read.Get("kept", key).status(); })
        .ok();
  }

  std::vector<v1::AuditRecord> Audit() { return rpc::ListAudit(*store_, {})->entries; }

  std::atomic<int> runs_ = 0;
  std::atomic<int> prepared_ = 0;
  std::atomic<int> overtaken_ = 0;  // so many runs are
};

TEST_F(MutationTest, ARepeatedRequestGetsTheSameAnswerAndChangesNothing) {
  const auto first = Keep(Request("r-1", "x"));
  const auto second = Keep(Request("r-1", "x"));
  ASSERT_OK(first);
  ASSERT_OK(second);
  EXPECT_EQ(first->SerializeAsString(), second->SerializeAsString());
  EXPECT_EQ(first->times(), 1);
  EXPECT_EQ(runs_, 1);
  EXPECT_EQ(Keep(Request("r-2", "x"))->times(), 2);
}

TEST_F(MutationTest, ManyAtOnceWithOneIdDoTheWorkOnce) {
  std::vector<std::thread> callers;
  for (int i = 0; i < 8; ++i) {
    callers.emplace_back([&] {
      const auto kept = Keep(Request("same", "x"));
      ASSERT_OK(kept);
      EXPECT_EQ(kept->times(), 1);
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(Audit().size(), 1u);
}

TEST_F(MutationTest, TheSameIdForAnotherRequestIsRefused) {
  ASSERT_OK(Keep(Request("r-1", "x")));
  const absl::Status status = Keep(Request("r-1", "y")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(status).field, "request_id");
  EXPECT_EQ(runs_, 1);
}

TEST_F(MutationTest, TheSameIdOfAnotherCallerIsAnotherRequest) {
  ASSERT_OK(Keep(Request("r-1", "x")));
  rpc::Origin origin = As(rpc::Role::kDesigner);
  origin.identity = [this] { return gateway_->Sign("users/bob", rpc::Role::kDesigner, "t"); };
  Kept kept;
  ASSERT_TRUE(stub_->Keep(rpc::MakeClientContext(origin).get(), Request("r-1", "y"), &kept).ok());
  EXPECT_EQ(kept.times(), 2);
}

TEST_F(MutationTest, ARequestIdIsNeeded) {
  for (const std::string& id : {std::string(), std::string("a b"), std::string(129, 'x')}) {
    const absl::Status status = Keep(Request(id, "x")).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(DetailOf(status).field, "request_id");
  }
  EXPECT_EQ(runs_, 0);
}

TEST_F(MutationTest, AChangeLeavesAnAuditRecord) {
  ASSERT_OK(Keep(Request("r-1", "x")));
  const auto records = Audit();
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].service(), "probe");
  EXPECT_EQ(records[0].method(), "mortise.testing.ProbeService/Keep");
  EXPECT_EQ(records[0].subject(), "users/ada");
  EXPECT_EQ(records[0].request_id(), "r-1");
  EXPECT_EQ(records[0].trace_id(), "trace-7");
  EXPECT_EQ(records[0].resource(), "a");
  EXPECT_EQ(records[0].request_sha256().size(), 64u);
  EXPECT_GT(records[0].time().seconds(), 0);
}

TEST_F(MutationTest, AFailureLeavesNothing) {
  EXPECT_EQ(DetailOf(Keep(Request("r-1", "fail")).status()).reason, "TOLD_TO_FAIL");
  EXPECT_EQ(Keep(Request("r-2", "throw")).status().code(), absl::StatusCode::kInternal);
  EXPECT_FALSE(Exists("a"));
  EXPECT_TRUE(Audit().empty());
  EXPECT_OK(Keep(Request("r-1", "x"))) << "the id is not used up by a failure";
}

TEST_F(MutationTest, AuditListsNewestFirstInPages) {
  for (int i = 0; i < 5; ++i) ASSERT_OK(Keep(Request("r-" + std::to_string(i), "x")));
  const auto first = rpc::ListAudit(*store_, {.size = 3, .after = ""});
  ASSERT_OK(first);
  ASSERT_EQ(first->entries.size(), 3u);
  EXPECT_EQ(first->entries[0].request_id(), "r-4");
  EXPECT_EQ(first->entries[2].request_id(), "r-2");
  const auto second = rpc::ListAudit(*store_, {.size = 3, .after = first->next_page_token});
  ASSERT_EQ(second->entries.size(), 2u);
  EXPECT_EQ(second->entries[1].request_id(), "r-0");
  EXPECT_EQ(second->next_page_token, "");
}

TEST_F(MutationTest, SlowWorkIsDoneOnceAndOutsideTheTransaction) {
  EXPECT_EQ(KeepSlowly(Request("r-1", "x"))->value(), "prepared x");
  EXPECT_EQ(KeepSlowly(Request("r-1", "x"))->value(), "prepared x");
  EXPECT_EQ(prepared_, 1);
  EXPECT_EQ(DetailOf(KeepSlowly(Request("r-2", "")).status()).field, "value");
  EXPECT_EQ(runs_, 1);
}

TEST_F(MutationTest, WhatWasOvertakenIsPreparedAgainAndLeavesNothing) {
  overtaken_ = 2;
  const auto kept = KeepSlowly(Request("r-1", "x"));
  ASSERT_OK(kept);
  EXPECT_EQ(kept->times(), 1);
  EXPECT_EQ(prepared_, 3);
  EXPECT_EQ(Audit().size(), 1u);
}

TEST_F(MutationTest, WhatIsOvertakenAlwaysIsAnsweredSo) {
  overtaken_ = 1000;
  EXPECT_EQ(KeepSlowly(Request("r-1", "x")).status().code(), absl::StatusCode::kAborted);
  EXPECT_EQ(prepared_, rpc::kMostPreparations);
  EXPECT_FALSE(Exists("a"));
}

TEST_F(MutationTest, OldAnswersAreForgottenYoungOnesKept) {
  ASSERT_OK(Keep(Request("r-1", "x")));
  EXPECT_EQ(*rpc::ForgetOldAnswers(*store_), 0);
  absl::Duration ahead = rpc::kAnswerRetention + absl::Seconds(1);
  auto later = store::OpenStore({.url = "sqlite:" + (folder_.path() / "probe.db").string(),
                                 .service = "probe",
                                 .clock = [ahead] { return absl::Now() + ahead; }});
  ASSERT_OK(later);
  EXPECT_EQ(*rpc::ForgetOldAnswers(**later), 1);
  EXPECT_EQ(Keep(Request("r-1", "x"))->times(), 2);
  EXPECT_EQ(Audit().size(), 2u) << "audit records stay";
}

}  // namespace
}  // namespace mortise::testing
