#include "services/composer/connecting/connection_warnings.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::composer {
namespace {

constexpr std::size_t kMostNamed = 2;     // further pairs
constexpr std::size_t kMostReasons = 2;   // in one warning
constexpr std::size_t kMostDetail = 160;  // characters

// The first of what is wrong: solvers name all that cannot hold together.
std::string Brief(const std::string& detail) {
  const std::string first = detail.substr(0, detail.find("; "));
  if (first.size() <= kMostDetail) return first;
  return absl::StrCat(first.substr(0, first.rfind(' ', kMostDetail)), " …");
}

std::string WhyOf(const LeftPair& pair) {
  switch (pair.reason) {
    case LeftPair::Reason::kOriginal:
      return absl::StrCat("the connection of the original design does not fit: ",
                          Brief(pair.detail));
    case LeftPair::Reason::kNearest:
      return absl::StrCat("the nearest of the collection, ", Brief(pair.detail));
    case LeftPair::Reason::kNoSuch:
      break;
  }
  return "nothing in the collection connects such parts of these materials";
}

std::string NamesOf(const LeftPair& pair) {
  return absl::StrCat("'", pair.first, "' and '", pair.second, "'");
}

// The pairs by why they are left, in the order of their first ones.
std::vector<std::vector<LeftPair>> ByReason(const std::vector<LeftPair>& left) {
  std::vector<std::vector<LeftPair>> by_reason;
  std::map<std::string, std::size_t> known;
  for (const LeftPair& pair : left) {
    const auto [place, is_new] = known.try_emplace(WhyOf(pair), by_reason.size());
    if (is_new) by_reason.emplace_back();
    by_reason[place->second].push_back(pair);
  }
  return by_reason;
}

std::string OtherPairs(std::size_t count) {
  return absl::StrCat(count, count == 1 ? " other pair" : " other pairs");
}

// The warning of the first of these pairs, with the names of the others.
ConnectionWarning Together(const std::vector<LeftPair>& pairs) {
  ConnectionWarning warning{pairs.front().first, pairs.front().second, "", {}};
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    warning.others.emplace_back(pairs[i].first, pairs[i].second);
  }
  return warning;
}

}  // namespace

std::vector<ConnectionWarning> WarningsOf(const std::vector<LeftPair>& left) {
  std::vector<ConnectionWarning> warnings;
  for (const std::vector<LeftPair>& pairs : ByReason(left)) {
    ConnectionWarning& warning = warnings.emplace_back(Together(pairs));
    warning.text =
        absl::StrCat("nothing holds ", NamesOf(pairs.front()), " together: ", WhyOf(pairs.front()));
    for (std::size_t i = 1; i < std::min(pairs.size(), 1 + kMostNamed); ++i) {
      absl::StrAppend(&warning.text, i == 1 ? "; nor " : ", nor ", NamesOf(pairs[i]));
    }
    if (pairs.size() > 1 + kMostNamed) {
      absl::StrAppend(&warning.text, ", nor ", OtherPairs(pairs.size() - 1 - kMostNamed));
    }
  }
  return warnings;
}

ConnectionWarning WarningOfMotion(const std::vector<LeftPair>& left, const std::string& name,
                                  const WantedMotion& motion) {
  ConnectionWarning warning = Together(left);
  warning.text = absl::StrCat("'", name, "' is to ", VerbOf(motion), " ", motion.because,
                              ", and nothing lets it");
  const std::vector<std::vector<LeftPair>> by_reason = ByReason(left);
  for (std::size_t i = 0; i < std::min(by_reason.size(), kMostReasons); ++i) {
    const LeftPair& first = by_reason[i].front();
    const bool is_none = first.reason == LeftPair::Reason::kNoSuch;
    absl::StrAppend(&warning.text, i == 0 ? ": " : "; ",
                    is_none ? "the collection has no slides or hinges for " : "between ",
                    NamesOf(first));
    if (by_reason[i].size() > 1) {
      absl::StrAppend(&warning.text, " and ", OtherPairs(by_reason[i].size() - 1));
    }
    if (!is_none) absl::StrAppend(&warning.text, ": ", WhyOf(first));
  }
  if (by_reason.size() > kMostReasons) {
    const std::size_t more = by_reason.size() - kMostReasons;
    absl::StrAppend(&warning.text, "; and ", more, more == 1 ? " more reason" : " more reasons");
  }
  return warning;
}

}  // namespace mortise::composer
