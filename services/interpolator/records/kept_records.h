// Records of one build, under keys that begin with its id. Private to this folder.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/base/errors.h"
#include "common/store/store.h"

namespace mortise::interpolator {

inline std::string KeptPrefix(const std::string& id) { return id + "/"; }

// Shows each record of the kind to `visit`, which returns a status.
template <typename Visit>
absl::Status VisitKept(store::ReadTransaction& transaction, const std::string& kind,
                       const std::string& id, bool with_payloads, const Visit& visit) {
  constexpr int kPage = 1000;
  store::ListOptions list;
  list.key_prefix = KeptPrefix(id);
  list.limit = kPage;
  list.without_payloads = !with_payloads;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page, transaction.List(kind, list));
    for (const store::Record& record : page) MORTISE_RETURN_IF_ERROR(visit(record));
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    list.after_key = page.back().key;
  }
}

// Removes them all.
inline absl::Status DropKept(store::Transaction& transaction, const std::string& kind,
                             const std::string& id) {
  return VisitKept(
      transaction, kind, id, /*with_payloads=*/false,
      [&](const store::Record& record) { return transaction.Delete(kind, record.key); });
}

}  // namespace mortise::interpolator
