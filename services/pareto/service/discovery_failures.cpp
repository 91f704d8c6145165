#include "services/pareto/service/discovery_failures.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::pareto {

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
                    evaluation::CountsWithExamples(summary.failures));
  }
  return PreconditionFailed(
      "NO_FEASIBLE_DESIGN",
      absl::StrCat("none of ", summary.evaluations, " designs of ", subject, reasons), subject);
}

bool MayLackSomething(const AskTell& discovery, const AskTell::Summary& summary) {
  return summary.evaluations >= discovery.initial_samples() &&
         summary.failed == summary.evaluations &&
         std::any_of(summary.failures.begin(), summary.failures.end(), evaluation::MayBeOfSubject);
}

absl::Status JudgeSubject(const std::string& subject, const AskTell::Summary& summary,
                          const Evaluation& default_design) {
  if (default_design.status != EvaluationStatus::kFailed) return absl::OkStatus();
  const auto shared = std::find_if(summary.failures.begin(), summary.failures.end(),
                                   [&](const evaluation::FailureCount& failure) {
                                     return evaluation::MayBeOfSubject(failure) &&
                                            failure.code == default_design.code &&
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
