// A discovery is driven by asking for designs and telling what became of them (Collette and others
// 2010).
//
// This is what Discovery and CombinedDiscovery have in common, so that one loop (discovery_run.h)
// drives both. Proposals are numbered 0, 1, ...; their results are committed in that order,
// whenever they arrive, and proposals depend on nothing but the seed and the answers (discovery.h).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/evaluation/failures/failure_tally.h"
#include "services/pareto/archive/archive.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/front/front.h"
#include "services/pareto/models/surrogate_quality.h"

namespace mortise::pareto {

class AskTell {
 public:
  enum class StopReason { kRunning, kBudget, kConverged, kCancelled, kEvaluatorLost };

  struct Summary {
    StopReason stop_reason = StopReason::kRunning;
    std::string message;           // why, for people
    std::int64_t evaluations = 0;  // committed
    std::int64_t failed = 0;       // of those
    std::int64_t violating = 0;    // of those, evaluated but not within all constraints
    std::vector<evaluation::FailureCount>
        failures;  // what they failed for; the counts add up to `failed`
    std::int64_t optimizations = 0;
    std::int64_t expansions = 0;
    std::int64_t pieces = 0;         // affine ones followed so far; the front has fewer
    std::int64_t cells_covered = 0;  // of the buffer
    // The dominated share of the box from ideal to nadir. While running it is that of up to a
    // sixteenth of the evaluations ago, and for d > 3 from samples, good to about a hundredth; at
    // the end it is QuickHypervolume's.
    double hypervolume = 0;
    SurrogateQuality surrogate;  // of its proposals, so far
    // Combinations of values of choices and whole numbers: how many there are (at most 2^56), how
    // many of those were tried, and how many of the tried ones are given up by now.
    std::int64_t combinations = 1;
    std::int64_t combinations_tried = 1;
    std::int64_t combinations_pruned = 0;
  };

  struct Proposal {
    std::int64_t number = 0;
    Eigen::VectorXd x;  // D, within the bounds
  };

  virtual ~AskTell() = default;

  // Returns the next design to evaluate; nullopt while results are needed first, or once finished.
  virtual std::optional<Proposal> Ask() = 0;

  // Takes the result of proposal `number`, in any order. INVALID_ARGUMENT for a number that is not
  // awaited, another design than proposed, or metrics or constraints of the wrong count; an
  // evaluation with metrics or constraints that are not finite counts as failed.
  virtual absl::Status Tell(std::int64_t number, Evaluation evaluation) = 0;

  // Stops with what has been found. Results that were told but not committed are kept.
  virtual void Stop(StopReason reason, std::string message) = 0;

  // Whether Ask will give nothing more and every result has been committed.
  virtual bool Finished() const = 0;

  virtual Summary summary() const = 0;
  virtual Front front() const = 0;

  // Returns what was committed: entries have the numbers of their proposals.
  virtual const Archive& archive() const = 0;

  // Returns how many designs are evaluated before the search begins: those given and those that
  // fill the space.
  virtual std::int64_t initial_samples() const = 0;
};

// Returns "BUDGET", "CONVERGED", "CANCELLED", "EVALUATOR_LOST" or "RUNNING".
const char* StopReasonName(AskTell::StopReason reason);

}  // namespace mortise::pareto
