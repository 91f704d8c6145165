#include "services/fabplanner/documents/assembly_picture.h"

#include <algorithm>
#include <utility>

#include "common/base/errors.h"
#include "common/render/scene.h"
#include "services/fabplanner/documents/part_mesh.h"
#include "services/fabplanner/documents/step_view.h"

namespace mortise::fabplanner {
namespace {

constexpr std::size_t kMostPegs = 2000;
constexpr std::size_t kMostArrows = 24;

const render::Color& ColorOf(StepRole role) {
  return role == StepRole::kStanding ? kPresentColor
         : role == StepRole::kAdded  ? kAddedColor
                                     : kPegColor;
}

void AddPart(const ArrangedPart& arranged, render::Scene* scene) {
  render::Shape shape = PartShape(*arranged.part, arranged.offset);
  if (shape.triangles.cols() == 0) return;
  shape.color = ColorOf(arranged.role);
  scene->shapes.push_back(std::move(shape));
}

void AddPeg(const ArrangedPeg& arranged, render::Scene* scene) {
  render::Shape shape = PegShape(*arranged.peg, arranged.offset);
  shape.color = kPegColor;
  scene->shapes.push_back(std::move(shape));
}

void AddArrow(const StepWay& way, render::Scene* scene) {
  render::Line arrow;
  arrow.points.resize(3, 2);
  arrow.points.col(0) = way.place + way.from;
  arrow.points.col(1) = way.place + way.to;
  arrow.color = kArrowColor;
  arrow.width = 2.5;
  arrow.arrow = true;
  arrow.on_top = true;
  scene->lines.push_back(std::move(arrow));
}

// Adds all of `list`, or as many as `most` of it, evenly chosen.
template <class Thing, class Add>
void AddEvenly(const std::vector<Thing>& list, std::size_t most, render::Scene* scene, Add add) {
  const std::size_t count = std::min(list.size(), most);
  for (std::size_t i = 0; i < count; ++i) add(list[i * list.size() / count], scene);
}

}  // namespace

absl::StatusOr<StepPicture> DrawStep(const StepArrangement& arrangement) {
  render::Scene scene;
  for (const ArrangedPart& part : arrangement.parts) {
    if (part.role != StepRole::kFastener) AddPart(part, &scene);
  }
  StepPicture picture;
  MORTISE_ASSIGN_OR_RETURN(picture.view, ChooseView(scene));
  for (const ArrangedPart& part : arrangement.parts) {
    if (part.role == StepRole::kFastener) AddPart(part, &scene);
  }
  AddEvenly(arrangement.pegs, kMostPegs, &scene, AddPeg);
  AddEvenly(arrangement.arrows, kMostArrows, &scene, AddArrow);
  MORTISE_ASSIGN_OR_RETURN(picture.png, RenderStep(std::move(scene), picture.view));
  return picture;
}

}  // namespace mortise::fabplanner
