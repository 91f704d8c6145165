// Pages of the catalog's lists: those of common/resources, without what was deleted.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "common/base/errors.h"
#include "common/resources/record_page.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog {

// Returns the page of the records of `kind` that a List request asks for, in the order of their
// keys. `entry_of(record)` gives a StatusOr<std::optional<Message>>: nothing for what is not shown.
// INVALID_ARGUMENT naming page_size or page_token.
template <typename Message, typename Request, typename EntryOf>
absl::StatusOr<Page<Message>> ReadPage(store::ReadTransaction& transaction, const char* kind,
                                       const Request& request, const EntryOf& entry_of) {
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(request));
  return resources::ReadPage<Message>(
      transaction, {.kind = kind}, query,
      [&](const store::Record& record) -> absl::StatusOr<std::optional<Message>> {
        if (IsDeleted(record)) return std::nullopt;
        return entry_of(record);
      });
}

}  // namespace mortise::catalog
