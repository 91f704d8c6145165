#include "services/simulator/simulator_service.h"

#include <algorithm>
#include <mutex>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/rpc/channel.h"
#include "common/rpc/chunk_stream.h"
#include "common/rpc/dispatcher.h"
#include "common/rpc/handler.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "services/simulator/analysis_operation.h"
#include "services/simulator/evaluator_service.h"
#include "services/simulator/mesh_case.h"
#include "services/simulator/simulator_core.h"
#include "services/simulator/task_codec.h"

namespace mortise::simulator {
namespace {

constexpr int64_t kBlobLimit = int64_t{1} << 30;
constexpr std::size_t kLongestTaskKey = 128;
constexpr int kMostRenewals = 1000;  // leases in one call
// Pages of lists end here, full or not: messages hold 4 MiB, and one result less than 3 MB.
constexpr std::size_t kPageBytes = 1'000'000;

// `seconds`, or `otherwise` for 0; INVALID_ARGUMENT naming `field` outside the range.
absl::StatusOr<absl::Duration> Seconds(double seconds, double otherwise, double minimum,
                                       double maximum, const char* field) {
  if (seconds == 0) seconds = otherwise;
  if (seconds >= minimum && seconds <= maximum) return absl::Seconds(seconds);
  return InvalidField(field, absl::StrCat("must be within ", minimum, " to ", maximum));
}

absl::StatusOr<int> PageSize(int asked) {
  if (asked == 0) return 100;
  if (asked < 1 || asked > 1000) return InvalidField("page_size", "must be within 1 to 1000");
  return asked;
}

// The queue named by a request; ours if none is.
absl::StatusOr<std::string> QueueName(const std::string& evaluator) {
  if (evaluator.empty()) return std::string(kSimulatorQueue);
  if (IsResourceId(evaluator)) return evaluator;
  return InvalidField("evaluator", "must be letters, digits and hyphens");
}

// Digests, and operations' identifiers with a prefix.
bool IsTaskKey(const std::string& key) {
  return !key.empty() && key.size() <= kLongestTaskKey &&
         std::all_of(key.begin(), key.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
         });
}

absl::StatusOr<std::string> TaskKey(const std::string& name, const std::string& field) {
  if (absl::StartsWith(name, "tasks/") && IsTaskKey(name.substr(6))) return name.substr(6);
  return InvalidField(field, "must have the form tasks/{id}");
}

absl::Status CheckAttempt(int attempt, const std::string& field) {
  if (attempt >= 1) return absl::OkStatus();
  return InvalidField(field, "must be at least 1, as leased");
}

// Receives a blob.
class BlobReader final : public rpc::UploadReader<v1::Chunk, v1::UploadBlobResponse> {
 public:
  explicit BlobReader(store::BlobFolder* blobs) : assembler_(blobs, kBlobLimit) {}

  absl::Status OnMessage(const v1::Chunk& chunk) override { return assembler_.Append(chunk); }

  absl::StatusOr<v1::UploadBlobResponse> Complete() override {
    v1::UploadBlobResponse response;
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sha256(), assembler_.Finish());
    return response;
  }

 private:
  rpc::ChunkAssembler assembler_;
};

class SimulatorAdapter final : public v1::SimulatorService::CallbackService {
 public:
  SimulatorAdapter(const rpc::ServiceEnvironment& environment,
                   const std::shared_ptr<SimulatorCore>& core, store::BlobFolder* blobs)
      : core_(core),
        store_(environment.store),
        blobs_(blobs),
        operations_(environment.operations),
        endpoint_(environment.dispatcher, "mortise.v1.SimulatorService") {}

  grpc::ServerUnaryReactor* AnalyzeDesign(grpc::CallbackServerContext* context,
                                          const v1::AnalyzeDesignRequest* request,
                                          v1::Operation* response) override {
    return endpoint_.PreparedMutation(
        "AnalyzeDesign", context, request, response,
        [this](const rpc::Call& call, const v1::AnalyzeDesignRequest& asked) {
          return PrepareAnalysis(*core_, asked, rpc::ForwardedFrom(call));
        },
        [this](const rpc::Call& call, const v1::AnalyzeDesignRequest&, v1::Task& task,
               store::Transaction& transaction) {
          task.set_trace_id(call.identity().request_id);
          return StartAnalysis(*operations_, task, call.identity(), transaction);
        });
  }

  grpc::ServerUnaryReactor* AnalyzeMesh(grpc::CallbackServerContext* context,
                                        const v1::AnalyzeMeshRequest* request,
                                        v1::Operation* response) override {
    return endpoint_.PreparedMutation(
        "AnalyzeMesh", context, request, response,
        [this](const rpc::Call& call,
               const v1::AnalyzeMeshRequest& asked) -> absl::StatusOr<v1::Task> {
          MORTISE_RETURN_IF_ERROR(CheckMeshCase(asked.case_(), "case"));
          const absl::Status there = blobs_->Size(asked.mesh_file()).status();
          if (!there.ok()) {
            return InvalidField("mesh_file", absl::IsNotFound(there)
                                                 ? "has not been uploaded"
                                                 : "must be 64 lower-case hexadecimal digits");
          }
          return PrepareMeshAnalysis(*core_, asked, rpc::ForwardedFrom(call));
        },
        [this](const rpc::Call& call, const v1::AnalyzeMeshRequest&, v1::Task& task,
               store::Transaction& transaction) {
          task.set_trace_id(call.identity().request_id);
          return StartAnalysis(*operations_, task, call.identity(), transaction);
        });
  }

  grpc::ServerUnaryReactor* GetAnalysis(grpc::CallbackServerContext* context,
                                        const v1::GetAnalysisRequest* request,
                                        v1::Analysis* response) override {
    return endpoint_.Query("GetAnalysis", context, request, response,
                           [this](const rpc::Call&, const v1::GetAnalysisRequest& asked) {
                             return FindAnalysis(asked.name());
                           });
  }

  grpc::ServerUnaryReactor* ListAnalyses(grpc::CallbackServerContext* context,
                                         const v1::ListAnalysesRequest* request,
                                         v1::ListAnalysesResponse* response) override {
    return endpoint_.Query(
        "ListAnalyses", context, request, response,
        [this](const rpc::Call&, const v1::ListAnalysesRequest& asked) { return List(asked); });
  }

  grpc::ServerWriteReactor<v1::Chunk>* DownloadArtifact(
      grpc::CallbackServerContext* context, const v1::DownloadArtifactRequest* request) override {
    return endpoint_.ServerStream<v1::Chunk>(
        "DownloadArtifact", context, request,
        [this](const rpc::Call&, const v1::DownloadArtifactRequest& asked,
               const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(const v1::Analysis analysis, FindAnalysis(asked.name()));
          return rpc::StreamArtifact(blobs_, asked.name(), analysis.artifacts(), asked.file_name(),
                                     writer);
        });
  }

  grpc::ServerUnaryReactor* LeaseTasks(grpc::CallbackServerContext* context,
                                       const v1::LeaseTasksRequest* request,
                                       v1::LeaseTasksResponse* response) override {
    return endpoint_.AsyncQuery("LeaseTasks", context, request, response,
                                [this](const rpc::Call& call, const v1::LeaseTasksRequest& asked,
                                       rpc::Responder<v1::LeaseTasksResponse> respond) {
                                  return Lease(call, asked, std::move(respond));
                                });
  }

  grpc::ServerUnaryReactor* RenewLeases(grpc::CallbackServerContext* context,
                                        const v1::RenewLeasesRequest* request,
                                        v1::RenewLeasesResponse* response) override {
    return endpoint_.Query(
        "RenewLeases", context, request, response,
        [this](const rpc::Call&, const v1::RenewLeasesRequest& asked) { return Renew(asked); });
  }

  grpc::ServerUnaryReactor* ReportTask(grpc::CallbackServerContext* context,
                                       const v1::ReportTaskRequest* request,
                                       v1::ReportTaskResponse* response) override {
    return endpoint_.Query(
        "ReportTask", context, request, response,
        [this](const rpc::Call&, const v1::ReportTaskRequest& asked) { return Report(asked); });
  }

  grpc::ServerReadReactor<v1::Chunk>* UploadBlob(grpc::CallbackServerContext* context,
                                                 v1::UploadBlobResponse* response) override {
    using Reader = rpc::UploadReader<v1::Chunk, v1::UploadBlobResponse>;
    return endpoint_.Upload<v1::Chunk, v1::UploadBlobResponse>(
        "UploadBlob", context, response,
        [this](const rpc::Call&) -> absl::StatusOr<std::unique_ptr<Reader>> {
          return std::make_unique<BlobReader>(blobs_);
        });
  }

  grpc::ServerWriteReactor<v1::Chunk>* DownloadBlob(
      grpc::CallbackServerContext* context, const v1::DownloadBlobRequest* request) override {
    return endpoint_.ServerStream<v1::Chunk>(
        "DownloadBlob", context, request,
        [this](const rpc::Call&, const v1::DownloadBlobRequest& asked,
               const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) -> absl::Status {
          const absl::Status there = blobs_->Size(asked.sha256()).status();
          if (absl::IsInvalidArgument(there)) {
            return InvalidField("sha256", "must be 64 lower-case hexadecimal digits");
          }
          MORTISE_RETURN_IF_ERROR(there);
          rpc::StreamBlob(blobs_, asked.sha256(), {asked.sha256(), "application/octet-stream"},
                          writer);
          return absl::OkStatus();
        });
  }

  grpc::ServerUnaryReactor* GetQueueStatus(grpc::CallbackServerContext* context,
                                           const v1::GetQueueStatusRequest* request,
                                           v1::QueueStatus* response) override {
    return endpoint_.Query(
        "GetQueueStatus", context, request, response,
        [this](const rpc::Call&, const v1::GetQueueStatusRequest& asked) { return Depth(asked); });
  }

  grpc::ServerUnaryReactor* ListTasks(grpc::CallbackServerContext* context,
                                      const v1::ListTasksRequest* request,
                                      v1::ListTasksResponse* response) override {
    return endpoint_.Query(
        "ListTasks", context, request, response,
        [this](const rpc::Call&, const v1::ListTasksRequest& asked) { return List(asked); });
  }

 private:
  absl::StatusOr<v1::Analysis> FindAnalysis(const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, "analyses", "name"));
    return ReadAnalysis(*store_, id);
  }

  absl::StatusOr<v1::ListAnalysesResponse> List(const v1::ListAnalysesRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(const int size, PageSize(asked.page_size()));
    if (!asked.page_token().empty() && !IsResourceId(asked.page_token())) {
      return InvalidField("page_token", "is not one that this method gave");
    }
    v1::ListAnalysesResponse response;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& read) -> absl::Status {
      response.Clear();
      MORTISE_ASSIGN_OR_RETURN(
          const auto records,
          read.List(kAnalysisKind,
                    {.after_key = asked.page_token(), .limit = size, .descending = true}));
      std::size_t bytes = 0;
      for (const store::Record& record : records) {
        response.add_analyses()->ParseFromString(record.payload);
        bytes += record.payload.size();
        if (bytes < kPageBytes) continue;
        response.set_next_page_token(record.key);
        return absl::OkStatus();
      }
      if (static_cast<int>(records.size()) == size) {
        response.set_next_page_token(records.back().key);
      }
      return absl::OkStatus();
    }));
    return response;
  }

  absl::Status Lease(const rpc::Call& call, const v1::LeaseTasksRequest& asked,
                     rpc::Responder<v1::LeaseTasksResponse> respond) {
    MORTISE_ASSIGN_OR_RETURN(const std::string queue, QueueName(asked.evaluator()));
    if (asked.worker().empty()) return InvalidField("worker", "must name the worker");
    if (asked.limit() < 1 || asked.limit() > 16) {
      return InvalidField("limit", "must be within 1 to 16");
    }
    MORTISE_ASSIGN_OR_RETURN(const absl::Duration lease,
                             Seconds(asked.lease_seconds(), 30, 1, 3600, "lease_seconds"));
    MORTISE_ASSIGN_OR_RETURN(const absl::Duration wait,
                             Seconds(asked.wait_seconds(), 0, 0, 60, "wait_seconds"));
    const absl::Time deadline = absl::Now() + wait;
    // Answered once: by tasks, by the end of the wait, or because the caller has gone.
    struct Waiting {
      std::mutex mutex;
      bool answered = false;
      rpc::Responder<v1::LeaseTasksResponse> respond;
    };
    auto waiting = std::make_shared<Waiting>();
    waiting->respond = std::move(respond);
    call.OnStop([waiting] {
      const std::lock_guard lock(waiting->mutex);
      if (std::exchange(waiting->answered, true)) return;
      waiting->respond(v1::LeaseTasksResponse());
    });
    core_->WhenWork([core = core_.get(), waiting, queue, worker = asked.worker(),
                     limit = asked.limit(), lease, deadline, call] {
      const std::lock_guard lock(waiting->mutex);
      if (waiting->answered) return true;
      if (call.cancelled()) return false;
      const auto tasks = core->Lease(queue, worker, limit, lease);
      if (tasks.ok() && tasks->empty() && absl::Now() < deadline) return false;
      waiting->answered = true;
      if (tasks.ok()) {
        v1::LeaseTasksResponse response;
        for (const store::Task& task : *tasks) *response.add_tasks() = ToProto(task);
        waiting->respond(response);
      } else {
        waiting->respond(tasks.status());
      }
      return true;
    });
    return absl::OkStatus();
  }

  absl::StatusOr<v1::RenewLeasesResponse> Renew(const v1::RenewLeasesRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(const absl::Duration lease,
                             Seconds(asked.lease_seconds(), 30, 1, 3600, "lease_seconds"));
    if (asked.tasks_size() > kMostRenewals) {
      return InvalidField("tasks", absl::StrCat("has more than ", kMostRenewals, " entries"));
    }
    v1::RenewLeasesResponse response;
    for (int i = 0; i < asked.tasks_size(); ++i) {
      const v1::TaskAttempt& attempt = asked.tasks(i);
      MORTISE_ASSIGN_OR_RETURN(const std::string key,
                               TaskKey(attempt.name(), absl::StrCat("tasks[", i, "].name")));
      MORTISE_RETURN_IF_ERROR(
          CheckAttempt(attempt.attempt(), absl::StrCat("tasks[", i, "].attempt")));
      const absl::Status status = store_->Transact(
          [&](store::Transaction& transaction) {
            return transaction.RenewLease(kSimulatorQueue, key, attempt.attempt(), lease);
          },
          store::Isolation::kReadCommitted);
      if (absl::IsAborted(status) || absl::IsFailedPrecondition(status) ||
          absl::IsNotFound(status)) {
        response.add_lost(attempt.name());
      } else if (!status.ok()) {
        return status;
      }
    }
    return response;
  }

  // What a worker says of its attempt becomes the task's end, or its next try.
  absl::StatusOr<v1::ReportTaskResponse> Report(const v1::ReportTaskRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(const std::string key, TaskKey(asked.task().name(), "task.name"));
    MORTISE_RETURN_IF_ERROR(CheckAttempt(asked.task().attempt(), "task.attempt"));
    for (int i = 0; i < asked.analysis().artifacts_size(); ++i) {
      const absl::Status there = blobs_->Size(asked.analysis().artifacts(i).sha256()).status();
      if (!there.ok()) {
        return InvalidField(absl::StrCat("analysis.artifacts[", i, "].sha256"),
                            "has not been uploaded");
      }
    }
    const int64_t attempt = asked.task().attempt();
    store::Task task;
    MORTISE_RETURN_IF_ERROR(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_RETURN_IF_ERROR(Settle(asked, key, attempt, transaction));
      MORTISE_ASSIGN_OR_RETURN(task, transaction.GetTask(kSimulatorQueue, key));
      return absl::OkStatus();
    }));
    if (IsFinished(task)) {
      core_->waiters().Notify(task, false);
    } else {
      core_->WakeWorkers();
    }
    return v1::ReportTaskResponse();
  }

  static absl::Status Settle(const v1::ReportTaskRequest& asked, const std::string& key,
                             int64_t attempt, store::Transaction& transaction) {
    if (!asked.result().has_error()) {
      return transaction.CompleteTask(kSimulatorQueue, key, attempt, asked.SerializeAsString());
    }
    const absl::Status failure = rpc::FromProto(asked.result().error());
    if (failure.ok()) return InvalidField("result.error", "must have a code other than OK");
    // A worker that ends gives its work back unharmed.
    if (absl::IsCancelled(failure)) return transaction.ReleaseTask(kSimulatorQueue, key, attempt);
    return transaction.FailTask(kSimulatorQueue, key, attempt, EncodeError(failure),
                                IsTransient(failure), absl::Seconds(1));
  }

  absl::StatusOr<v1::QueueStatus> Depth(const v1::GetQueueStatusRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(const std::string queue, QueueName(asked.evaluator()));
    store::QueueDepth depth;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& read) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(depth, read.Depth(queue));
      return absl::OkStatus();
    }));
    v1::QueueStatus status;
    status.set_queued(depth.queued);
    status.set_leased(depth.leased);
    status.set_done(depth.succeeded + depth.failed);
    status.set_quarantined(depth.quarantined);
    return status;
  }

  absl::StatusOr<v1::ListTasksResponse> List(const v1::ListTasksRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(const std::string queue, QueueName(asked.evaluator()));
    MORTISE_ASSIGN_OR_RETURN(const std::size_t size, PageSize(asked.page_size()));
    if (!asked.page_token().empty() && !IsTaskKey(asked.page_token())) {
      return InvalidField("page_token", "is not one that this method gave");
    }
    v1::ListTasksResponse response;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& read) -> absl::Status {
      response.Clear();
      std::string after = asked.page_token();
      std::size_t bytes = 0;
      // The store lists by key; states are picked out here, page by page.
      while (static_cast<std::size_t>(response.tasks_size()) < size) {
        MORTISE_ASSIGN_OR_RETURN(const auto tasks,
                                 read.ListTasks(queue, {.after_key = after, .limit = 1000}));
        for (const store::Task& task : tasks) {
          after = task.key;
          const v1::Task message = ToProto(task);
          if (asked.state() != v1::TASK_STATE_UNSPECIFIED && message.state() != asked.state()) {
            continue;
          }
          auto* entry = response.add_tasks();
          *entry->mutable_task() = message;
          if (const absl::Status error = TaskError(task); IsFinished(task) && !error.ok()) {
            *entry->mutable_error() = rpc::ToProto(error);
          }
          bytes += entry->ByteSizeLong();
          if (static_cast<std::size_t>(response.tasks_size()) == size || bytes >= kPageBytes) {
            response.set_next_page_token(after);
            return absl::OkStatus();
          }
        }
        if (tasks.size() < 1000) return absl::OkStatus();
      }
      return absl::OkStatus();
    }));
    return response;
  }

  const std::shared_ptr<SimulatorCore> core_;
  store::Store* const store_;
  store::BlobFolder* const blobs_;
  jobs::Operations* const operations_;
  rpc::Endpoint endpoint_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<SimulatorCore> core,
                           SimulatorCore::Create(environment));
  MORTISE_ASSIGN_OR_RETURN(store::BlobFolder* const blobs, environment.store->Blobs());
  RegisterAnalysis(*environment.operations, core);
  return std::vector<std::shared_ptr<grpc::Service>>{
      std::make_shared<SimulatorAdapter>(environment, core, blobs), MakeEvaluatorService(core)};
}

}  // namespace mortise::simulator
