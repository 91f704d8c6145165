#include "services/simulator/service/simulator_service.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/host/chunk_stream.h"
#include "common/resources/record_page.h"
#include "common/rpc/handler.h"
#include "common/store/blob_upkeep.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "services/simulator/service/analysis_operation.h"
#include "services/simulator/service/evaluator_service.h"
#include "services/simulator/service/file_upkeep.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/service/task_queue.h"
#include "services/simulator/worker/mesh_case.h"

namespace mortise::simulator {
namespace {

constexpr int64_t kBlobLimit = int64_t{1} << 30;

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
        upkeep_(FileUpkeep::Start(environment)),
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
          task.set_trace_id(call.identity().trace_id);
          return StartAnalysis(*operations_, task, call, transaction);
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
          // Touched, so that it stays until the operation, which names it, is there.
          const absl::Status there = store::TouchBlob(*blobs_, asked.mesh_file());
          if (!there.ok()) {
            return InvalidField("mesh_file", absl::IsNotFound(there)
                                                 ? "has not been uploaded"
                                                 : "must be 64 lower-case hexadecimal digits");
          }
          return PrepareMeshAnalysis(*core_, asked, rpc::ForwardedFrom(call));
        },
        [this](const rpc::Call& call, const v1::AnalyzeMeshRequest&, v1::Task& task,
               store::Transaction& transaction) {
          task.set_trace_id(call.identity().trace_id);
          return StartAnalysis(*operations_, task, call, transaction);
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
                                  return simulator::LeaseTasks(*core_, call, asked,
                                                               std::move(respond));
                                });
  }

  grpc::ServerUnaryReactor* RenewLeases(grpc::CallbackServerContext* context,
                                        const v1::RenewLeasesRequest* request,
                                        v1::RenewLeasesResponse* response) override {
    return endpoint_.Query("RenewLeases", context, request, response,
                           [this](const rpc::Call&, const v1::RenewLeasesRequest& asked) {
                             return simulator::RenewLeases(*core_, asked);
                           });
  }

  grpc::ServerUnaryReactor* ReportTask(grpc::CallbackServerContext* context,
                                       const v1::ReportTaskRequest* request,
                                       v1::ReportTaskResponse* response) override {
    const auto report = [this](const rpc::Call&, const v1::ReportTaskRequest& asked) {
      return simulator::ReportTask(*core_, *blobs_, asked);
    };
    // A report is read even where its numbers are not finite: whoever waits for the task shall hear
    // of it at once, not when the worker's lease has run out.
    return endpoint_.Query(
        "ReportTask", context, request, response, report,
        [report](const rpc::Call& call, const v1::ReportTaskRequest& asked) -> absl::Status {
          return report(call, asked).status();
        });
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
    return endpoint_.Query("GetQueueStatus", context, request, response,
                           [this](const rpc::Call&, const v1::GetQueueStatusRequest& asked) {
                             return simulator::GetQueueStatus(*core_, asked);
                           });
  }

  grpc::ServerUnaryReactor* ListTasks(grpc::CallbackServerContext* context,
                                      const v1::ListTasksRequest* request,
                                      v1::ListTasksResponse* response) override {
    return endpoint_.Query("ListTasks", context, request, response,
                           [this](const rpc::Call&, const v1::ListTasksRequest& asked) {
                             return simulator::ListTasks(*core_, asked);
                           });
  }

 private:
  absl::StatusOr<v1::Analysis> FindAnalysis(const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(const std::string id, ParseResourceName(name, "analyses", "name"));
    return ReadAnalysis(*store_, id);
  }

  absl::StatusOr<v1::ListAnalysesResponse> List(const v1::ListAnalysesRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
    resources::Page<v1::Analysis> page;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& read) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(page,
                               resources::ReadPage<v1::Analysis>(
                                   read, {.kind = kAnalysisKind, .newest_first = true}, query));
      return absl::OkStatus();
    }));
    v1::ListAnalysesResponse response;
    for (v1::Analysis& analysis : page.entries) *response.add_analyses() = std::move(analysis);
    response.set_next_page_token(page.next_page_token);
    return response;
  }

  const std::shared_ptr<SimulatorCore> core_;
  store::Store* const store_;
  store::BlobFolder* const blobs_;
  jobs::Operations* const operations_;
  const std::shared_ptr<FileUpkeep> upkeep_;
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
