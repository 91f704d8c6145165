// FieldViolation out which shapes are named anywhere.
#include "services/catalog/records/shape_sweep.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kDigest = 64;  // characters
constexpr int kPage = 100;
constexpr std::string_view kPrefix = "shapes/";

bool IsHexadecimal(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }

// The keys of the shapes named in a record. Messages hold names as they are, so that this finds
// them whatever field they are in.
void AddNamed(std::string_view payload, std::set<std::string>& named) {
  for (std::size_t at = payload.find(kPrefix); at != std::string_view::npos;
       at = payload.find(kPrefix, at + 1)) {
    const std::string_view key = payload.substr(at + kPrefix.size(), kDigest);
    if (key.size() == kDigest && std::all_of(key.begin(), key.end(), IsHexadecimal)) {
      named.insert(std::string(key));
    }
  }
}

// Calls `take` for each record of a kind, with its payload or without.
template <typename Take>
absl::Status ForEach(store::ReadTransaction& transaction, const char* kind, bool without_payloads,
                     const Take& take) {
  store::ListOptions list;
  list.limit = kPage;
  list.without_payloads = without_payloads;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records,
                             transaction.List(kind, list));
    for (const store::Record& record : records) MORTISE_RETURN_IF_ERROR(take(record));
    if (static_cast<int>(records.size()) < kPage) return absl::OkStatus();
    list.after_key = records.back().key;
  }
}

// The keys of all shapes that a revision of anything names.
absl::StatusOr<std::set<std::string>> NamedShapes(store::ReadTransaction& transaction) {
  std::set<std::string> named;
  for (const char* kind : {kItems, kAssemblies, kTemplates}) {
    MORTISE_RETURN_IF_ERROR(
        ForEach(transaction, kind, false, [&](const store::Record& latest) -> absl::Status {
          AddNamed(latest.payload, named);
          for (int64_t revision = 1; revision < latest.revision; ++revision) {
            const absl::StatusOr<store::Record> earlier =
                transaction.GetRevision(kind, latest.key, revision);
            if (absl::IsNotFound(earlier.status())) continue;  // not kept
            MORTISE_RETURN_IF_ERROR(earlier.status());
            AddNamed(earlier->payload, named);
          }
          return absl::OkStatus();
        }));
  }
  return named;
}

bool IsOld(const store::Record& shape, absl::Time now) {
  return shape.updated_at < now - kUnusedShapeLife;
}

// The keys of shapes that may go, as it looks without keeping others from writing.
absl::StatusOr<std::vector<std::string>> Candidates(store::Store& store) {
  std::vector<std::string> candidates;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    candidates.clear();
    MORTISE_RETURN_IF_ERROR(ForEach(transaction, kShapes, true, [&](const store::Record& shape) {
      if (IsOld(shape, store.Now())) candidates.push_back(shape.key);
      return absl::OkStatus();
    }));
    if (candidates.empty()) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(const std::set<std::string> named, NamedShapes(transaction));
    std::erase_if(candidates, [&](const std::string& key) { return named.contains(key); });
    return absl::OkStatus();
  }));
  return candidates;
}

}  // namespace

absl::StatusOr<std::vector<std::string>> SweepShapes(store::Store& store) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<std::string> candidates, Candidates(store));
  std::vector<std::string> removed;
  if (candidates.empty()) return removed;
  MORTISE_RETURN_IF_ERROR(store.Transact([&](store::Transaction& transaction) -> absl::Status {
    removed.clear();
    MORTISE_ASSIGN_OR_RETURN(const std::set<std::string> named, NamedShapes(transaction));
    for (const std::string& key : candidates) {
      if (named.contains(key)) continue;
      const absl::StatusOr<store::Record> shape = transaction.Get(kShapes, key);
      if (absl::IsNotFound(shape.status())) continue;  // another replica was first
      MORTISE_RETURN_IF_ERROR(shape.status());
      if (!IsOld(*shape, transaction.Now())) continue;
      MORTISE_RETURN_IF_ERROR(transaction.Delete(kShapes, key));
      removed.push_back(absl::StrCat("shapes/", key));
      MORTISE_RETURN_IF_ERROR(AppendEvent(transaction, "shape.deleted", removed.back(),
                                          {{"bytes", shape->payload.size()}}, {}));
    }
    return absl::OkStatus();
  }));
  return removed;
}

}  // namespace mortise::catalog
