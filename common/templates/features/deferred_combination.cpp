#include "common/templates/features/deferred_combination.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cad {
namespace {

// Of the same face, before and after: what differs is rounding.
bool AreSame(const gp_Ax3& a, const gp_Ax3& b) {
  constexpr double kNothing = 1e-9;  // mm and rad
  return a.Location().IsEqual(b.Location(), kNothing) &&
         a.Direction().IsEqual(b.Direction(), kNothing);
}

absl::Status CheckPlane(const ModelState& state, const std::string& face, const gp_Ax3& frame) {
  MORTISE_ASSIGN_OR_RETURN(const FaceFrame now, FrameOfFace(state, face, "face"));
  if (AreSame(now.frame, frame)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("the first face of '", face, "' is another"));
}

}  // namespace

bool DeferredCombination::Accepts(Operation operation, std::size_t body) const {
  return operation == operation_ && body == body_ && operation != Operation::kIntersect;
}

void DeferredCombination::Add(const std::string& feature, const std::vector<NamedBody>& solids) {
  steps_.push_back({feature, solids});
}

std::optional<FaceFrame> DeferredCombination::FrameBefore(const std::string& face,
                                                          const ModelState& state) {
  // Cutting moves no face: it makes faces of its own and takes others away, in part or whole.
  if (operation_ != Operation::kCut) return std::nullopt;
  // With what is cut away as bodies beside the others: a reference that means faces of both is of
  // no single body then.
  ModelState beside = state;
  for (const Step& step : steps_) {
    beside.bodies.insert(beside.bodies.end(), step.solids.begin(), step.solids.end());
  }
  absl::StatusOr<FaceFrame> found = FrameOfFace(beside, face, "face");
  if (!found.ok() || found->body >= state.bodies.size()) return std::nullopt;
  planes_.push_back({face, found->frame, steps_.size()});
  return *std::move(found);
}

absl::Status DeferredCombination::Apply(ModelState& state) const {
  const NamedBody before = state.bodies[body_];
  MORTISE_RETURN_IF_ERROR(ApplyTogether(state.bodies[body_]));
  // What is there at the end was there all the time, for cutting brings no face back.
  const bool all_there = std::all_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
    return CheckPlane(state, plane.face, plane.frame).ok();
  });
  if (all_there) return absl::OkStatus();
  state.bodies[body_] = before;
  return ApplyInTurn(state);
}

absl::Status DeferredCombination::ApplyTogether(NamedBody& body) const {
  std::vector<NamedBody> solids;
  std::string features;
  for (const Step& step : steps_) {
    solids.insert(solids.end(), step.solids.begin(), step.solids.end());
    absl::StrAppend(&features, features.empty() ? "" : "' or '", step.feature);
  }
  return Combine(operation_, solids, features, body);
}

absl::Status DeferredCombination::ApplyInTurn(ModelState& state) const {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(
        Combine(operation_, steps_[i].solids, steps_[i].feature, state.bodies[body_]));
    for (const Plane& plane : planes_) {
      if (plane.after != i + 1) continue;
      MORTISE_RETURN_IF_ERROR(CheckPlane(state, plane.face, plane.frame));
    }
  }
  return absl::OkStatus();
}

}  // namespace mortise::cad
