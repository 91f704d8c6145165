#include "gateway/webhooks/webhook_records.h"

#include <google/protobuf/util/time_util.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/store/store.h"

namespace mortise::gateway {
namespace {

using Json = nlohmann::json;
using LetterMessage = v1::ListDeadLettersResponse::DeadLetter;

constexpr char kDeadLetters[] = "webhook-dead-letters";
constexpr int kPage = 1000;

// "hook-1" of "webhooks/hook-1"; INVALID_ARGUMENT naming `name` otherwise.
absl::StatusOr<std::string> IdOf(const std::string& name) {
  return ParseResourceName(name, kWebhooks.names, "name");
}

// Keys sort by stream and number.
std::string LetterKey(const std::string& webhook, const std::string& stream, int64_t number) {
  return absl::StrFormat("%s/%s/%019d", webhook, stream, number);
}

absl::StatusOr<LetterMessage> ParseLetter(const store::Record& record) {
  const Json json = Json::parse(record.payload, nullptr, false);
  if (!json.is_object()) {
    return StorageFailed("webhook-dead-letters/" + record.key, "the record is damaged");
  }
  LetterMessage letter;
  letter.set_stream(json.value("stream", ""));
  letter.set_number(json.value("number", int64_t{0}));
  letter.set_tries(json.value("tries", 0));
  letter.set_error(json.value("error", ""));
  *letter.mutable_give_up_time() =
      google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(json.value("time", int64_t{0}));
  return letter;
}

absl::Status DeleteLetters(store::Transaction& transaction, const std::string& prefix,
                           const std::string& after) {
  store::ListOptions options;
  options.key_prefix = prefix;
  options.after_key = after;
  options.limit = kPage;
  for (;;) {
    MORTISE_ASSIGN_OR_RETURN(const auto records, transaction.List(kDeadLetters, options));
    for (const store::Record& record : records) {
      MORTISE_RETURN_IF_ERROR(transaction.Delete(kDeadLetters, record.key));
    }
    if (records.size() < static_cast<std::size_t>(kPage)) return absl::OkStatus();
  }
}

}  // namespace

absl::StatusOr<std::vector<v1::Webhook>> ListWebhooks(store::ReadTransaction& transaction,
                                                      const std::string& after_id, int limit) {
  store::ListOptions options;
  options.after_key = after_id;
  options.limit = limit;
  MORTISE_ASSIGN_OR_RETURN(const auto records, transaction.List(kWebhooks.kind, options));
  std::vector<v1::Webhook> webhooks;
  for (const store::Record& record : records) {
    MORTISE_ASSIGN_OR_RETURN(v1::Webhook webhook,
                             resources::ParseRecord<v1::Webhook>(kWebhooks.kind, record));
    webhooks.push_back(std::move(webhook));
  }
  return webhooks;
}

absl::Status PutWebhook(store::Transaction& transaction, const v1::Webhook& webhook) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, IdOf(webhook.name()));
  return transaction.Put(kWebhooks.kind, id, webhook.SerializeAsString()).status();
}

absl::Status DeleteWebhook(store::Transaction& transaction, const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, IdOf(name));
  const absl::Status deleted = transaction.Delete(kWebhooks.kind, id);
  if (absl::IsNotFound(deleted)) return ResourceNotFound(name);
  MORTISE_RETURN_IF_ERROR(deleted);
  return DeleteLetters(transaction, name + "/", "");
}

absl::Status PutDeadLetter(store::Transaction& transaction, const std::string& webhook,
                           const DeadLetter& letter) {
  const Json json = {{"stream", letter.stream},
                     {"number", letter.number},
                     {"tries", letter.tries},
                     {"error", letter.error},
                     {"time", absl::ToUnixMicros(letter.give_up_time)}};
  return transaction
      .Put(kDeadLetters, LetterKey(webhook, letter.stream, letter.number),
           json.dump(-1, ' ', false, Json::error_handler_t::replace))
      .status();
}

absl::StatusOr<resources::Page<LetterMessage>> PageOfDeadLetters(
    store::ReadTransaction& transaction, const std::string& webhook,
    const resources::PageQuery& query) {
  return resources::ReadPage<LetterMessage>(
      transaction, {.kind = kDeadLetters, .key_prefix = webhook + "/"}, query,
      [](const store::Record& record) -> absl::StatusOr<std::optional<LetterMessage>> {
        return ParseLetter(record);
      });
}

absl::Status ForgetDeadLetters(store::Transaction& transaction, const std::string& webhook,
                               const std::string& stream, int64_t after_number) {
  return DeleteLetters(transaction, absl::StrCat(webhook, "/", stream, "/"),
                       LetterKey(webhook, stream, after_number));
}

int64_t CursorOf(const v1::Webhook& webhook, const std::string& stream) {
  for (const auto& cursor : webhook.cursors()) {
    if (cursor.stream() == stream) return cursor.number();
  }
  return 0;
}

void SetCursor(v1::Webhook& webhook, const std::string& stream, int64_t number) {
  for (auto& cursor : *webhook.mutable_cursors()) {
    if (cursor.stream() == stream) return cursor.set_number(number);
  }
  auto& cursor = *webhook.add_cursors();
  cursor.set_stream(stream);
  cursor.set_number(number);
}

void RemoveCursor(v1::Webhook& webhook, const std::string& stream) {
  auto& cursors = *webhook.mutable_cursors();
  for (int i = cursors.size() - 1; i >= 0; --i) {
    if (cursors[i].stream() == stream) cursors.DeleteSubrange(i, 1);
  }
}

const v1::Webhook::Retry* RetryOf(const v1::Webhook& webhook, const std::string& stream) {
  for (const v1::Webhook::Retry& retry : webhook.retries()) {
    if (retry.stream() == stream) return &retry;
  }
  return nullptr;
}

void SetRetry(v1::Webhook& webhook, const std::string& stream,
              const std::optional<v1::Webhook::Retry>& retry) {
  auto& retries = *webhook.mutable_retries();
  for (int i = retries.size() - 1; i >= 0; --i) {
    if (retries[i].stream() == stream) retries.DeleteSubrange(i, 1);
  }
  if (retry) *retries.Add() = *retry;
}

}  // namespace mortise::gateway
