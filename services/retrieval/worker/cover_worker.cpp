#include "services/retrieval/worker/cover_worker.h"

#include <grpcpp/grpcpp.h>

#include <utility>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/host/lease_keeper.h"
#include "common/rpc/chunk_calls.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/retrieval.grpc.pb.h"
#include "services/retrieval/catalog/template_source.h"
#include "services/retrieval/service/cover_making.h"

namespace mortise::retrieval {
namespace {

using Stub = v1::RetrievalService::Stub;

constexpr absl::Duration kPatience = absl::Seconds(2);  // for a task, in one call
constexpr absl::Duration kCallTimeout = absl::Seconds(30);
constexpr absl::Duration kUploadTimeout = absl::Minutes(5);
constexpr absl::Duration kCatalogTimeout = absl::Minutes(2);
constexpr absl::Duration kReportPatience = absl::Minutes(2);

// A task that was leased, and what is said of it to the service.
class LeasedTask {
 public:
  LeasedTask(const rpc::WorkerEnvironment& environment, Stub& stub, const v1::CoverTask& task)
      : environment_(environment), stub_(stub), task_(task) {}

  // False once it is lost.
  bool Renew() const {
    v1::RenewCoverRequest request;
    request.set_task(task_.name());
    request.set_attempt(task_.attempt());
    request.set_lease_seconds(absl::ToDoubleSeconds(environment_.lease));
    const auto renewed = rpc::CallUnary<Stub, v1::RenewCoverRequest, v1::RenewCoverResponse>(
        stub_, &Stub::RenewCover, request,
        rpc::OwnOrigin(environment_.signer, rpc::Role::kDesigner, task_.trace_id(),
                       environment_.lease / 3));
    if (renewed.ok()) return !renewed->lost();
    Log(LogLevel::kWarning, "a lease was not renewed",
        {{"task", task_.name()}, {"error", renewed.status().message()}});
    // A service that begins again is to be found again while this thread waits for nothing else.
    rpc::AwaitConnection(*environment_.channels.at("retrieval"), environment_.lease / 3);
    return true;
  }

  absl::Status Report(CoverFile file, bool last) const {
    rpc::AwaitConnection(*environment_.channels.at("retrieval"), kReportPatience);
    if (!file.bytes.empty()) {
      MORTISE_ASSIGN_OR_RETURN(*file.made.mutable_sha256(), Upload(file.bytes));
    }
    v1::ReportCoverRequest report;
    *report.mutable_cover() = std::move(file.made);
    report.set_last(last);
    return Send(std::move(report));
  }

  // Says that there will be no cover, and why.
  void Fail(const absl::Status& error) const {
    v1::ReportCoverRequest report;
    *report.mutable_error() = rpc::ToProto(error);
    const absl::Status sent = Send(std::move(report));
    Log(sent.ok() ? LogLevel::kInfo : LogLevel::kWarning,
        sent.ok() ? "reported that there is no cover" : "a report was refused",
        {{"task", task_.name()},
         {"attempt", task_.attempt()},
         {"error", sent.ok() ? error.message() : sent.message()}});
  }

 private:
  absl::StatusOr<std::string> Upload(const std::string& bytes) const {
    v1::UploadCoverResponse response;
    const rpc::Origin origin =
        rpc::OwnOrigin(environment_.signer, rpc::Role::kDesigner, task_.trace_id(), kUploadTimeout);
    MORTISE_RETURN_IF_ERROR(rpc::CallWithRetry(
        origin, {.patience = kReportPatience}, [&](grpc::ClientContext* context) {
          response.Clear();
          const auto writer = stub_.UploadCover(context, &response);
          rpc::SendChunks(bytes, *writer);
          return writer->Finish();
        }));
    return response.sha256();
  }

  absl::Status Send(v1::ReportCoverRequest report) const {
    report.set_task(task_.name());
    report.set_attempt(task_.attempt());
    report.set_lease_seconds(absl::ToDoubleSeconds(environment_.lease));
    return rpc::CallUnary<Stub, v1::ReportCoverRequest, v1::ReportCoverResponse>(
               stub_, &Stub::ReportCover, report,
               rpc::OwnOrigin(environment_.signer, rpc::Role::kDesigner, task_.trace_id(),
                              kReportPatience),
               {.patience = kReportPatience})
        .status();
  }

  const rpc::WorkerEnvironment& environment_;
  Stub& stub_;
  const v1::CoverTask& task_;
};

void WorkOn(const rpc::WorkerEnvironment& environment, Stub& stub, TemplateSource& templates,
            const v1::CoverTask& task, const std::stop_token& ending) {
  const TraceScope trace(task.trace_id());
  const absl::Time start = absl::Now();
  const LeasedTask leased(environment, stub, task);
  rpc::LeaseKeeper keeper(
      {.lease = environment.lease,
       .drain_time = environment.drain_time,
       .break_off = environment.break_off},
      {.renew = [&] { return leased.Renew(); },
       .give_back = [&] { leased.Fail(absl::CancelledError("the worker gives it back")); }},
      ending);
  const absl::Status made = MakeCovers(
      task, templates,
      rpc::OwnOrigin(environment.signer, rpc::Role::kViewer, task.trace_id(), kCatalogTimeout),
      keeper.stop_token(), [&](CoverFile file, bool last) -> absl::Status {
        if (keeper.lost()) return absl::CancelledError("the task is somebody else's");
        return leased.Report(std::move(file), last);
      });
  if (!made.ok() && !keeper.lost()) leased.Fail(made);
  Log(LogLevel::kInfo, made.ok() ? "covers reported" : "a task ended without all of its covers",
      {{"task", task.name()},
       {"template", task.family().template_()},
       {"group", task.family().group()},
       {"seconds", absl::ToDoubleSeconds(absl::Now() - start)},
       {"error", made.message()}});
}

}  // namespace

void RunCoverWorker(const rpc::WorkerEnvironment& environment, const std::stop_token& stop) {
  const std::shared_ptr<grpc::Channel>& channel = environment.channels.at("retrieval");
  const auto stub = v1::RetrievalService::NewStub(channel);
  TemplateSource templates(environment.channels.at("catalog"));
  v1::LeaseCoverRequest request;
  request.set_worker(environment.name);
  request.set_cover_version(kCoverVersion);
  request.set_lease_seconds(absl::ToDoubleSeconds(environment.lease));
  request.set_wait_seconds(absl::ToDoubleSeconds(kPatience));
  while (rpc::AwaitConnection(*channel, stop)) {
    const auto leased = rpc::CallUnary<Stub, v1::LeaseCoverRequest, v1::LeaseCoverResponse>(
        *stub, &Stub::LeaseCover, request,
        rpc::OwnOrigin(environment.signer, rpc::Role::kDesigner, "", kPatience + kCallTimeout),
        {.stop = stop});
    if (leased.ok()) {
      if (leased->has_task()) WorkOn(environment, *stub, templates, leased->task(), stop);
      continue;
    }
    if (stop.stop_requested()) break;
    Log(LogLevel::kWarning, "no cover can be leased", {{"error", leased.status().message()}});
    // Refusals come at once; a worker that cannot work must not flood the service.
    if (!absl::IsUnavailable(leased.status())) rpc::Pause(absl::Seconds(1), stop);
  }
}

}  // namespace mortise::retrieval
