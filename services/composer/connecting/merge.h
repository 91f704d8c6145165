// Makes one assembly of the body of a model, a component, and what connects them (thesis §5.6.2).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/composer/connecting/candidate.h"
#include "services/composer/connecting/connect.h"

namespace mortise::composer {

// A connection that is used, with its connecting parts where they go.
struct UsedConnection {
  Candidate candidate;
  parametric::OptimizedConnection placed;
  double moved_by = 0;  // m
  // Whether a joint of the connection comes with it. What only touches has no hinge, unless
  // touching is all that holds what the joint moves, as guides do.
  bool with_joint = true;
};

struct Merged {
  parametric::Assembly assembly;
  std::vector<Provenance> parts, joints;
  std::vector<MadeConnection> connections;  // in the order of those used
  std::string group;
  std::string insert_below;
  // What the component's parts, as it is drawn now, are called in the assembly.
  std::map<std::string, std::string> component_names;
};

// Returns the body and the component drawn as they are now, and the connecting parts. The
// component's root becomes a group called as its id, in the lowest group of the body that contains
// all parts of it that are connected; connecting parts come into the lowest group that contains
// their principals. A joint of a connection that moved the component's root against the rest moves
// its group. Fails as Redraw.
absl::StatusOr<Merged> Merge(const BothSides& sides, const std::string& component_id,
                             const std::vector<UsedConnection>& used);

}  // namespace mortise::composer
