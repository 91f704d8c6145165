// Answers the methods of ComposerService.
#include "services/composer/service/composer_service.h"

#include "common/base/errors.h"
#include "common/rpc/channel.h"
#include "common/rpc/method_overrides.h"
#include "common/store/store.h"
#include "mortise/v1/composer.grpc.pb.h"
#include "services/composer/service/bill_methods.h"
#include "services/composer/service/check_methods.h"
#include "services/composer/service/component_methods.h"
#include "services/composer/service/composer.h"
#include "services/composer/service/drag_methods.h"
#include "services/composer/service/model_methods.h"
#include "services/composer/service/save_methods.h"
#include "services/composer/service/suggestion_methods.h"
#include "services/composer/service/turn_methods.h"

namespace mortise::composer {
namespace {

class ComposerAdapter final : public v1::ComposerService::CallbackService {
  using Contract = v1::ComposerService::CallbackService;

 public:
  ComposerAdapter(rpc::ServiceEnvironment& environment, std::shared_ptr<grpc::Channel> catalog)
      : catalog_(std::move(catalog)),
        drawings_(environment.store),
        origins_(catalog_),
        collection_(catalog_, &origins_, &drawings_),
        composer_{environment.store,       drawings_, origins_, collection_, drags_, catalog_,
                  environment.options.name},
        endpoint_(environment.dispatcher, "mortise.v1.ComposerService") {}

  MORTISE_MUTATION(CreateModel, rpc::With(composer_, methods::CreateModel))
  MORTISE_QUERY(GetModel, rpc::With(composer_, methods::GetModel))
  MORTISE_QUERY(ListModels, rpc::With(composer_, methods::ListModels))
  MORTISE_MUTATION(UpdateModel, rpc::With(composer_, methods::UpdateModel))
  MORTISE_MUTATION(DeleteModel, rpc::With(composer_, methods::DeleteModel))
  MORTISE_MUTATION(ForkModel, rpc::With(composer_, methods::ForkModel))
  MORTISE_PREPARED_MUTATION(AddComponent, rpc::With(composer_, methods::AddComponent),
                            rpc::With(composer_, methods::KeepChange<v1::AddComponentRequest>))
  MORTISE_PREPARED_MUTATION(SnapComponent, rpc::With(composer_, methods::SnapComponent),
                            rpc::With(composer_, methods::KeepChange<v1::SnapComponentRequest>))
  MORTISE_PREPARED_MUTATION(ConnectComponent, rpc::With(composer_, methods::ConnectComponent),
                            rpc::With(composer_, methods::KeepChange<v1::ConnectComponentRequest>))
  MORTISE_PREPARED_MUTATION(MoveComponent, rpc::With(composer_, methods::MoveComponent),
                            rpc::With(composer_, methods::KeepChange<v1::MoveComponentRequest>))
  MORTISE_QUERY(GetNodeControls, rpc::With(composer_, methods::GetNodeControls))
  MORTISE_PREPARED_MUTATION(DragControl, rpc::With(composer_, methods::DragControl),
                            rpc::With(composer_, methods::KeepChange<v1::DragControlRequest>))
  MORTISE_PREPARED_MUTATION(RemoveNode, rpc::With(composer_, methods::RemoveNode),
                            rpc::With(composer_, methods::KeepChange<v1::RemoveNodeRequest>))
  MORTISE_MUTATION(UndoModel, rpc::With(composer_, methods::UndoModel))
  MORTISE_MUTATION(RedoModel, rpc::With(composer_, methods::RedoModel))
  MORTISE_PREPARED_MUTATION(SaveModel, rpc::With(composer_, methods::WriteIntoCatalog),
                            rpc::With(composer_, methods::SaveModel))
  MORTISE_QUERY(DrawModel, rpc::With(composer_, methods::DrawModel))
  MORTISE_QUERY(CheckModel, rpc::With(composer_, methods::CheckModel))
  MORTISE_QUERY(GetModelBill, rpc::With(composer_, methods::GetModelBill))
  MORTISE_QUERY(SuggestComponents, rpc::With(composer_, methods::SuggestComponents))
  MORTISE_QUERY(PreviewDrag, rpc::With(composer_, methods::PreviewDrag))
  MORTISE_QUERY(ListModelSteps, rpc::With(composer_, methods::ListModelSteps))
  MORTISE_BIDI(DragNode, rpc::With(composer_, methods::DragNode), {.endless = true})
  MORTISE_PREPARED_MUTATION(TurnComponent, rpc::With(composer_, methods::TurnComponent),
                            rpc::With(composer_, methods::KeepChange<v1::TurnComponentRequest>))

 private:
  const std::shared_ptr<grpc::Channel> catalog_;
  ModelDrawings drawings_;
  OriginSource origins_;
  CollectionConnections collection_;
  DragCache drags_;
  const Composer composer_;
  rpc::Endpoint endpoint_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment) {
  MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<grpc::Channel> catalog,
                           environment.peers->Channel("catalog"));
  return std::vector<std::shared_ptr<grpc::Service>>{
      std::make_shared<ComposerAdapter>(environment, std::move(catalog))};
}

}  // namespace mortise::composer
