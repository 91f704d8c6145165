// The method that turns a component, and what adding one turned takes of it. composer.proto says
// what it takes and gives.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/service/model_change.h"

namespace mortise::composer::methods {

// Reads quarter turns, of which there may be twelve. INVALID_ARGUMENT, "turns".
absl::StatusOr<Eigen::Matrix3d> ReadTurns(const google::protobuf::RepeatedField<int>& turns);

// Returns the fewest quarter turns of a turn.
google::protobuf::RepeatedField<int> TurnsToProto(const Eigen::Matrix3d& turn);

absl::StatusOr<ModelChange> TurnComponent(const Composer& composer, const rpc::Call& call,
                                          const v1::TurnComponentRequest& asked);

}  // namespace mortise::composer::methods
