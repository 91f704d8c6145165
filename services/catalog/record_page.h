// Pages of List methods, whatever kind of record they show.
//
// A page ends after as many entries as were asked for, or before one with which it would be too
// large for clients, whichever is first. Its token is the key of its last record.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/store/store.h"
#include "services/catalog/catalog_records.h"
#include "services/catalog/record_access.h"

namespace mortise::catalog {

// Bytes of a page's entries; only one that has more by itself is given all the same. gRPC's clients
// take 4 MiB, and JSON is longer.
inline constexpr std::size_t kMaxPageBytes = 2'000'000;

// The page of the records of `kind` that follow `page_token`, in the order of their keys.
// `entry_of(record)` gives a StatusOr<std::optional<Message>>: nothing for what is not shown.
// INVALID_ARGUMENT naming page_size or page_token. Reads few records at a time, as some are large.
template <typename Message, typename Function>
absl::StatusOr<Page<Message>> ReadPage(store::ReadTransaction& transaction, const char* kind,
                                       int page_size, const std::string& page_token,
                                       const Function& entry_of) {
  constexpr int kAtOnce = 50;
  MORTISE_ASSIGN_OR_RETURN(store::ListOptions options, PageOptions(page_size, page_token));
  const auto most = static_cast<std::size_t>(options.limit);
  options.limit = std::min(options.limit, kAtOnce);
  Page<Message> page;
  std::size_t bytes = 0;
  std::string last;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records,
                             transaction.List(kind, options));
    for (const store::Record& record : records) {
      if (IsDeleted(record)) continue;
      MORTISE_ASSIGN_OR_RETURN(std::optional<Message> entry, entry_of(record));
      if (!entry) continue;
      bytes += entry->ByteSizeLong();
      const bool is_full =
          page.entries.size() == most || (!page.entries.empty() && bytes > kMaxPageBytes);
      if (is_full) {
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

}  // namespace mortise::catalog
