#include "services/composer/service/model_methods.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/design/field_checks.h"
#include "common/design/template_validation.h"
#include "common/host/call_author.h"
#include "common/resources/resource_tags.h"
#include "services/composer/records/drawing_records.h"
#include "services/composer/records/model_history.h"
#include "services/composer/records/model_records.h"
#include "services/composer/service/model_picture.h"

namespace mortise::composer::methods {
namespace {

constexpr int kUsualWidth = 1000;  // pixels
constexpr int kMinPixels = 16;
constexpr int kMaxPixels = 4096;

absl::Status CheckNewModel(const std::string& id, const std::string& title) {
  std::vector<FieldViolation> findings;
  if (!id.empty() && !IsResourceId(id)) {
    findings.push_back({"model_id",
                        "must be 1 to 63 lower-case letters, digits and hyphens, and begin and end "
                        "with a letter or digit"});
  }
  parametric::CheckTitle("title", title, findings);
  return parametric::ToStatus(findings);
}

std::string IdFor(const std::string& wanted) { return wanted.empty() ? NewIdentifier() : wanted; }

// A mask without the title, which is no tag; whether it had it.
bool TakeTitle(google::protobuf::FieldMask& mask) {
  google::protobuf::FieldMask rest;
  bool title = false;
  for (const std::string& path : mask.paths()) {
    if (path == "title") {
      title = true;
    } else {
      rest.add_paths(path);
    }
  }
  mask = std::move(rest);
  return title;
}

// The drawings that a state needs.
std::set<std::string> DrawingsOf(const ModelState& state) {
  std::set<std::string> digests;
  if (state.has_body()) digests.insert(state.body().drawing());
  for (const LooseComponent& loose : state.loose()) {
    digests.insert(loose.design().drawing());
    digests.insert(loose.turned().drawing());
    digests.insert(loose.turned().before().drawing());
  }
  digests.erase("");
  return digests;
}

absl::StatusOr<v1::Model> Move(const rpc::Call& call, const std::string& name,
                               std::int64_t revision, HistoryMove move,
                               store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(const StoredModel moved,
                           MoveInHistory(transaction, name, revision, move, rpc::AuthorOf(call)));
  return ShownModel(moved);
}

}  // namespace

absl::StatusOr<v1::Model> CreateModel(const Composer&, const rpc::Call& call,
                                      const v1::CreateModelRequest& asked,
                                      store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(CombineViolations(CheckNewModel(asked.model_id(), asked.title()),
                                            resources::ValidateTags(asked)));
  v1::Model head;
  head.set_title(asked.title());
  resources::CopyTags(asked, &head);
  MORTISE_ASSIGN_OR_RETURN(const StoredModel made,
                           CreateRecord(transaction, IdFor(asked.model_id()), std::move(head),
                                        ModelState(), "new", rpc::AuthorOf(call)));
  return ShownModel(made);
}

absl::StatusOr<v1::Model> GetModel(const Composer& composer, const rpc::Call&,
                                   const v1::GetModelRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const StoredModel model, ReadModel(*composer.store, asked.name()));
  return ShownModel(model);
}

absl::StatusOr<v1::ListModelsResponse> ListModels(const Composer& composer, const rpc::Call&,
                                                  const v1::ListModelsRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(
      resources::Page<v1::Model> page,
      kModels.List(*composer.store, asked, [](const v1::Model&) { return true; }));
  return resources::ToResponse(std::move(page), &v1::ListModelsResponse::mutable_models);
}

absl::StatusOr<v1::Model> UpdateModel(const Composer&, const rpc::Call& call,
                                      const v1::UpdateModelRequest& asked,
                                      store::Transaction& transaction) {
  google::protobuf::FieldMask mask = asked.update_mask();
  const bool title = TakeTitle(mask);
  const bool only_title = title && mask.paths().empty();
  std::vector<FieldViolation> findings;
  if (title) parametric::CheckTitle("model.title", asked.model().title(), findings);
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      CombineViolations(
          ParseResourceName(asked.model().name(), kModels.names, "model.name").status(),
          resources::CheckTagMask(mask)),
      CombineViolations(UnderField("model", resources::ValidateTags(asked.model())),
                        parametric::ToStatus(findings))));
  MORTISE_ASSIGN_OR_RETURN(StoredModel model, ReadModel(transaction, asked.model().name()));
  if (title) model.head.set_title(asked.model().title());
  if (!only_title) resources::UpdateTags(asked.model(), mask, &model.head);
  MORTISE_RETURN_IF_ERROR(PutHead(transaction, model.head, rpc::AuthorOf(call)));
  return ShownModel(model);
}

absl::StatusOr<v1::DeleteModelResponse> DeleteModel(const Composer&, const rpc::Call& call,
                                                    const v1::DeleteModelRequest& asked,
                                                    store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(
      DeleteRecords(transaction, asked.name(), asked.revision(), rpc::AuthorOf(call)));
  return v1::DeleteModelResponse();
}

absl::StatusOr<v1::Model> ForkModel(const Composer&, const rpc::Call& call,
                                    const v1::ForkModelRequest& asked,
                                    store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(CheckNewModel(asked.model_id(), asked.title()));
  MORTISE_ASSIGN_OR_RETURN(StoredModel model, ReadModel(transaction, asked.name()));
  v1::Model head;
  head.set_title(asked.title().empty() ? model.head.title() : asked.title());
  MORTISE_ASSIGN_OR_RETURN(
      const StoredModel fork,
      CreateRecord(transaction, IdFor(asked.model_id()), std::move(head), model.state,
                   absl::StrCat("fork of ", asked.name()), rpc::AuthorOf(call)));
  for (const std::string& digest : DrawingsOf(model.state)) {
    MORTISE_ASSIGN_OR_RETURN(const Drawing drawing, GetDrawing(transaction, asked.name(), digest));
    MORTISE_RETURN_IF_ERROR(PutDrawing(transaction, fork.head.name(), drawing));
  }
  return ShownModel(fork);
}

absl::StatusOr<v1::Model> UndoModel(const Composer&, const rpc::Call& call,
                                    const v1::UndoModelRequest& asked,
                                    store::Transaction& transaction) {
  return Move(call, asked.name(), asked.revision(), HistoryMove::kUndo, transaction);
}

absl::StatusOr<v1::Model> RedoModel(const Composer&, const rpc::Call& call,
                                    const v1::RedoModelRequest& asked,
                                    store::Transaction& transaction) {
  return Move(call, asked.name(), asked.revision(), HistoryMove::kRedo, transaction);
}

absl::StatusOr<v1::ListModelStepsResponse> ListModelSteps(const Composer& composer,
                                                          const rpc::Call&,
                                                          const v1::ListModelStepsRequest& asked) {
  return ReadRevisions(*composer.store, asked);
}

absl::StatusOr<v1::ModelPicture> DrawModel(const Composer& composer, const rpc::Call& call,
                                           const v1::DrawModelRequest& asked) {
  const int width = asked.width() == 0 ? kUsualWidth : asked.width();
  const int height = asked.height() == 0 ? width * 3 / 4 : asked.height();
  std::vector<FieldViolation> findings;
  const auto check = [&](const char* field, int pixels) {
    if (pixels >= kMinPixels && pixels <= kMaxPixels) return;
    findings.push_back(
        {field, absl::StrCat("must be ", kMinPixels, " to ", kMaxPixels, " pixels")});
  };
  check("width", width);
  if (asked.height() != 0) check("height", height);
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  MORTISE_ASSIGN_OR_RETURN(const StoredModel stored, ReadModel(*composer.store, asked.name()));
  MORTISE_ASSIGN_OR_RETURN(const OpenModel model,
                           Open(stored, composer.drawings, [&call] { return call.cancelled(); }));
  v1::ModelPicture picture;
  picture.set_revision(stored.head.revision());
  MORTISE_ASSIGN_OR_RETURN(*picture.mutable_png(), DrawPicture(model, composer.drawings, width,
                                                               std::max(height, kMinPixels)));
  return picture;
}

}  // namespace mortise::composer::methods
