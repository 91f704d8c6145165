// From the methods of SimulatorService to what answers them.
#include "services/simulator/service/simulator_service.h"

#include "common/base/errors.h"
#include "common/host/file_quota.h"
#include "common/rpc/method_overrides.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "services/simulator/service/analysis_methods.h"
#include "services/simulator/service/analysis_operation.h"
#include "services/simulator/service/blob_methods.h"
#include "services/simulator/service/evaluator_service.h"
#include "services/simulator/service/file_upkeep.h"
#include "services/simulator/service/simulator.h"
#include "services/simulator/service/simulator_core.h"
#include "services/simulator/service/task_methods.h"

namespace mortise::simulator {
namespace {

class SimulatorAdapter final : public v1::SimulatorService::CallbackService {
  using Contract = v1::SimulatorService::CallbackService;

 public:
  SimulatorAdapter(const rpc::ServiceEnvironment& environment,
                   const std::shared_ptr<SimulatorCore>& core, store::BlobFolder* blobs,
                   double file_quota)
      : core_(core),
        quota_(environment.store, environment.operations, environment.options.blobs, FilesInUse(),
               file_quota, "file-disk-quota"),
        simulator_{core.get(), blobs, &quota_, environment.operations},
        upkeep_(FileUpkeep::Start(environment)),
        endpoint_(environment.dispatcher, "mortise.v1.SimulatorService") {}

  MORTISE_PREPARED_MUTATION(AnalyzeDesign, rpc::With(simulator_, methods::PrepareDesign),
                            rpc::With(simulator_, methods::AnalyzeDesign))
  MORTISE_PREPARED_MUTATION(AnalyzeMesh, rpc::With(simulator_, methods::PrepareMesh),
                            rpc::With(simulator_, methods::AnalyzeMesh))
  MORTISE_QUERY(GetAnalysis, rpc::With(simulator_, methods::GetAnalysis))
  MORTISE_QUERY(ListAnalyses, rpc::With(simulator_, methods::ListAnalyses))
  MORTISE_MUTATION(UpdateAnalysis, methods::UpdateAnalysis)
  MORTISE_SERVER_STREAM(DownloadArtifact, rpc::With(simulator_, methods::DownloadArtifact))

  MORTISE_ASYNC_QUERY(LeaseTasks, rpc::With(simulator_, methods::LeaseTasks))
  MORTISE_QUERY(RenewLeases, rpc::With(simulator_, methods::RenewLeases))
  MORTISE_QUERY(ReportTask, rpc::With(simulator_, methods::ReportTask),
                rpc::With(simulator_, methods::RefuseReport))
  MORTISE_QUERY(GetQueueStatus, rpc::With(simulator_, methods::GetQueueStatus))
  MORTISE_QUERY(ListTasks, rpc::With(simulator_, methods::ListTasks))

  MORTISE_UPLOAD(UploadBlob, rpc::With(simulator_, methods::UploadBlob))
  MORTISE_SERVER_STREAM(DownloadBlob, rpc::With(simulator_, methods::DownloadBlob))

 private:
  const std::shared_ptr<SimulatorCore> core_;
  rpc::FileQuota quota_;
  const Simulator simulator_;
  const std::shared_ptr<FileUpkeep> upkeep_;
  rpc::Endpoint endpoint_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, double file_quota) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<SimulatorCore> core,
                           SimulatorCore::Create(environment));
  MORTISE_ASSIGN_OR_RETURN(store::BlobFolder* const blobs, environment.store->Blobs());
  RegisterAnalysis(*environment.operations, core);
  return std::vector<std::shared_ptr<grpc::Service>>{
      std::make_shared<SimulatorAdapter>(environment, core, blobs, file_quota),
      MakeEvaluatorService(core)};
}

}  // namespace mortise::simulator
