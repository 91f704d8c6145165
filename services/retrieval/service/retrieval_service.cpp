// Answers the methods of RetrievalService.
#include "services/retrieval/service/retrieval_service.h"

#include "common/base/errors.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/rpc/channel.h"
#include "common/rpc/method_overrides.h"
#include "common/store/store.h"
#include "mortise/v1/retrieval.grpc.pb.h"
#include "services/retrieval/service/cover_methods.h"
#include "services/retrieval/service/cover_queue.h"
#include "services/retrieval/service/file_upkeep.h"
#include "services/retrieval/service/index_builds.h"
#include "services/retrieval/service/index_methods.h"
#include "services/retrieval/service/index_operation.h"
#include "services/retrieval/service/index_upkeep.h"
#include "services/retrieval/service/query_shape.h"
#include "services/retrieval/service/retrieval.h"
#include "services/retrieval/service/search_methods.h"

namespace mortise::retrieval {
namespace {

class RetrievalAdapter final : public v1::RetrievalService::CallbackService {
  using Contract = v1::RetrievalService::CallbackService;

 public:
  RetrievalAdapter(rpc::ServiceEnvironment& environment, store::BlobFolder* blobs,
                   std::shared_ptr<grpc::Channel> catalog, int cover_threads)
      : templates_(catalog),
        covers_(environment.store, blobs, environment.dispatcher),
        indexes_(environment.store, blobs),
        meshes_(environment.store, blobs, environment.options.blobs),
        facts_(&templates_),
        retrieval_{environment, templates_, indexes_, meshes_, facts_, covers_, blobs},
        endpoint_(environment.dispatcher, "mortise.v1.RetrievalService"),
        upkeep_(environment, std::move(catalog), templates_),
        files_(environment) {
    environment.operations->Register(
        operations::kIndexOperation,
        [this, blobs, cover_threads](operations::OperationContext& context) {
          return RunIndexOperation(
              {retrieval_.environment, templates_, blobs, covers_, cover_threads, turn_}, context);
        });
  }

  MORTISE_QUERY(SearchShapes, rpc::With(retrieval_, methods::SearchShapes))
  MORTISE_UPLOAD(UploadMesh, rpc::With(retrieval_, methods::UploadMesh))
  MORTISE_PREPARED_MUTATION(BuildIndex, rpc::With(retrieval_, methods::PrepareBuild),
                            rpc::With(retrieval_, methods::BuildIndex))
  MORTISE_PREPARED_MUTATION(DeleteIndex, rpc::With(retrieval_, methods::PrepareDeletion),
                            methods::DeleteIndex)
  MORTISE_QUERY(GetIndex, rpc::With(retrieval_, methods::GetIndex))
  MORTISE_QUERY(ListIndexFamilies, rpc::With(retrieval_, methods::ListIndexFamilies))
  MORTISE_QUERY(ListIndexes, rpc::With(retrieval_, methods::ListIndexes))

  MORTISE_ASYNC_QUERY(LeaseCover, rpc::With(retrieval_, methods::LeaseCover))
  MORTISE_QUERY(RenewCover, rpc::With(retrieval_, methods::RenewCover))
  MORTISE_UPLOAD(UploadCover, rpc::With(retrieval_, methods::UploadCover))
  MORTISE_QUERY(ReportCover, rpc::With(retrieval_, methods::ReportCover))

 private:
  TemplateSource templates_;
  CoverQueue covers_;
  LoadedIndexes indexes_;
  const UploadedMeshes meshes_;
  MatchFacts facts_;
  BuildTurn turn_;
  const Retrieval retrieval_;
  rpc::Endpoint endpoint_;
  const IndexUpkeep upkeep_;
  const FileUpkeep files_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, int cover_threads) {
  MORTISE_ASSIGN_OR_RETURN(store::BlobFolder* const blobs, environment.store->Blobs());
  MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<grpc::Channel> catalog,
                           environment.peers->Channel("catalog"));
  return std::vector<std::shared_ptr<grpc::Service>>{
      std::make_shared<RetrievalAdapter>(environment, blobs, std::move(catalog), cover_threads)};
}

}  // namespace mortise::retrieval
