#include "services/pareto/service/discovery_failures.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::pareto {
namespace {

// Reasons that are FAILED_PRECONDITION, but may hold for some designs of a subject only, and be
// given in the same words for many.
bool IsOfDesign(const std::string& reason) {
  for (const char* known :
       {"RIGID_MOTION", "SINGULAR", "NOT_CONVERGED", "NOT_BONDED", "NOT_FINITE", "QUARANTINED"}) {
    if (reason == known) return true;
  }
  return false;
}

// Whether several designs failed in the same words for what the subject may lack.
bool IsOfSubject(const FailureCount& failure) {
  return failure.count > 1 && failure.same_message && !IsOfDesign(failure.reason) &&
         (failure.code == absl::StatusCode::kFailedPrecondition ||
          failure.code == absl::StatusCode::kNotFound ||
          failure.code == absl::StatusCode::kUnimplemented);
}

}  // namespace

absl::Status NoFeasibleDesign(const std::string& subject, const DiscoveryProblem& problem,
                              const AskTell& discovery) {
  const AskTell::Summary summary = discovery.summary();
  std::string reasons;
  if (summary.violating > 0) {
    reasons = absl::StrCat(" meets all constraints; the nearest does not because ",
                           MissedByNearest(problem.constraints, discovery.archive()));
  }
  if (summary.failed > 0) {
    absl::StrAppend(&reasons, reasons.empty() ? " could be evaluated: " : "; others failed: ",
                    CountsWithExamples(summary.failures));
  }
  return PreconditionFailed(
      "NO_FEASIBLE_DESIGN",
      absl::StrCat("none of ", summary.evaluations, " designs of ", subject, reasons), subject);
}

bool MayLackSomething(const AskTell& discovery, const AskTell::Summary& summary) {
  return summary.evaluations >= discovery.initial_samples() &&
         summary.failed == summary.evaluations &&
         std::any_of(summary.failures.begin(), summary.failures.end(), IsOfSubject);
}

absl::Status JudgeSubject(const std::string& subject, const AskTell::Summary& summary,
                          const Evaluation& default_design) {
  if (default_design.status != EvaluationStatus::kFailed) return absl::OkStatus();
  const auto shared = std::find_if(
      summary.failures.begin(), summary.failures.end(), [&](const FailureCount& failure) {
        return IsOfSubject(failure) && failure.code == default_design.code &&
               failure.message == default_design.message;
      });
  if (shared == summary.failures.end()) return absl::OkStatus();
  return PreconditionFailed(
      "SUBJECT_UNUSABLE",
      absl::StrCat("no design of ", subject, " can be evaluated. The default one and ",
                   shared->count, " of the first ", summary.evaluations,
                   ", which all failed, say: ", shared->message, " (", shared->reason, ")"),
      subject);
}

}  // namespace mortise::pareto
