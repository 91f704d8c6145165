// Why a discovery comes to nothing: no design keeps to the constraints, or the subject itself
// cannot be evaluated.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/discovery/ask_tell.h"
#include "services/pareto/service/discovery_problem.h"

namespace mortise::pareto {

// Why no front can come of it: FAILED_PRECONDITION naming the subject, with what its evaluations
// failed for and, if some did not, how far the nearest is from the constraints.
absl::Status NoFeasibleDesign(const std::string& subject, const DiscoveryProblem& problem,
                              const AskTell& discovery);

// Whether all evaluations so far, at least those of the space-filling samples, failed, and several
// in the same words for what the subject may lack (FAILED_PRECONDITION, NOT_FOUND, UNIMPLEMENTED).
bool MayLackSomething(const AskTell& discovery, const AskTell::Summary& summary);

// If the default design lacks what several of those in `summary`, which all failed, lack in the
// same words: FAILED_PRECONDITION, SUBJECT_UNUSABLE, naming the subject and what that is. OK
// otherwise. Others may have failed before that was looked at, over dimensions that conflict, say.
absl::Status JudgeSubject(const std::string& subject, const AskTell::Summary& summary,
                          const Evaluation& default_design);

}  // namespace mortise::pareto
