// Grouping of failures by what they say.
#include "common/evaluation/failures/failure_tally.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace mortise::evaluation {
namespace {

constexpr std::size_t kMaxKinds = 16;
constexpr char kOther[] = "OTHER";

bool IsOfNumber(char c) { return absl::ascii_isdigit(static_cast<unsigned char>(c)); }

// A run of digits, with a point, sign or exponent in it, counts as one character.
std::string WithoutNumbers(const std::string& text) {
  std::string rest;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!IsOfNumber(text[i])) {
      rest += text[i];
      continue;
    }
    if (!rest.empty() && rest.back() == '-') rest.pop_back();
    rest += '#';
    while (i + 1 < text.size()) {
      const char next = text[i + 1];
      const bool goes_on = i + 2 < text.size() && IsOfNumber(text[i + 2]);
      const bool exponent = next == 'e' && i + 3 < text.size() &&
                            (text[i + 2] == '-' || text[i + 2] == '+') && IsOfNumber(text[i + 3]);
      if (!IsOfNumber(next) && !(next == '.' && goes_on) && !exponent) break;
      i += exponent ? 2 : 1;
    }
  }
  return rest;
}

// Reasons that are FAILED_PRECONDITION, but may hold for some designs of a subject only, and be
// given in the same words for many.
bool IsOfDesign(const std::string& reason) {
  for (const char* known :
       {"RIGID_MOTION", "SINGULAR", "NOT_CONVERGED", "NOT_BONDED", "NOT_FINITE", "QUARANTINED"}) {
    if (reason == known) return true;
  }
  return false;
}

std::string ReasonOf(const FailedDesign& failed) {
  return failed.reason.empty() ? absl::StatusCodeToString(failed.code) : failed.reason;
}

}  // namespace

void FailureTally::Add(const FailedDesign& failed) {
  std::string reason = ReasonOf(failed);
  std::string key = absl::StrCat(reason, " ", WithoutNumbers(failed.message));
  auto at = std::find(keys_.begin(), keys_.end(), key);
  if (at == keys_.end() && keys_.size() + 1 >= kMaxKinds) {
    key = reason = kOther;
    at = std::find(keys_.begin(), keys_.end(), key);
  }
  if (at == keys_.end()) {
    keys_.push_back(std::move(key));
    failures_.push_back({std::move(reason), failed.code, 1, failed.message, failed.x, true});
    return;
  }
  FailureCount& known = failures_[static_cast<std::size_t>(at - keys_.begin())];
  ++known.count;
  known.same_message = known.same_message && known.message == failed.message;
}

bool MayBeOfSubject(const FailureCount& failure) {
  return failure.count > 1 && failure.same_message && !IsOfDesign(failure.reason) &&
         (failure.code == absl::StatusCode::kFailedPrecondition ||
          failure.code == absl::StatusCode::kNotFound ||
          failure.code == absl::StatusCode::kUnimplemented);
}

std::string CountsByReason(const std::vector<FailureCount>& failures) {
  std::map<std::string, std::int64_t> counts;
  for (const FailureCount& failure : failures) counts[failure.reason] += failure.count;
  std::vector<std::pair<std::string, std::int64_t>> sorted(counts.begin(), counts.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return absl::StrJoin(sorted, ", ", [](std::string* out, const auto& entry) {
    absl::StrAppend(out, entry.second, " ", entry.first);
  });
}

std::string CountsWithExamples(const std::vector<FailureCount>& failures) {
  std::vector<FailureCount> sorted = failures;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const FailureCount& a, const FailureCount& b) { return a.count > b.count; });
  return absl::StrJoin(sorted, "; ", [](std::string* out, const FailureCount& failure) {
    absl::StrAppend(out, failure.count, " ", failure.reason);
    if (!failure.message.empty()) absl::StrAppend(out, ", such as: ", failure.message);
  });
}

}  // namespace mortise::evaluation
