// What becomes of names that are still asked for when their resolver ends.
#include "gateway/webhooks/name_resolver.h"

#include <gtest/gtest.h>

#include "tests/unit/gateway/webhooks/name_server.h"

namespace mortise::gateway {
namespace {

TEST(NameResolver, AnswersWhatIsStillAskedWhenItEnds) {
  NameServer server;
  server.KeepSilent("plm.example");
  auto resolver =
      NameResolver::Start({.timeout = absl::Minutes(1), .name_servers = server.address()});
  ASSERT_TRUE(resolver.ok()) << resolver.status();
  NameResolver::Addresses answer = absl::UnknownError("not answered");
  int answers = 0;
  (*resolver)->Resolve("plm.example", [&](NameResolver::Addresses found) {
    answer = std::move(found);
    ++answers;
  });
  ASSERT_TRUE(server.WaitUntilAskedInVain({"plm.example"}));
  resolver->reset();
  EXPECT_TRUE(absl::IsCancelled(answer.status())) << answer.status();
  EXPECT_EQ(answers, 1);
}

}  // namespace
}  // namespace mortise::gateway
