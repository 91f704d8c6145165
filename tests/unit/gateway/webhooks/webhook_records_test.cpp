// Lists of webhooks and their dead letters, of which a hundred would be more than a message.
#include "gateway/webhooks/webhook_records.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/store/store.h"
#include "tests/support/temporary_folder.h"

namespace mortise::gateway {
namespace {

class WebhookRecordsTest : public ::testing::Test {
 protected:
  template <typename Change>
  void Transact(const Change& change) {
    const absl::Status status = store_->Transact(change);
    ASSERT_TRUE(status.ok()) << status;
  }

  // The entries of all pages; each page must fit into a message. `read(token)` gives a page.
  template <typename Entry, typename Read>
  std::vector<Entry> All(const Read& read) {
    std::vector<Entry> entries;
    std::string token;
    do {
      const absl::StatusOr<resources::Page<Entry>> page = read(token);
      EXPECT_TRUE(page.ok()) << page.status();
      if (!page.ok()) break;
      std::size_t bytes = 0;
      for (const Entry& entry : page->entries) bytes += entry.ByteSizeLong();
      EXPECT_LT(bytes, std::size_t{4} << 20);
      entries.insert(entries.end(), page->entries.begin(), page->entries.end());
      token = page->next_page_token;
    } while (!token.empty());
    return entries;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string()}).value();
};

TEST_F(WebhookRecordsTest, AllWebhooksAreListed) {
  for (int i = 0; i < 90; ++i) {
    v1::Webhook webhook;
    webhook.set_name(absl::StrFormat("webhooks/w%02d", i));
    webhook.set_last_error(std::string(100'000, 'x'));
    Transact([&](store::Transaction& transaction) { return PutWebhook(transaction, webhook); });
  }
  const auto webhooks = All<v1::Webhook>([this](const std::string& token) {
    v1::ListWebhooksRequest request;
    request.set_page_token(token);
    return kWebhooks.List(*store_, request, [](const v1::Webhook&) { return true; });
  });
  EXPECT_EQ(webhooks.size(), 90u);
}

TEST_F(WebhookRecordsTest, AllDeadLettersOfAWebhookAreListed) {
  for (const char* webhook : {"webhooks/a", "webhooks/b"}) {
    for (int i = 1; i <= 90; ++i) {
      const DeadLetter letter{"pareto", i, 8, std::string(100'000, 'x'), absl::Now()};
      Transact([&](store::Transaction& transaction) {
        return PutDeadLetter(transaction, webhook, letter);
      });
    }
  }
  using Letters = resources::Page<v1::ListDeadLettersResponse::DeadLetter>;
  const auto letters =
      All<v1::ListDeadLettersResponse::DeadLetter>([this](const std::string& token) {
        return resources::ReadFrom<Letters>(*store_, [&](store::ReadTransaction& transaction) {
          return PageOfDeadLetters(transaction, "webhooks/b", {.after = token});
        });
      });
  ASSERT_EQ(letters.size(), 90u);
  for (std::size_t i = 0; i < letters.size(); ++i) {
    EXPECT_EQ(letters[i].number(), static_cast<std::int64_t>(i) + 1);
    EXPECT_EQ(letters[i].tries(), 8);
  }
}

}  // namespace
}  // namespace mortise::gateway
