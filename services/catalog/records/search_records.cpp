#include "services/catalog/records/search_records.h"

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/search_outcome_codec.h"
#include "common/base/digest.h"
#include "common/base/errors.h"

namespace mortise::catalog {
namespace {

// The kind of their records.
constexpr const char* kSearches = "searches";

// Names of groups may hold what keys may not.
std::string KeyOf(const Searched& searched) {
  if (searched.group.empty()) return searched.digest;
  return absl::StrCat(searched.digest, "/", Sha256Hex(searched.group));
}

}  // namespace

std::optional<parametric::SearchOutcome> FindSearchOutcome(store::Store& store,
                                                           const Searched& searched) {
  std::optional<parametric::SearchOutcome> outcome;
  const absl::Status read = store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const store::Record record,
                             transaction.Get(kSearches, KeyOf(searched)));
    outcome = parametric::SearchOutcomeFrom(record.payload);
    return absl::OkStatus();
  });
  if (!read.ok()) return std::nullopt;
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

}  // namespace mortise::catalog
