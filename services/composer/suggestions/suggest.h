// Suggests what might come next in a model: what designs of a collection have beside such parts as
// the model's (thesis §9.1.1: "present relevant components to the user during the modeling
// session").
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/model/design.h"
#include "services/composer/model/placed_forms.h"

namespace mortise::composer {

// Whether two items may stand for each other.
using SameMaterial = std::function<bool(const std::string& item, const std::string& other)>;

struct Suggestion;

// What became of a suggestion when it was dropped, snapped and connected.
struct SuggestionTrial {
  enum class Outcome {
    kNotTried,
    kFits,        // it is held, and nothing is warned of
    kHeldInPart,  // it can be connected; `text` says what is warned of
    kFitsNot,     // it cannot be connected, or nothing holds it
  } outcome = Outcome::kNotTried;
  std::string text;
};

// Tries a suggestion.
using TrySuggestion = std::function<SuggestionTrial(const Suggestion&)>;

struct SuggestOptions {
  int count = 10;  // of suggestions
  // How the collection's designs may be turned before they are looked at (quarter_turn.h), each
  // once.
  std::vector<Eigen::Matrix3d> turns = {Eigen::Matrix3d::Identity()};
  // Parts of the body, as they are drawn, that the new component is to be held by; any if empty.
  std::set<std::string> near = {};
  // m: how much a part of the collection may differ from the model's, in its sizes (PartDistance).
  double alike = 0.5;
  // How much more a size counts along an axis on which an item fixes it, as in ConnectOptions.
  double fixed_size_weight = 4;
  // m: a difference that halves the score.
  double half_distance = 0.2;
  SameMaterial same_material;
  // Tries the first of what is found, if there is one: as many as `most_tried`, which bounds the
  // time that it takes.
  TrySuggestion trial;
  int most_tried = 12;
  // Whether there is time for one more trial; there is if it is null. What is not tried for lack of
  // time is told of as such.
  std::function<bool()> has_time = nullptr;
  // Whether all time is over, or nobody waits any more: what is found by then is all that there is.
  // Never if it is null. It is asked all along.
  std::function<bool()> is_late = nullptr;
  // By which the score is multiplied of what is only held in part, and of what was not tried.
  double in_doubt = 0.5;
};

// A component, and where it would go.
struct Suggestion {
  const CollectionConnection* from = nullptr;  // that would hold it
  std::string node;                            // of the assembly that it is from: the component
  std::vector<Axis> turns = {};                // quarter turns that it is turned by
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, of the middle of its box's lower side
  Eigen::Vector3d size = Eigen::Vector3d::Zero();      // m, of its box
  std::string element;                                 // part of the body that it would be held by
  std::string element_there;                           // the part that this one stands for
  std::string partner;                                 // the component's part that is held there
  double distance = 0;                                 // m, PartDistance of the two
  int held_by = 0;     // parts of the body that would hold such a part there
  int assemblies = 0;  // of the collection that have such a part there
  double score = 0;
  SuggestionTrial trial;
};

// How far the search for suggestions went.
struct SearchExtent {
  // Whether there was no time to look at all that might be suggested.
  bool is_cut_short = false;
  // How many of the groups that might go beside the model's parts were then not compared with what
  // stands there in all their places; 0 also where time was over before they were found.
  std::int64_t not_compared = 0;
};

// Returns how much two parts differ in their sizes, m: as DistanceOf counts them.
double PartDistance(const PrincipalPart& part, const parametric::Element& other,
                    double fixed_size_weight);

// Returns the component of a node of an assembly by its name, as it is drawn, not turned; an error
// where it cannot be used, or is not wanted: for its price, or what it is made of.
using ComponentSource = std::function<absl::StatusOr<const parametric::Assembly*>(
    const std::string& assembly, const std::string& node)>;

// Returns what might come next, the best first; of equal ones the first by turns, assembly and
// node.
//
// - Of each connection of the collection that has connecting parts, each principal is compared with
//   each of the body's: of the same material, and alike in size. The other principals are put
//   beside the body's part as they lie beside the one there, by the planes of the two that are
//   nearest to each other along each axis. Where nothing of the body is in the way it may be what
//   is missing. The same is done with all designs turned by each of `turns`.
// - The component is all that is grouped with it there and not with the part that it is held by:
//   the largest such group; where there is none, it is the part alone.
// - The score is (1 + log2 held_by) · (1 + log2 assemblies) / (1 + distance / half_distance). Of
//   all that is found so turned, so many parts of the body hold, and so many assemblies have, a
//   part of that material in about that place: with half of both boxes in common. So what closes a
//   gap comes before what would hang on one side. Of equal scores what is turned less comes first.
// - A component is left out that reaches into the body by more than 0.1 mm, or that `components`
//   gives none of. Of the same component in the same room, its place and size within 10 mm, only
//   the best is told, however it is turned.
// - The first are tried, while there is time. What cannot be connected is left out; what is held in
//   part, or was not tried, scores less.
//
// It is deterministic, whatever the order of the connections, but for `has_time` and `is_late`. Of
// many the 1000 that are most alike are looked at of each turn. O(connections · parts), for each
// turn what is alike, and what is asked of `components` for the best. `extent`, unless null, tells
// how far it went.
std::vector<Suggestion> Suggest(const Design& body,
                                const std::vector<const CollectionConnection*>& connections,
                                const ComponentSource& components, const SuggestOptions& options,
                                SearchExtent* extent = nullptr);

}  // namespace mortise::composer
