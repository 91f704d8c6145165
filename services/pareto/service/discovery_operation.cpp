// The handler of discovery operations.
#include "services/pareto/service/discovery_operation.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/evaluation/described_design_space.h"
#include "common/host/operation_codec.h"
#include "common/resources/resource_tags.h"
#include "common/rpc/channel.h"
#include "common/store/store.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/discovery/combined_discovery.h"
#include "services/pareto/discovery/discovery_run.h"
#include "services/pareto/discovery/robust_evaluator.h"
#include "services/pareto/service/discovery_failures.h"
#include "services/pareto/service/discovery_problem.h"
#include "services/pareto/service/discovery_request.h"
#include "services/pareto/service/discovery_start.h"
#include "services/pareto/service/front_message.h"
#include "services/pareto/service/front_records.h"
#include "services/pareto/service/remote_evaluator.h"

namespace mortise::pareto {
namespace {

constexpr char kResultKind[] = "discoveryResults";
constexpr int kPage = 1000;
constexpr absl::Duration kDescribePatience = absl::Minutes(10);
constexpr absl::Duration kTrialPatience = absl::Minutes(10);
constexpr int kMaxLanes = 16;

class DiscoveryRun {
 public:
  DiscoveryRun(rpc::ServiceEnvironment& environment, operations::OperationContext& context)
      : environment_(environment),
        context_(context),
        id_(context.name().substr(context.name().rfind('/') + 1)) {}

  absl::StatusOr<std::string> Run() {
    MORTISE_ASSIGN_OR_RETURN(std::string finished, FinishedBefore());
    if (!finished.empty()) return finished;
    MORTISE_ASSIGN_OR_RETURN(request_, ReadDiscoveryRequest(context_.name(), context_.request()));
    MORTISE_ASSIGN_OR_RETURN(auto channel, environment_.peers->Channel(kEvaluatorPeer));
    rpc::RetryOptions retry;
    retry.patience = kDescribePatience;
    retry.stop = context_.stop_token();
    MORTISE_ASSIGN_OR_RETURN(auto described, evaluation::DescribeDesignSpace(
                                                 channel, DescriptionRequest(specification()),
                                                 MakeOrigin(kDescribePatience), retry));
    MORTISE_ASSIGN_OR_RETURN(DiscoveryProblem problem, MakeProblem(specification(), *described));
    MORTISE_RETURN_IF_ERROR(LoadStart());
    problem.options.initial_designs = DesignsOf(start_);
    MORTISE_ASSIGN_OR_RETURN(
        auto discovery,
        MakeDiscovery(problem.space, problem.discrete,
                      static_cast<Eigen::Index>(problem.objectives.size()), problem.options));
    MORTISE_ASSIGN_OR_RETURN(const auto known, LoadResults());
    RemoteEvaluator evaluator(channel, specification(), problem,
                              [this](absl::Duration timeout) { return MakeOrigin(timeout); }, {});
    RobustEvaluator robust(evaluator, problem.robustness);
    RunOptions options = MakeRunOptions(problem);
    bool useless = false;
    options.judge = [&](const AskTell::Summary& summary) {
      const absl::Status verdict = Judge(channel, problem, *discovery, summary);
      useless = !verdict.ok();
      if (useless) evaluator.Interrupt();
      return verdict;
    };
    const absl::Status ended = pareto::Run(*discovery, robust, options, known);
    if (useless) return ended;
    if (!ended.ok()) return KeepLost(ended, problem, *discovery);
    return Finish(problem, *discovery);
  }

 private:
  rpc::Origin MakeOrigin(absl::Duration timeout) const {
    return rpc::OwnOrigin(environment_.signer, rpc::Role::kDesigner, CurrentTraceId(), timeout);
  }

  // The result, packed, if an earlier run wrote the front and died before it could say so.
  absl::StatusOr<std::string> FinishedBefore() {
    absl::StatusOr<v1::Front> front = kFronts.Get(*environment_.store, FrontName());
    if (absl::IsNotFound(front.status())) return "";
    MORTISE_RETURN_IF_ERROR(front.status());
    front->clear_points();
    return rpc::PackResult(*front);
  }

  // The designs settled when the discovery was asked for.
  absl::Status LoadStart() {
    if (specification().start_from().empty()) return absl::OkStatus();
    return environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(const auto record, transaction.Get(kStartKind, id_));
      if (!start_.ParseFromString(record.payload)) {
        return absl::InternalError("the stored designs to start from cannot be read");
      }
      return absl::OkStatus();
    });
  }

  const v1::DiscoverySpecification& specification() const { return request_.specification(); }

  std::string FrontName() const { return absl::StrCat("fronts/", id_); }

  std::string ResultPrefix() const { return absl::StrCat(id_, "/"); }

  absl::StatusOr<std::map<std::int64_t, Evaluation>> LoadResults() {
    std::string bytes;
    MORTISE_RETURN_IF_ERROR(
        environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
          bytes.clear();
          store::ListOptions list;
          list.key_prefix = ResultPrefix();
          list.limit = kPage;
          while (true) {
            MORTISE_ASSIGN_OR_RETURN(const auto page, transaction.List(kResultKind, list));
            for (const store::Record& record : page) bytes += record.payload;
            if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
            list.after_key = page.back().key;
          }
        }));
    MORTISE_ASSIGN_OR_RETURN(DiscoveryCheckpoint checkpoint, ParseCheckpoint(bytes));
    return std::move(checkpoint.results);
  }

  static operations::Progress ProgressOf(const DiscoveryProblem& problem,
                                         const AskTell::Summary& summary) {
    const auto each = problem.robustness.EvaluationsPerDesign();
    operations::Progress progress;
    progress.done = summary.evaluations * each;
    progress.total = problem.options.evaluations * each;
    progress.best_so_far = summary.hypervolume;
    progress.has_best = summary.cells_covered > 0;
    progress.message =
        absl::StrFormat("hypervolume %.4f, %d cells covered, %d pieces followed, %d failed",
                        summary.hypervolume, summary.cells_covered, summary.pieces, summary.failed);
    if (summary.failed > 0) {
      absl::StrAppend(&progress.message, " (", evaluation::CountsByReason(summary.failures), ")");
    }
    if (summary.violating > 0) {
      absl::StrAppend(&progress.message, ", ", summary.violating, " beyond constraints");
    }
    if (summary.combinations > 1) {
      absl::StrAppend(&progress.message, ", ", summary.combinations_tried, " of ",
                      summary.combinations, " combinations tried, ", summary.combinations_pruned,
                      " given up");
    }
    if (summary.surrogate.predictions > 0) {
      absl::StrAppendFormat(
          &progress.message, ", surrogate off by %.2g of the front (%.0f %% as it expected)",
          summary.surrogate.median_error, 100 * summary.surrogate.within_two_deviations);
    }
    if (each > 1) {
      absl::StrAppend(&progress.message, "; ", summary.evaluations, " designs of ", each,
                      " evaluations");
    }
    return progress;
  }

  RunOptions MakeRunOptions(const DiscoveryProblem& problem) {
    RunOptions options;
    options.lanes = std::clamp(problem.options.window, 1, kMaxLanes);
    options.batch_size = (problem.options.window + options.lanes - 1) / options.lanes;
    options.cancelled = [this] { return context_.Cancelled(); };
    options.progress = [this, &problem](const AskTell::Summary& summary) {
      progress_ = ProgressOf(problem, summary);
      context_.ReportProgress(progress_);
    };
    options.waiting = [this](std::chrono::seconds waited, int calls) {
      operations::Progress progress = progress_;
      progress.message = absl::StrCat(
          "waiting for ", specification().subject(), ": no answer for ", waited.count(), " s to ",
          calls, calls == 1 ? " call" : " calls", "; its workers may be busy or not running");
      if (!progress_.message.empty()) {
        absl::StrAppend(&progress.message, "; until then ", progress_.message);
      }
      context_.ReportProgress(progress);
    };
    options.checkpoint = [this](const std::vector<std::pair<std::int64_t, Evaluation>>& batch) {
      DiscoveryCheckpoint part;
      part.results.insert(batch.begin(), batch.end());
      const std::string key = absl::StrFormat("%s%012d", ResultPrefix(), batch.front().first);
      return context_.Transact([&](store::Transaction& transaction) {
        return transaction.Put(kResultKind, key, Serialize(part)).status();
      });
    };
    return options;
  }

  // Ends a discovery in which every design must fail, as all have so far.
  absl::Status Judge(const std::shared_ptr<grpc::Channel>& channel, const DiscoveryProblem& problem,
                     const AskTell& discovery, const AskTell::Summary& summary) {
    if (!MayLackSomething(discovery, summary)) return absl::OkStatus();
    if (!default_design_) TryDefault(channel, problem);
    if (!default_design_) return absl::OkStatus();
    const absl::Status verdict = JudgeSubject(specification().subject(), summary, *default_design_);
    if (!verdict.ok()) MORTISE_RETURN_IF_ERROR(ForgetResults());
    return verdict;
  }

  // An evaluator that is away is asked again after the next batch.
  void TryDefault(const std::shared_ptr<grpc::Channel>& channel, const DiscoveryProblem& problem) {
    RemoteEvaluator evaluator(channel, specification(), problem,
                              [this](absl::Duration timeout) { return MakeOrigin(timeout); },
                              {.patience = absl::ZeroDuration(), .longest_call = kTrialPatience});
    const std::stop_callback interrupt(context_.stop_token(), [&] { evaluator.Interrupt(); });
    auto tried = evaluator.Evaluate({problem.default_design});
    if (tried.ok()) default_design_ = std::move(tried->front());
  }

  // It may end before all that it was allowed to evaluate: then it is through with fewer.
  void TellEnd(const DiscoveryProblem& problem, const AskTell::Summary& summary) {
    progress_ = ProgressOf(problem, summary);
    progress_.total = progress_.done;
    context_.ReportProgress(progress_);
  }

  absl::Status ForgetResults() {
    return context_.Transact(
        [this](store::Transaction& transaction) { return DropResults(transaction); });
  }

  absl::StatusOr<std::string> Finish(const DiscoveryProblem& problem, const AskTell& discovery) {
    const bool stopped = discovery.summary().stop_reason == AskTell::StopReason::kCancelled;
    if (stopped) {
      // A shutdown, or a takeover, leaves the work to the next run.
      MORTISE_ASSIGN_OR_RETURN(const operations::Operation operation,
                               environment_.operations->Get(context_.name()));
      if (!operation.cancel_requested) return absl::CancelledError("interrupted");
    }
    const AskTell::Summary summary = discovery.summary();
    if (!stopped && summary.failed + summary.violating == summary.evaluations) {
      MORTISE_RETURN_IF_ERROR(ForgetResults());
      return NoFeasibleDesign(specification().subject(), problem, discovery);
    }
    MORTISE_ASSIGN_OR_RETURN(const std::string packed, StoreFront(problem, discovery));
    if (!stopped) {
      TellEnd(problem, summary);
      return packed;
    }
    context_.KeepResult(packed);
    return absl::CancelledError("cancelled; the front holds the best so far");
  }

  // After the evaluator was lost: the failure, with where to find what there is.
  absl::Status KeepLost(const absl::Status& lost, const DiscoveryProblem& problem,
                        const AskTell& discovery) {
    const AskTell::Summary summary = discovery.summary();
    if (absl::IsCancelled(lost) || absl::IsAborted(lost) ||
        summary.failed + summary.violating == summary.evaluations) {
      return lost;
    }
    MORTISE_RETURN_IF_ERROR(StoreFront(problem, discovery).status());
    return WithDetail(absl::Status(lost.code(), absl::StrCat(lost.message(), "; ", FrontName(),
                                                             " keeps what was found from ",
                                                             summary.evaluations, " designs")),
                      DetailOf(lost));
  }

  // The result, packed.
  absl::StatusOr<std::string> StoreFront(const DiscoveryProblem& problem,
                                         const AskTell& discovery) {
    v1::Front front = MakeFront(problem, discovery);
    front.set_name(FrontName());
    *front.mutable_specification() = specification();
    MORTISE_ASSIGN_OR_RETURN(const operations::Operation operation,
                             environment_.operations->Get(context_.name()));
    front.set_creator(operation.creator);
    resources::CopyTags(request_, &front);
    for (std::string& remark : ChangedAnswers(start_, problem, discovery.archive())) {
      front.add_remarks(std::move(remark));
    }
    MORTISE_RETURN_IF_ERROR(Store(front));
    front.clear_points();
    return rpc::PackResult(front);
  }

  absl::Status Store(v1::Front& front) {
    return context_.Transact([&](store::Transaction& transaction) -> absl::Status {
      *front.mutable_create_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
          absl::ToUnixMicros(transaction.Now()));
      MORTISE_RETURN_IF_ERROR(
          transaction.Put(kFronts.kind, id_, front.SerializeAsString()).status());
      MORTISE_RETURN_IF_ERROR(DropResults(transaction));
      store::NewEvent event;
      event.type = "front.created";
      event.subject = front.name();
      event.trace_id = CurrentTraceId();
      return transaction.AppendEvent(event);
    });
  }

  absl::Status DropResults(store::Transaction& transaction) {
    if (!specification().start_from().empty()) {
      MORTISE_RETURN_IF_ERROR(transaction.Delete(kStartKind, id_));
    }
    store::ListOptions list;
    list.key_prefix = ResultPrefix();
    list.limit = kPage;
    while (true) {
      MORTISE_ASSIGN_OR_RETURN(const auto page, transaction.List(kResultKind, list));
      if (page.empty()) return absl::OkStatus();
      for (const store::Record& record : page) {
        MORTISE_RETURN_IF_ERROR(transaction.Delete(kResultKind, record.key));
      }
    }
  }

  rpc::ServiceEnvironment& environment_;
  operations::OperationContext& context_;
  std::string id_;
  v1::DiscoverFrontRequest request_;
  v1::Front start_;                           // the designs it starts from, see discovery_start.h
  operations::Progress progress_;             // told last
  std::optional<Evaluation> default_design_;  // what became of it, once it was tried
};

}  // namespace

absl::StatusOr<std::string> RunDiscoveryOperation(rpc::ServiceEnvironment& environment,
                                                  operations::OperationContext& context) {
  return DiscoveryRun(environment, context).Run();
}

}  // namespace mortise::pareto
