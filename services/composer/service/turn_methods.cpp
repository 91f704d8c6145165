#include "services/composer/service/turn_methods.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/files/axis_codec.h"
#include "google/protobuf/util/message_differencer.h"
#include "services/composer/model/quarter_turn.h"

namespace mortise::composer::methods {
namespace {

constexpr int kMaxTurns = 12;

// A component while it is turned.
class ComponentTurner {
 public:
  ComponentTurner(const Composer& composer, const rpc::Call& call, const std::string& model,
                  OpenLoose& loose)
      : drawings_(composer.drawings),
        is_given_up_([&call] { return call.cancelled(); }),
        model_(model),
        loose_(loose),
        present_(StateOf(loose.part.design, loose.part.drawing, loose.part.group)) {}

  // Turns the component on by `more`. Returns the drawing that it then has, and its turn in all.
  absl::StatusOr<std::pair<std::shared_ptr<const Drawing>, Eigen::Matrix3d>> Turn(
      const Eigen::Matrix3d& more) {
    const std::string drawn =
        loose_.turned.drawing().empty() ? loose_.part.drawing : loose_.turned.drawing();
    MORTISE_ASSIGN_OR_RETURN(origin_, drawings_.Get(model_, drawn));
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3d now, ReadTurns(loose_.turned.turns()));
    MORTISE_ASSIGN_OR_RETURN(const TurnedFrom from, Beginning(now));
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3d began, ReadTurns(from.turns_before()));
    const Eigen::Matrix3d turn = more * now;
    MORTISE_ASSIGN_OR_RETURN(OpenDesign turned, TurnedFromBefore(from.before(), began, turn));
    loose_.part = std::move(turned);
    loose_.turned.Clear();
    if (turn != began) *loose_.turned.mutable_before() = from.before();
    if (turn != began) *loose_.turned.mutable_turns_before() = from.turns_before();
    if (loose_.turned.has_before() || !turn.isIdentity(0)) {
      loose_.turned.set_drawing(drawn);
      *loose_.turned.mutable_turns() = TurnsToProto(turn);
    }
    MORTISE_ASSIGN_OR_RETURN(const auto drawing, drawings_.Turned(origin_, turn));
    return std::pair(drawing, turn);
  }

 private:
  // What is turned: the component as it was before it was last turned, if nothing else has changed
  // it since, or else as it is now.
  absl::StatusOr<TurnedFrom> Beginning(const Eigen::Matrix3d& now) {
    if (loose_.turned.has_before()) {
      MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3d began,
                               ReadTurns(loose_.turned.turns_before()));
      MORTISE_ASSIGN_OR_RETURN(const OpenDesign again,
                               TurnedFromBefore(loose_.turned.before(), began, now));
      const DesignState state = StateOf(again.design, again.drawing, again.group);
      if (google::protobuf::util::MessageDifferencer::Equals(state, present_)) {
        return loose_.turned;
      }
    }
    TurnedFrom from;
    *from.mutable_before() = present_;
    *from.mutable_turns_before() = loose_.turned.turns();
    return from;
  }

  // The design of a state that is turned by `began` from the origin, turned so that it is by
  // `turn`.
  absl::StatusOr<OpenDesign> TurnedFromBefore(const DesignState& before,
                                              const Eigen::Matrix3d& began,
                                              const Eigen::Matrix3d& turn) {
    MORTISE_ASSIGN_OR_RETURN(Design design, drawings_.DesignOf(model_, before, is_given_up_));
    if (turn == began) return OpenDesign{before.drawing(), before.group(), std::move(design)};
    MORTISE_ASSIGN_OR_RETURN(const auto drawing, drawings_.Turned(origin_, turn));
    MORTISE_ASSIGN_OR_RETURN(auto assembly,
                             drawings_.Parametrize(*drawing, before.group(), is_given_up_));
    MORTISE_ASSIGN_OR_RETURN(design, Turned(design, std::move(assembly), turn * began.transpose()));
    return OpenDesign{drawing->digest, before.group(), std::move(design)};
  }

  ModelDrawings& drawings_;
  const IsGivenUp is_given_up_;
  const std::string& model_;
  OpenLoose& loose_;
  const DesignState present_;
  std::shared_ptr<const Drawing> origin_;
};

}  // namespace

absl::StatusOr<Eigen::Matrix3d> ReadTurns(const google::protobuf::RepeatedField<int>& turns) {
  if (turns.size() > kMaxTurns) {
    return InvalidField("turns", absl::StrCat("are more than ", kMaxTurns));
  }
  std::vector<Axis> axes;
  for (int i = 0; i < turns.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(
        axes.emplace_back(),
        parametric::AxisFromProto(static_cast<v1::Axis>(turns[i]), absl::StrCat("turns[", i, "]")));
  }
  return TurnOf(axes);
}

google::protobuf::RepeatedField<int> TurnsToProto(const Eigen::Matrix3d& turn) {
  google::protobuf::RepeatedField<int> turns;
  for (const Axis axis : QuarterTurnsOf(turn)) turns.Add(parametric::AxisToProto(axis));
  return turns;
}

absl::StatusOr<ModelChange> TurnComponent(const Composer& composer, const rpc::Call& call,
                                          const v1::TurnComponentRequest& asked) {
  if (asked.turns().empty()) return InvalidField("turns", "are missing");
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3d more, ReadTurns(asked.turns()));
  MORTISE_ASSIGN_OR_RETURN(ModelAtWork at_work, OpenFor(composer, call, asked));
  OpenModel& model = at_work.model;
  MORTISE_ASSIGN_OR_RETURN(OpenLoose* const loose, FindLoose(model, asked.component()));
  ComponentTurner turner(composer, call, model.name, *loose);
  MORTISE_ASSIGN_OR_RETURN(const auto turned, turner.Turn(more));
  MORTISE_ASSIGN_OR_RETURN(v1::ModelComponent* const component,
                           FindComponent(model, asked.component()));
  *component->mutable_turns() = TurnsToProto(turned.second);
  component->set_state(v1::ModelComponent::PLACED);
  component->clear_alignments();
  return at_work.Done(absl::StrCat("turn ", asked.component()), {turned.first});
}

}  // namespace mortise::composer::methods
