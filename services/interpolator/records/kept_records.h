// Records of one build, under keys that begin with its id and the version of what they hold for.
// Private to this folder.
//
// Answers are kept by the number that their design was asked for with, shapes by the canonical
// meshes that mapping has chosen: after a change of the sampling or of the mapping the same number
// may be of another design. So what is kept under another version is not read, and a build that was
// interrupted finds it out again; it goes with the build's other records.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/maps/map_sampling.h"
#include "common/store/store.h"
#include "services/interpolator/mapping/mapping_version.h"

namespace mortise::interpolator {

// Of all versions.
inline std::string AllKeptPrefix(const std::string& id) { return id + "/"; }

// Of the present one.
inline std::string KeptPrefix(const std::string& id) {
  return absl::StrCat(AllKeptPrefix(id), "sampling ", maps::kSamplingVersion, ", mapping ",
                      kMappingVersion, "/");
}

// Shows each record of the kind whose key begins so to `visit`, which returns a status.
template <typename Visit>
absl::Status VisitKept(store::ReadTransaction& transaction, const std::string& kind,
                       const std::string& prefix, bool with_payloads, const Visit& visit) {
  constexpr int kPage = 1000;
  store::ListOptions list;
  list.key_prefix = prefix;
  list.limit = kPage;
  list.without_payloads = !with_payloads;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page, transaction.List(kind, list));
    for (const store::Record& record : page) MORTISE_RETURN_IF_ERROR(visit(record));
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    list.after_key = page.back().key;
  }
}

// Removes them all, of whatever version.
inline absl::Status DropKept(store::Transaction& transaction, const std::string& kind,
                             const std::string& id) {
  return VisitKept(
      transaction, kind, AllKeptPrefix(id), /*with_payloads=*/false,
      [&](const store::Record& record) { return transaction.Delete(kind, record.key); });
}

}  // namespace mortise::interpolator
