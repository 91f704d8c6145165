#include "services/catalog/records/near_names.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/base/violation_lists.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog {
namespace {

constexpr int kKeysAtOnce = 10'000;
constexpr std::size_t kMostKeys = 50'000;  // that are compared, so that no name takes long
constexpr int kTries = 5;                  // deleted ones may be nearer

// The keys of the first records of a kind; as far as they can be read.
std::vector<std::string> KeysOf(store::ReadTransaction& transaction, const char* kind) {
  std::vector<std::string> keys;
  store::ListOptions options{.limit = kKeysAtOnce, .without_payloads = true};
  while (true) {
    const auto page = transaction.List(kind, options);
    if (!page.ok()) return keys;
    for (const store::Record& record : *page) keys.push_back(record.key);
    if (static_cast<int>(page->size()) < kKeysAtOnce || keys.size() >= kMostKeys) return keys;
    options.after_key = keys.back();
  }
}

// The name that may be meant by one that nobody has, of these keys.
std::optional<std::string> NearNameOf(store::ReadTransaction& transaction, const char* kind,
                                      const std::string& name, std::vector<std::string> keys) {
  const std::string prefix = absl::StrCat(kind, "/");
  if (!name.starts_with(prefix)) return std::nullopt;
  const std::string key = name.substr(prefix.size());
  for (int i = 0; i < kTries; ++i) {
    const std::optional<std::string> nearest = NearestName(key, keys);
    if (!nearest) return std::nullopt;
    const std::string offered = absl::StrCat(prefix, *nearest);
    if (GetRecord(transaction, kind, offered).ok()) return offered;
    std::erase(keys, *nearest);
  }
  return std::nullopt;
}

std::string Offer(const std::string& message, const std::string& near) {
  return absl::StrCat(message, "; did you mean '", near, "'?");
}

// Offers names of records to findings; which there are is read once, if at all.
class Offers {
 public:
  Offers(store::ReadTransaction& transaction, const char* kind)
      : transaction_(transaction), kind_(kind) {}

  void Add(const std::string& name, const std::string& message,
           std::vector<FieldViolation>& findings) {
    // Whoever checked it may have offered one of the few that it knows.
    const auto says_it = [&message](const FieldViolation& finding) {
      return finding.message.starts_with(message);
    };
    if (std::none_of(findings.begin(), findings.end(), says_it)) return;
    if (!keys_) keys_ = KeysOf(transaction_, kind_);
    const std::optional<std::string> near = NearNameOf(transaction_, kind_, name, *keys_);
    if (!near) return;
    for (FieldViolation& finding : findings) {
      if (says_it(finding)) finding.message = Offer(message, *near);
    }
  }

 private:
  store::ReadTransaction& transaction_;
  const char* const kind_;
  std::optional<std::vector<std::string>> keys_;
};

}  // namespace

absl::Status WithNearName(store::ReadTransaction& transaction, const char* kind,
                          const std::string& name, const absl::Status& status) {
  const ErrorDetail detail = DetailOf(status);
  // A revision that is not there is one of a name that is.
  if (!absl::IsNotFound(status) || detail.field != name) return status;
  const std::optional<std::string> near =
      NearNameOf(transaction, kind, name, KeysOf(transaction, kind));
  if (!near) return status;
  return WithDetail(absl::Status(status.code(), Offer(std::string(status.message()), *near)),
                    detail);
}

void OfferNearName(store::ReadTransaction& transaction, const char* kind, const std::string& name,
                   const std::string& message, std::vector<FieldViolation>& findings) {
  Offers(transaction, kind).Add(name, message, findings);
}

absl::Status WithNearItems(store::ReadTransaction& transaction, const std::set<std::string>& items,
                           const absl::Status& faults) {
  std::vector<FieldViolation> violations = AllViolationsOf(faults);
  if (violations.empty()) return faults;
  Offers offers(transaction, kItems);
  for (const std::string& item : items) {
    offers.Add(item, absl::StrCat("there is no item '", item, "'"), violations);
  }
  return InvalidFields(violations);
}

}  // namespace mortise::catalog
