#include "services/catalog/records/search_records.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/search_outcome_codec.h"
#include "common/base/digest.h"
#include "common/base/errors.h"

namespace mortise::catalog {
namespace {

// The kind of their records.
constexpr const char* kSearches = "searches";
constexpr int kPage = 1000;

// Names of groups may hold what keys may not.
std::string KeyOf(const Searched& searched) {
  if (searched.group.empty()) return searched.digest;
  return absl::StrCat(searched.digest, "/", Sha256Hex(searched.group));
}

}  // namespace

std::optional<parametric::SearchOutcome> FindSearchOutcome(store::Store& store,
                                                           const Searched& searched) {
  std::optional<parametric::SearchOutcome> outcome;
  bool is_old = false;
  const absl::Status read = store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const store::Record record,
                             transaction.Get(kSearches, KeyOf(searched)));
    outcome = parametric::SearchOutcomeFrom(record.payload);
    is_old = record.updated_at < store.Now() - kUnusedSearchLife / 2;
    return absl::OkStatus();
  });
  if (!read.ok()) return std::nullopt;
  // Keeping it once more tells that it is used. Within a transaction that fails; the next one
  // tells.
  if (outcome && is_old) KeepSearchOutcome(store, searched, *outcome).IgnoreError();
  return outcome;
}

absl::Status KeepSearchOutcome(store::Store& store, const Searched& searched,
                               const parametric::SearchOutcome& outcome) {
  return store.Transact([&](store::Transaction& transaction) -> absl::Status {
    return transaction
        .Put(kSearches, KeyOf(searched), parametric::ToText(outcome), {.keep_history = false})
        .status();
  });
}

absl::StatusOr<int> SweepSearches(store::Store& store) {
  int removed = 0;
  MORTISE_RETURN_IF_ERROR(store.Transact([&](store::Transaction& transaction) -> absl::Status {
    removed = 0;
    store::ListOptions list{.limit = kPage, .without_payloads = true};
    while (true) {
      MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records,
                               transaction.List(kSearches, list));
      for (const store::Record& record : records) {
        if (record.updated_at >= transaction.Now() - kUnusedSearchLife) continue;
        MORTISE_RETURN_IF_ERROR(transaction.Delete(kSearches, record.key));
        ++removed;
      }
      if (static_cast<int>(records.size()) < kPage) return absl::OkStatus();
      list.after_key = records.back().key;
    }
  }));
  return removed;
}

}  // namespace mortise::catalog
