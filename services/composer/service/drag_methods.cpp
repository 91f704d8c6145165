#include "services/composer/service/drag_methods.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/composer/records/model_records.h"
#include "services/composer/service/drag_stream.h"
#include "services/composer/service/node_controls.h"
#include "services/composer/service/part_changes.h"

namespace mortise::composer::methods {

absl::StatusOr<v1::NodeControls> GetNodeControls(const Composer& composer, const rpc::Call& call,
                                                 const v1::GetNodeControlsRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const StoredModel stored, ReadModel(*composer.store, asked.name()));
  MORTISE_ASSIGN_OR_RETURN(OpenModel model,
                           Open(stored, composer.drawings, [&call] { return call.cancelled(); }));
  MORTISE_ASSIGN_OR_RETURN(const OpenDesign* const design, FindDesign(model, asked.component()));
  MORTISE_ASSIGN_OR_RETURN(auto space, composer.drags.SpaceOf(*design));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Control> controls,
                           ControlsOf(std::move(space), design->design, asked.node()));
  v1::NodeControls message;
  message.set_revision(stored.head.revision());
  for (const Control& control : controls) *message.add_controls() = ToProto(control);
  return message;
}

absl::StatusOr<ModelChange> DragControl(const Composer& composer, const rpc::Call& call,
                                        const v1::DragControlRequest& asked) {
  MORTISE_RETURN_IF_ERROR(ParseControl(asked.control()).status());
  MORTISE_ASSIGN_OR_RETURN(ModelAtWork at_work, OpenFor(composer, call, asked));
  MORTISE_ASSIGN_OR_RETURN(OpenDesign* const design, FindDesign(at_work.model, asked.component()));
  MORTISE_ASSIGN_OR_RETURN(
      NodeDrag drag,
      composer.drags.Begin(*design, {asked.component(), asked.node(), asked.control()}));
  MORTISE_ASSIGN_OR_RETURN(design->design, drag.To(asked.value()));
  if (!asked.component().empty()) SetPlaced(at_work.model, asked.component());
  const std::string& what = asked.node().empty() ? asked.component() : asked.node();
  return at_work.Done(
      absl::StrCat("drag ", asked.control(), what.empty() ? "" : absl::StrCat(" of ", what)));
}

absl::StatusOr<v1::DragPreview> PreviewDrag(const Composer& composer, const rpc::Call& call,
                                            const v1::PreviewDragRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<OpenDrag> drag,
                           FindDrag(composer, call, asked.name(), asked.revision(),
                                    {asked.component(), asked.node(), asked.control()}));
  std::vector<v1::ModelPart> before = drag->stored();
  if (asked.has_since_value()) {
    MORTISE_ASSIGN_OR_RETURN(OpenDrag::Dragged since, drag->To(asked.since_value()));
    before = std::move(since.parts);
  }
  MORTISE_ASSIGN_OR_RETURN(const OpenDrag::Dragged there, drag->To(asked.value()));
  v1::DragPreview preview;
  preview.set_revision(asked.revision());
  preview.set_value(asked.value());
  preview.set_reached(there.reached);
  AddChanges(before, there.parts, &preview);
  return preview;
}

absl::StatusOr<std::unique_ptr<rpc::StreamReader<v1::DragNodeRequest>>> DragNode(
    const Composer& composer, const rpc::Call& call,
    std::shared_ptr<rpc::StreamWriter<v1::DragNodeResponse>> writer) {
  return OpenDragStream(composer, call, std::move(writer));
}

}  // namespace mortise::composer::methods
