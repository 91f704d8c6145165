// The loop between a discovery and its evaluator.
#include "services/pareto/discovery/discovery_run.h"

#include <chrono>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/mailbox.h"
#include "common/base/thread_pool.h"

namespace mortise::pareto {
namespace {

constexpr std::chrono::milliseconds kCancelPoll{100};

using Clock = std::chrono::steady_clock;
using Numbered = std::vector<std::pair<std::int64_t, Evaluation>>;

absl::StatusOr<Numbered> EvaluateBatch(Evaluator& evaluator,
                                       const std::vector<AskTell::Proposal>& batch) {
  std::vector<Eigen::VectorXd> designs;
  for (const AskTell::Proposal& proposal : batch) designs.push_back(proposal.x);
  MORTISE_ASSIGN_OR_RETURN(std::vector<Evaluation> results, evaluator.Evaluate(designs));
  if (results.size() != batch.size()) {
    return absl::InternalError(
        absl::StrCat("the evaluator answered ", results.size(), " of ", batch.size(), " designs"));
  }
  Numbered numbered;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    numbered.emplace_back(batch[i].number, std::move(results[i]));
  }
  return numbered;
}

class Loop {
 public:
  Loop(AskTell& discovery, Evaluator& evaluator, const RunOptions& options,
       const std::map<std::int64_t, Evaluation>& known)
      : discovery_(discovery),
        evaluator_(evaluator),
        options_(options),
        known_(known),
        lanes_(std::max(1, options.lanes)) {}

  absl::Status Run() {
    const absl::Status status = RunToItsEnd();
    if (!status.ok()) KeepWhatIsUnderWay();
    return status;
  }

 private:
  absl::Status RunToItsEnd() {
    while (true) {
      if (!discovery_.Finished() && options_.cancelled && options_.cancelled()) {
        discovery_.Stop(AskTell::StopReason::kCancelled, "cancelled");
        evaluator_.Interrupt();
      }
      MORTISE_RETURN_IF_ERROR(Keep(FillLanes()));
      if (under_way_ == 0) return absl::OkStatus();
      std::optional<absl::StatusOr<Numbered>> batch = mailbox_.Take(kCancelPoll);
      if (batch) MORTISE_RETURN_IF_ERROR(Keep(Receive(*std::move(batch))));
      TellOfWaiting(batch.has_value());
    }
  }

  void TellOfWaiting(bool answered) {
    const Clock::time_point now = Clock::now();
    if (answered) {
      answered_ = now;
      told_ = now;
    } else if (options_.waiting && now - told_ >= options_.quiet && !discovery_.Finished()) {
      told_ = now;
      options_.waiting(std::chrono::duration_cast<std::chrono::seconds>(now - answered_),
                       under_way_);
    }
  }

  // After a failure: what other lanes have evaluated meanwhile need not be evaluated again.
  void KeepWhatIsUnderWay() {
    while (under_way_ > 0) {
      const std::optional<absl::StatusOr<Numbered>> batch = mailbox_.Take(kCancelPoll);
      if (!batch) continue;
      --under_way_;
      // The failure that is told is the first.
      if (batch->ok() && can_keep_) KeepResults(**batch).IgnoreError();
    }
  }

  absl::Status KeepResults(const Numbered& batch) {
    if (!options_.checkpoint) return absl::OkStatus();
    const absl::Status kept = options_.checkpoint(batch);
    can_keep_ = kept.ok();
    return kept;
  }

  // A failure ends the discovery, which keeps what it found.
  absl::Status Keep(absl::Status status) {
    if (!status.ok()) {
      discovery_.Stop(AskTell::StopReason::kEvaluatorLost, std::string(status.message()));
    }
    return status;
  }

  absl::Status FillLanes() {
    while (!discovery_.Finished() && under_way_ < std::max(1, options_.lanes)) {
      std::vector<AskTell::Proposal> batch;
      while (static_cast<int>(batch.size()) < std::max(1, options_.batch_size)) {
        std::optional<AskTell::Proposal> proposal = discovery_.Ask();
        if (!proposal) break;
        const auto known = known_.find(proposal->number);
        if (known != known_.end()) {
          const absl::Status told = discovery_.Tell(proposal->number, known->second);
          if (!told.ok()) {
            return absl::DataLossError(
                absl::StrCat("the saved results belong to another discovery: ", told.message()));
          }
        } else {
          batch.push_back(*std::move(proposal));
        }
      }
      if (batch.empty()) return absl::OkStatus();
      ++under_way_;
      lanes_.Submit([this, batch] { mailbox_.Put(EvaluateBatch(evaluator_, batch)); });
    }
    return absl::OkStatus();
  }

  absl::Status Receive(absl::StatusOr<Numbered> batch) {
    --under_way_;
    if (discovery_.Finished()) return absl::OkStatus();
    MORTISE_RETURN_IF_ERROR(batch.status());
    MORTISE_RETURN_IF_ERROR(KeepResults(*batch));
    for (auto& [number, evaluation] : *batch) {
      MORTISE_RETURN_IF_ERROR(discovery_.Tell(number, std::move(evaluation)));
    }
    if (options_.progress || options_.judge) {
      const AskTell::Summary summary = discovery_.summary();
      if (options_.progress) options_.progress(summary);
      if (options_.judge) MORTISE_RETURN_IF_ERROR(options_.judge(summary));
    }
    return absl::OkStatus();
  }

  AskTell& discovery_;
  Evaluator& evaluator_;
  const RunOptions& options_;
  const std::map<std::int64_t, Evaluation>& known_;
  Mailbox<absl::StatusOr<Numbered>> mailbox_;  // finished batches, from the lanes
  int under_way_ = 0;
  Clock::time_point answered_ = Clock::now();  // last
  Clock::time_point told_ = answered_;         // of waiting, or answered
  bool can_keep_ = true;
  ThreadPool lanes_;  // last: joined before the mailbox goes
};

}  // namespace

absl::Status Run(AskTell& discovery, Evaluator& evaluator, const RunOptions& options,
                 const std::map<std::int64_t, Evaluation>& known) {
  return Loop(discovery, evaluator, options, known).Run();
}

}  // namespace mortise::pareto
