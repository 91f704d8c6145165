// Connects a component to the body of a working model (thesis §5.6): finds which parts are to be
// held together, takes connections for them from the component's original design or else from the
// collection, and makes one parametrised assembly of it all.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "services/composer/connecting/guides.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// What the thesis leaves open, in one table.
struct ConnectOptions {
  // m. Parts are linked if their boxes are no further apart along one axis and share some of their
  // extent along the two others.
  double linked_distance = 0.015;
  // m. The largest change of a place or size that a connection may cost: the threshold of (5.3).
  // Our measure is the largest change rather than the root of the sum, so that a drawer of 30 parts
  // is judged as a board is.
  double most_moved = 0.04;
  // The same of a size, in proportion to itself: so a thin board does not become a beam.
  double most_resized = 0.1;
  // How deep a connecting part must reach into what it holds, of how deep it does where it comes
  // from: a screw that only just reaches its board holds nothing.
  double hold = 0.5;
  // K: how many connections of the collection are tried for a pair.
  int candidates = 5;
  // How much more the size of a part counts along an axis on which its item fixes it, in comparing
  // connections.
  double fixed_size_weight = 4;
  // The material of an item, "materials/…"; empty where that is not known. Principals are only
  // exchanged for those of the same material; without it, of the same item.
  std::function<std::string(const std::string& item)> material_of;
  // Tells hinges and slides, which let move what they hold, from screws. Without it, all that lies
  // on the axis of a hinge may, and any connecting part along a slide.
  ItemKindOf item_kind_of = nullptr;
};

// The design that the component is a sub-tree of.
struct Original {
  std::string source;  // assemblies/{id}
  Design design;       // as drawn
  // ConnectionsOf(source, its assembly); not null.
  std::shared_ptr<const std::vector<CollectionConnection>> connections;
};

// Where a part or joint of the merged assembly comes from: it is a copy of `name`, in another box.
struct Provenance {
  enum class From { kBody, kComponent, kConnection } from = From::kBody;
  std::string source;  // assemblies/{id} of a connection; else empty
  std::string name;    // of the part or joint in the body's or component's assembly, or the source
};

struct MadeConnection {
  std::vector<std::string> principals;  // parts of the merged assembly
  std::string source;                   // the assembly whose connection it is
  std::string as;                  // for people: what it is a copy of, "'side 1' with 'shelf 3'"
  std::vector<std::string> parts;  // connecting parts of the merged assembly; none for glue
  double moved_by = 0;             // m, the largest change that it cost
};

// Linked parts that nothing holds together, and why. Both are called as in the merged assembly.
struct ConnectionWarning {
  std::string first;   // of the body
  std::string second;  // of the component
  std::string text;
  // Further pairs, of the body and of the component, that it is of for the same reason.
  std::vector<std::pair<std::string, std::string>> others;
};

struct Connected {
  // The new body, parametrised; as drawn. Parts of the body come first, in the order of Redraw,
  // then those of the component, then connecting parts.
  Design model;
  std::vector<Provenance> parts;   // of each part of the model's assembly
  std::vector<Provenance> joints;  // of each joint of the model's assembly
  std::vector<MadeConnection> connections;
  std::vector<ConnectionWarning> warnings;
  std::string group;  // of the model: what the component's root has become
  std::string
      insert_below;  // the group that this is in: the lowest that groups what it connects to
};

// What would become of connecting.
struct ConnectTrial {
  bool is_fastened = false;                 // a connection has connecting parts
  std::vector<ConnectionWarning> warnings;  // the parts of the component as it calls them
};

// Returns the body and the component as one. `component_id` names the component's group in the
// model (see names.h). `original` is null where the component is a whole design by itself.
// `others` are tried where the original's connections do not fit.
//
// - Linked are principal parts whose boxes are near each other (ConnectOptions).
// - The original's connections between the component and the rest come first. Its rest is fitted to
//   the component as it is now; principals outside are matched to the linked parts of the body
//   whose boxes are nearest, of the same material (any, where they only touch). Then for each
//   linked pair without a connection the K nearest of `others`, by descriptor, of those that let
//   the component move as it is to (motions.h): a drawer is not screwed to a shelf, nor a shelf
//   hinged.
// - What is to stay is fastened to what stays, if it can be, and never to two parts that move
//   against each other. What is to move gets one joint, of what guides it: a hinge or slide, or all
//   that it ran between in its original. All that holds it lets it move so. These hold of the
//   original's connections as of all others.
// - A connection is used as it is (ConnectionOptimizer), or where the principals do not fit it,
//   after the smallest change of both designs within their feasible sets, (5.3), up to
//   `most_moved`.
// - No new part runs into another by more than 0.1 mm. What is left without a connection is warned
//   of, each reason once (connection_warnings.h), but for pairs that must not be fastened.
//
// FAILED_PRECONDITION: NOTHING_NEAR if no part of the body is near the component; NOTHING_HOLDS if
// it touches none, and nothing connects it; COMPONENT_OVERLAPS, naming the parts and the depth, if
// it reaches into the body by more than 0.1 mm where no connection has it so; otherwise as
// ParametricAssembly::Create.
absl::StatusOr<Connected> Connect(const Design& body, const Design& component,
                                  const std::string& component_id, const Original* original,
                                  const std::vector<const CollectionConnection*>& others,
                                  const ConnectOptions& options);

// Says what would become of Connect, but does not put the two together, which takes most of its
// time where the body is large. Fails as it, but for what only ParametricAssembly::Create finds.
absl::StatusOr<ConnectTrial> TryToConnect(const Design& body, const Design& component,
                                          const std::string& component_id, const Original* original,
                                          const std::vector<const CollectionConnection*>& others,
                                          const ConnectOptions& options);

}  // namespace mortise::composer
