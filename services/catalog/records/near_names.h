// Offers the names of records like one that nobody has.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/field_violations.h"
#include "common/store/store.h"

namespace mortise::catalog {

// Returns the failure to find the resource `name`, of the records `kind`, with the name that may be
// meant: "there is no 'templates/tabel'; did you mean 'templates/table'?". What is deleted is not
// offered. Every other status is returned as it is, and so is this one where no name is like it.
absl::Status WithNearName(store::ReadTransaction& transaction, const char* kind,
                          const std::string& name, const absl::Status& status);

// The same of what was looked for.
template <typename Found>
absl::StatusOr<Found> OrNearName(store::ReadTransaction& transaction, const char* kind,
                                 const std::string& name, absl::StatusOr<Found> found) {
  if (found.ok()) return found;
  return WithNearName(transaction, kind, name, found.status());
}

// Adds the name that may be meant to those findings that say `message` of the resource `name`, in
// place of what they offer.
void OfferNearName(store::ReadTransaction& transaction, const char* kind, const std::string& name,
                   const std::string& message, std::vector<FieldViolation>& findings);

// Returns what is wrong with a template that uses these items, with an item that may be meant
// wherever it is said that there is none.
absl::Status WithNearItems(store::ReadTransaction& transaction, const std::set<std::string>& items,
                           const absl::Status& faults);

}  // namespace mortise::catalog
