#include "services/composer/connecting/connection_warnings.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"

namespace mortise::composer {
namespace {

constexpr std::size_t kMostNamed = 2;     // further pairs
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
  std::vector<std::vector<LeftPair>> by_reason;
  for (const LeftPair& pair : left) {
    const auto known = std::find_if(by_reason.begin(), by_reason.end(), [&](const auto& pairs) {
      return pairs.front().reason == pair.reason;
    });
    (known == by_reason.end() ? by_reason.emplace_back() : *known).push_back(pair);
  }
  std::vector<ConnectionWarning> warnings;
  for (const std::vector<LeftPair>& pairs : by_reason) {
    ConnectionWarning& warning = warnings.emplace_back(Together(pairs));
    warning.text =
        absl::StrCat("nothing holds ", NamesOf(pairs.front()), " together: ", WhyOf(pairs.front()));
    for (std::size_t i = 1; i < std::min(pairs.size(), 1 + kMostNamed); ++i) {
      absl::StrAppend(&warning.text, i == 1 ? "; nor " : ", nor ", NamesOf(pairs[i]));
    }
    if (pairs.size() > 1 + kMostNamed) {
      const std::size_t others = pairs.size() - 1 - kMostNamed;
      absl::StrAppend(&warning.text, ", nor ", others,
                      others == 1 ? " other pair" : " other pairs");
    }
  }
  return warnings;
}

ConnectionWarning WarningOfMotion(const std::vector<LeftPair>& left, const std::string& name,
                                  const std::string& verb) {
  ConnectionWarning warning = Together(left);
  const LeftPair& first = left.front();
  warning.text = absl::StrCat("'", name, "' is to ", verb, ", and nothing lets it");
  if (first.reason == LeftPair::Reason::kNoSuch) {
    absl::StrAppend(&warning.text, ": the collection has no slides or hinges for ", NamesOf(first));
  } else {
    absl::StrAppend(&warning.text, " between ", NamesOf(first), ": ", WhyOf(first));
  }
  if (left.size() > 1) {
    absl::StrAppend(&warning.text, "; nor between ", left.size() - 1,
                    left.size() == 2 ? " other pair" : " other pairs");
  }
  return warning;
}

}  // namespace mortise::composer
