#include "services/composer/service/model_change.h"

#include "common/base/errors.h"
#include "common/host/call_author.h"
#include "services/composer/records/drawing_records.h"

namespace mortise::composer {

absl::StatusOr<v1::Model> StoreChange(store::Transaction& transaction, const ModelChange& change,
                                      const rpc::Call& call) {
  if (change.preview) {
    MORTISE_RETURN_IF_ERROR(
        ReadModelAt(transaction, change.seen.name(), change.seen.revision()).status());
    return ShownModel({change.seen, change.state});
  }
  for (const std::shared_ptr<const Drawing>& drawing : change.drawings) {
    MORTISE_RETURN_IF_ERROR(PutDrawing(transaction, change.seen.name(), *drawing));
  }
  MORTISE_ASSIGN_OR_RETURN(const StoredModel stored, AddStep(transaction, change.seen, change.state,
                                                             change.step, rpc::AuthorOf(call)));
  return ShownModel(stored);
}

}  // namespace mortise::composer
