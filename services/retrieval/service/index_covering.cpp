#include "services/retrieval/service/index_covering.h"

#include <algorithm>
#include <iterator>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/host/lease_keeper.h"
#include "common/rpc/status_mapping.h"
#include "google/rpc/status.pb.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/service/cover_making.h"
#include "services/retrieval/service/cover_queue.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

constexpr absl::Duration kOwnLease = absl::Seconds(30);
constexpr absl::Duration kLook = absl::Milliseconds(500);
constexpr absl::Duration kLookForStop = absl::Milliseconds(200);

constexpr char kCancelled[] =
    "the build was cancelled; what it covered is kept, and the next build goes on from there";

}  // namespace

absl::Status IndexCovering::Run(const std::vector<v1::Template>& templates) {
  std::vector<v1::Template> asked;
  std::copy_if(templates.begin(), templates.end(), std::back_inserter(asked),
               [&](const v1::Template& head) { return plan_.IsAskedFor(head); });
  MORTISE_RETURN_IF_ERROR(building_.covers.Begin());
  const absl::Status status = Cover(asked);
  if (!status.ok() && (!context_.Cancelled() || IsGivenUp())) {
    building_.covers.CancelOthers({}).IgnoreError();
  }
  return context_.Cancelled() ? absl::CancelledError(kCancelled) : status;
}

absl::Status IndexCovering::Cover(const std::vector<v1::Template>& asked) {
  const auto total = static_cast<std::int64_t>(asked.size());
  context_.ReportProgress({.done = 0, .total = total, .message = "looking for what to cover"});
  MORTISE_RETURN_IF_ERROR(PlanAll(asked));
  std::stop_source stop;
  const std::stop_callback cancelling(context_.stop_token(), [&stop] { stop.request_stop(); });
  std::vector<std::jthread> workers;
  for (int i = 0; i < building_.threads; ++i) {
    workers.emplace_back([this, i, token = stop.get_token()] { WorkHere(i, token); });
  }
  const absl::Status status = AwaitAll(total);
  stop.request_stop();
  return status;
}

absl::Status IndexCovering::PlanAll(const std::vector<v1::Template>& asked) {
  absl::Status failed;
  ParallelFor(static_cast<int>(asked.size()), std::max(1, building_.threads), [&](int i) {
    if (context_.Cancelled()) return;
    const v1::Template& head = asked[static_cast<std::size_t>(i)];
    absl::StatusOr<std::set<std::string>> keys = plan_.Plan(head);
    const std::lock_guard lock(mutex_);
    if (failed.ok()) failed = keys.status();
    if (keys.ok()) waiting_[head.name()] = *std::move(keys);
  });
  MORTISE_RETURN_IF_ERROR(failed);
  if (context_.Cancelled()) return absl::CancelledError(kCancelled);
  std::set<std::string> keys;
  for (const auto& [name, of_template] : waiting_) {
    keys.insert(of_template.begin(), of_template.end());
  }
  // What an earlier build has left.
  return building_.covers.CancelOthers(keys);
}

std::int64_t IndexCovering::CountDone() {
  const std::lock_guard lock(mutex_);
  std::int64_t done = 0;
  for (auto& [name, keys] : waiting_) {
    std::erase_if(keys, [&](const std::string& key) { return building_.covers.HasEnded(key); });
    if (keys.empty()) ++done;
  }
  return done;
}

absl::Status IndexCovering::AwaitAll(std::int64_t total) {
  while (!context_.Cancelled()) {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t unfinished, building_.covers.CountUnfinished());
    const std::int64_t done = unfinished == 0 ? total : CountDone();
    context_.ReportProgress({.done = done, .total = total, .message = "covering templates"});
    if (unfinished == 0) return absl::OkStatus();
    building_.covers.Wait(kLook);
  }
  return absl::CancelledError(kCancelled);
}

bool IndexCovering::IsGivenUp() const {
  const auto operation = building_.environment.operations->Get(context_.name());
  return operation.ok() && operation->cancel_requested;
}

void IndexCovering::WorkHere(int number, const std::stop_token& stop) {
  const std::string worker = absl::StrCat(kOwnWorker, number);
  while (!stop.stop_requested()) {
    const auto task = building_.covers.Lease(worker, kOwnLease);
    if (!task.ok()) {
      Log(LogLevel::kWarning, "no cover can be leased", {{"error", task.status().message()}});
      rpc::Pause(kLook, stop);
    } else if (*task) {
      const TraceScope trace((*task)->trace_id());
      WorkOn(**task, stop);
    } else {
      building_.covers.Wait(kLookForStop);
    }
  }
}

void IndexCovering::WorkOn(const v1::CoverTask& task, const std::stop_token& stop) {
  CoverQueue& covers = building_.covers;
  const std::string key = task.name().substr(task.name().find('/') + 1);
  v1::ReportCoverRequest report;
  report.set_attempt(task.attempt());
  const auto fail = [&](const absl::Status& error) {
    *report.mutable_error() = rpc::ToProto(error);
    const absl::Status told = covers.Report(key, report, kOwnLease);
    if (told.ok()) return;
    Log(LogLevel::kInfo, "a task is nobody's here any more",
        {{"template", task.family().template_()}, {"error", told.message()}});
  };
  rpc::LeaseKeeper keeper(
      {.lease = kOwnLease, .drain_time = absl::ZeroDuration()},
      {.renew = [&] { return !IsLost(covers.Renew(key, task.attempt(), kOwnLease)); },
       .give_back = [&] { fail(absl::CancelledError("the service gives it back")); }},
      stop);
  const absl::Status made =
      MakeCovers(task, building_.templates,
                 rpc::OwnOrigin(building_.environment.signer, rpc::Role::kViewer, task.trace_id(),
                                kCatalogTimeout),
                 keeper.stop_token(), [&](CoverFile file, bool last) -> absl::Status {
                   if (!file.bytes.empty()) {
                     MORTISE_ASSIGN_OR_RETURN(*file.made.mutable_sha256(),
                                              StoreCoverFile(*building_.blobs, file.bytes));
                   }
                   *report.mutable_cover() = std::move(file.made);
                   report.set_last(last);
                   return covers.Report(key, report, kOwnLease);
                 });
  if (!made.ok() && !keeper.lost()) fail(made);
}

}  // namespace mortise::retrieval
