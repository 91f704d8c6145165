// Pages of List methods over records of one kind in the store.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/resources/page_rule.h"
#include "common/store/store.h"

namespace mortise::resources {

// One page of a List method.
template <typename Message>
struct Page {
  std::vector<Message> entries;
  std::string next_page_token;  // the key of the last record on it; empty on the last page
};

// Which records a list is of.
struct RecordList {
  std::string kind = {};
  std::string key_prefix = {};  // only keys that start with this
  bool newest_first = false;    // from the greatest key down, else in the order of keys
};

// Returns the page of the records that follow `query.after`. `entry_of(record)` gives a
// StatusOr<std::optional<Message>>: nothing for what is not shown. Reads few records at a time, as
// some are large.
template <typename Message, typename EntryOf>
absl::StatusOr<Page<Message>> ReadPage(store::ReadTransaction& transaction, const RecordList& list,
                                       const PageQuery& query, const EntryOf& entry_of) {
  constexpr int kAtOnce = 50;
  store::ListOptions options{.after_key = query.after,
                             .key_prefix = list.key_prefix,
                             .limit = std::min(query.size + 1, kAtOnce),
                             .descending = list.newest_first};
  Page<Message> page;
  PageRoom room(query.size);
  std::string last;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records,
                             transaction.List(list.kind, options));
    for (const store::Record& record : records) {
      MORTISE_ASSIGN_OR_RETURN(std::optional<Message> entry, entry_of(record));
      if (!entry) continue;
      if (!room.Take(entry->ByteSizeLong())) {
        page.next_page_token = last;
        return page;
      }
      last = record.key;
      page.entries.push_back(*std::move(entry));
    }
    if (static_cast<int>(records.size()) < options.limit) return page;
    options.after_key = records.back().key;
  }
}

// Returns the message that a record holds. INTERNAL, STORAGE_FAILED naming "kind/key" where it
// holds none.
template <typename Message>
absl::StatusOr<Message> ParseRecord(const std::string& kind, const store::Record& record) {
  Message message;
  if (message.ParseFromString(record.payload)) return message;
  return StorageFailed(absl::StrCat(kind, "/", record.key), "the record cannot be read");
}

// Returns the page of records that are shown as they are stored.
template <typename Message>
absl::StatusOr<Page<Message>> ReadPage(store::ReadTransaction& transaction, const RecordList& list,
                                       const PageQuery& query) {
  return ReadPage<Message>(
      transaction, list, query,
      [&](const store::Record& record) -> absl::StatusOr<std::optional<Message>> {
        return ParseRecord<Message>(list.kind, record);
      });
}

}  // namespace mortise::resources
