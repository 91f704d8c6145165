// From the methods of InterpolatorService to what answers them.
#include "services/interpolator/service/interpolator_service.h"

#include <string>
#include <utility>

#include "common/base/errors.h"
#include "common/operations/operation_kinds.h"
#include "common/operations/operations.h"
#include "common/rpc/method_overrides.h"
#include "common/store/store.h"
#include "mortise/v1/interpolator.grpc.pb.h"
#include "services/interpolator/records/disk_quota.h"
#include "services/interpolator/records/loaded_shapes.h"
#include "services/interpolator/service/build_methods.h"
#include "services/interpolator/service/build_operation.h"
#include "services/interpolator/service/export_methods.h"
#include "services/interpolator/service/interpolator.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/service/map_methods.h"
#include "services/interpolator/service/map_upkeep.h"
#include "services/interpolator/service/verify_operation.h"

namespace mortise::interpolator {
namespace {

class InterpolatorAdapter final : public v1::InterpolatorService::CallbackService {
  using Contract = v1::InterpolatorService::CallbackService;

 public:
  InterpolatorAdapter(rpc::ServiceEnvironment& environment, store::BlobFolder* blobs,
                      double disk_quota, std::unique_ptr<StaleUpkeep> stale)
      : loaded_(environment.store, blobs),
        shapes_(blobs),
        quota_(disk_quota, [store = environment.store] { return BytesOfMaps(*store); }),
        interpolator_{environment.store, environment.operations, environment.peers, &loaded_,
                      &shapes_},
        endpoint_(environment.dispatcher, "mortise.v1.InterpolatorService"),
        stale_(std::move(stale)),
        files_(environment) {
    environment.operations->Register(
        operations::kMapOperation, [this, &environment](operations::OperationContext& context) {
          // Its subject may have changed while it was sampled.
          return RunBuildOperation(
              environment, quota_, context,
              [this](const std::string& subject) { stale_->Notice({subject}); });
        });
    environment.operations->Register(operations::kVerificationOperation,
                                     [this, &environment](operations::OperationContext& context) {
                                       return RunVerifyOperation(environment, loaded_, shapes_,
                                                                 context);
                                     });
  }

  MORTISE_PREPARED_MUTATION(BuildMap, rpc::With(interpolator_, methods::SettleMap),
                            rpc::With(interpolator_, methods::BuildMap))
  MORTISE_QUERY(GetMap, rpc::With(interpolator_, methods::GetMap))
  MORTISE_QUERY(ListMaps, rpc::With(interpolator_, methods::ListMaps))
  MORTISE_QUERY(EvaluateMap, rpc::With(interpolator_, methods::EvaluateMap))
  MORTISE_SERVER_STREAM(ExportMap, rpc::With(interpolator_, methods::ExportMap))
  MORTISE_QUERY(EvaluateMapShape, rpc::With(interpolator_, methods::EvaluateMapShape))
  MORTISE_BIDI(FollowMapShape, rpc::With(interpolator_, methods::FollowMapShape), {.endless = true})
  MORTISE_QUERY(OptimizeMap, rpc::With(interpolator_, methods::OptimizeMap))
  MORTISE_MUTATION(VerifyMap, rpc::With(interpolator_, methods::VerifyMap))
  MORTISE_MUTATION(UpdateMap, methods::UpdateMap)
  MORTISE_MUTATION(DeleteMap, methods::DeleteMap)

 private:
  LoadedMaps loaded_;
  LoadedShapes shapes_;
  DiskQuota quota_;
  const Interpolator interpolator_;
  rpc::Endpoint endpoint_;
  const std::unique_ptr<StaleUpkeep> stale_;
  const FileUpkeep files_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, double disk_quota) {
  MORTISE_ASSIGN_OR_RETURN(store::BlobFolder* const blobs, environment.store->Blobs());
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<StaleUpkeep> stale, StaleUpkeep::Start(environment));
  return std::vector<std::shared_ptr<grpc::Service>>{
      std::make_shared<InterpolatorAdapter>(environment, blobs, disk_quota, std::move(stale))};
}

}  // namespace mortise::interpolator
