#include "services/composer/suggestions/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "common/assembly/model/element.h"
#include "services/composer/model/overlap.h"
#include "services/composer/model/placed_forms.h"
#include "services/composer/model/quarter_turn.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::BoundingBox;
using parametric::Element;

constexpr double kSamePlace = 0.01;  // m
constexpr double kRounding = 1e-9;   // m: distances are told apart by no less
constexpr std::size_t kMaxRanked = 1000;
constexpr double kSameRoom = 0.5;  // of both boxes, that they have in common

BoundingBox Moved(BoundingBox box, const Eigen::Vector3d& by) {
  box.minimum += by;
  box.maximum += by;
  return box;
}

double VolumeOf(const BoundingBox& box) { return box.size().prod(); }

// Whether two boxes are about the same room.
bool AreOneRoom(const BoundingBox& a, const BoundingBox& b) {
  const Eigen::Vector3d common =
      (a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum)).cwiseMax(0);
  return common.prod() >= kSameRoom * std::max(VolumeOf(a), VolumeOf(b));
}

// How the connection is moved so that `there` comes where `here` is, seen from `partner`: along
// each axis the planes that are nearest to a plane of the partner come to lie on each other.
Eigen::Vector3d MoveTo(const BoundingBox& here, const BoundingBox& there,
                       const BoundingBox& partner) {
  Eigen::Vector3d move;
  for (int axis = 0; axis < 3; ++axis) {
    const auto apart = [&](double plane) {
      return std::min(std::abs(plane - partner.minimum[axis]),
                      std::abs(plane - partner.maximum[axis]));
    };
    const bool by_lower = apart(there.minimum[axis]) <= apart(there.maximum[axis]);
    move[axis] = by_lower ? here.minimum[axis] - there.minimum[axis]
                          : here.maximum[axis] - there.maximum[axis];
  }
  return move;
}

// The parts as they lie to a collection that is turned: turned back.
std::vector<PrincipalPart> TurnedBack(std::vector<PrincipalPart> parts,
                                      const Eigen::Matrix3d& turn) {
  const Eigen::Matrix3d back = turn.transpose();
  for (PrincipalPart& part : parts) {
    part.box = Turned(part.box, back);
    Eigen::Vector3d is_fixed;
    for (int axis = 0; axis < 3; ++axis) {
      is_fixed[axis] = part.is_fixed[static_cast<std::size_t>(axis)] ? 1 : 0;
    }
    is_fixed = back.cwiseAbs() * is_fixed;
    for (int axis = 0; axis < 3; ++axis) {
      part.is_fixed[static_cast<std::size_t>(axis)] = is_fixed[axis] > 0.5;
    }
  }
  return parts;
}

// The name of the largest group that holds `part` and not `other`; that of the part where there is
// none.
std::string ComponentOf(const Assembly& assembly, const Element& part, const Element& other) {
  std::string node = part.name;
  for (int group = part.group; group > 0;
       group = assembly.groups[static_cast<std::size_t>(group)].parent) {
    if (parametric::IsWithin(assembly, other.group, group)) break;
    node = assembly.groups[static_cast<std::size_t>(group)].name;
  }
  return node;
}

// Which items may stand for each other: each two are compared once. Of one thread.
class ItemKinds {
 public:
  explicit ItemKinds(const SameMaterial& are_same) : are_same_(are_same) {}

  int NumberOf(const std::string& item) {
    const auto [known, is_new] = numbers_.try_emplace(item, static_cast<int>(names_.size()));
    if (is_new) names_.push_back(&known->first);
    return known->second;
  }

  bool AreSame(int item, int other) {
    if (item == other) return true;
    const auto [known, is_new] = same_.try_emplace({item, other}, false);
    if (is_new) known->second = are_same_(NameOf(item), NameOf(other));
    return known->second;
  }

 private:
  const std::string& NameOf(int item) const { return *names_[static_cast<std::size_t>(item)]; }

  const SameMaterial& are_same_;
  std::unordered_map<std::string, int> numbers_;
  std::vector<const std::string*> names_;
  std::map<std::pair<int, int>, bool> same_;
};

// A principal of a connection that is alike to a part of the body.
struct Alike {
  const CollectionConnection* from = nullptr;
  int there = 0;         // of its elements
  std::size_t here = 0;  // of the body's parts
  double distance = 0;   // m, PartDistance
};

// Which axis becomes which: all that sizes know of a turn.
using AxesTurned = std::array<int, 3>;

AxesTurned AxesOf(const Eigen::Matrix3d& turn) {
  AxesTurned axes = {0, 0, 0};
  for (int axis = 0; axis < 3; ++axis) {
    turn.col(axis).cwiseAbs().maxCoeff(&axes[static_cast<std::size_t>(axis)]);
  }
  return axes;
}

// A part of the collection that might be put beside one of the body.
struct Match {
  Suggestion suggestion;
  Eigen::Vector3d move = Eigen::Vector3d::Zero();  // m, from where it is drawn
  BoundingBox room;                                // that it takes
  int item = 0;                                    // ItemKinds
  bool overlaps_there = false;  // it reaches into the part that holds it there, too
};

// What orders equal ones, so that the order of the collection does not.
auto NamesOf(const Suggestion& suggestion) {
  return std::tie(suggestion.from->source, suggestion.node, suggestion.element,
                  suggestion.element_there, suggestion.partner);
}

class Search {
 public:
  Search(const Design& body, const SuggestOptions& options)
      : options_(options), parts_(PrincipalPartsOf(body)), items_(options.same_material) {
    // Placed parts say where they are, and elements what they look like.
    for (const parametric::PlacedPart& placed : PartsOf(body)) {
      solids_.emplace_back(placed.name, placed.box, body.assembly->ShapeOf(placed), placed.stretch);
    }
  }

  // None where there was no time for all of them: the best might not be among the rest.
  std::vector<Match> Matches(const std::vector<const CollectionConnection*>& connections) {
    std::map<AxesTurned, std::vector<Alike>> alike;
    for (const Eigen::Matrix3d& turn : options_.turns) alike[AxesOf(turn)];
    FindAlike(connections, alike);
    std::vector<Match> matches;
    for (const Eigen::Matrix3d& turn : options_.turns) {
      std::vector<Match> turned = MatchesTurned(alike.at(AxesOf(turn)), turn);
      std::move(turned.begin(), turned.end(), std::back_inserter(matches));
    }
    if (IsLate()) return {};
    std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
      const Suggestion& x = a.suggestion;
      const Suggestion& y = b.suggestion;
      if (x.score != y.score) return x.score > y.score;
      if (x.turns != y.turns) {
        return std::pair(x.turns.size(), x.turns) < std::pair(y.turns.size(), y.turns);
      }
      return NamesOf(x) < NamesOf(y);
    });
    return matches;
  }

  bool IsLate() const { return options_.is_late && options_.is_late(); }

  // Whether a component, turned already, may go where the match says, and where that is.
  bool Fits(const Assembly& component, Match& match) const {
    BoundingBox box = Moved(component.parts.front().box, match.move);
    for (const parametric::AssemblyPart& part : component.parts) {
      const SolidPart solid(part.name, Moved(part.box, match.move), part.shape,
                            mesh::BoxStretch(part.box.size()));
      box.minimum = box.minimum.cwiseMin(solid.box().minimum);
      box.maximum = box.maximum.cwiseMax(solid.box().maximum);
      if (std::any_of(solids_.begin(), solids_.end(), [&](const SolidPart& other) {
            return !IsLetIn(match, part.name, other.name()) && SolidPart::DepthOf(solid, other) > 0;
          })) {
        return false;
      }
    }
    match.suggestion.position << box.center().x(), box.center().y(), box.minimum.z();
    match.suggestion.size = box.size();
    return true;
  }

 private:
  // Whether two parts may reach into each other, as they do where they come from.
  static bool IsLetIn(const Match& match, const std::string& part, const std::string& other) {
    return match.overlaps_there && part == match.suggestion.partner &&
           other == match.suggestion.element;
  }

  // Adds what of the collection is alike to parts of the body, for each way of turning that `alike`
  // has. What is of another material is not measured.
  void FindAlike(const std::vector<const CollectionConnection*>& connections,
                 std::map<AxesTurned, std::vector<Alike>>& alike) {
    std::map<AxesTurned, std::vector<PrincipalPart>> parts;
    for (const Eigen::Matrix3d& turn : options_.turns) {
      const auto [turned, is_new] = parts.try_emplace(AxesOf(turn));
      if (is_new) turned->second = TurnedBack(parts_, turn);
    }
    std::vector<int> items;
    for (const PrincipalPart& part : parts_) items.push_back(items_.NumberOf(part.item));
    for (const CollectionConnection* const from : connections) {
      const parametric::ElementConnection& connection = from->connection;
      if (connection.connecting.empty()) continue;
      if (IsLate()) return;
      for (int there = 0; there < connection.principal_count(); ++there) {
        const Element& stands_for = connection.elements[static_cast<std::size_t>(there)];
        const int item = items_.NumberOf(stands_for.item);
        for (std::size_t here = 0; here < parts_.size(); ++here) {
          if (!IsNear(parts_[here]) || !items_.AreSame(item, items[here])) continue;
          for (auto& [axes, found] : alike) {
            const double distance = RoundedDistance(parts.at(axes)[here], stands_for);
            if (distance <= options_.alike) found.push_back({from, there, here, distance});
          }
        }
      }
    }
  }

  bool IsNear(const PrincipalPart& part) const {
    return options_.near.empty() || options_.near.contains(part.drawn_as);
  }

  double RoundedDistance(const PrincipalPart& part, const Element& other) const {
    return kRounding *
           std::round(PartDistance(part, other, options_.fixed_size_weight) / kRounding);
  }

  // The matches with the collection so turned, ranked among themselves.
  std::vector<Match> MatchesTurned(const std::vector<Alike>& alike, const Eigen::Matrix3d& turn) {
    const std::vector<PrincipalPart> parts = TurnedBack(parts_, turn);
    std::vector<Match> matches;
    for (const Alike& one : alike) {
      if (IsLate()) return {};
      AddMatches(one, parts[one.here], turn, matches);
    }
    const std::vector<Axis> turns = QuarterTurnsOf(turn);
    for (Match& match : matches) match.suggestion.turns = turns;
    Rank(matches);
    return matches;
  }

  // `here` is turned back.
  void AddMatches(const Alike& alike, const PrincipalPart& here, const Eigen::Matrix3d& turn,
                  std::vector<Match>& matches) {
    const CollectionConnection& from = *alike.from;
    const std::vector<Element>& elements = from.connection.elements;
    const Element& stands_for = elements[static_cast<std::size_t>(alike.there)];
    for (int i = 0; i < from.connection.principal_count(); ++i) {
      if (i == alike.there) continue;
      const Element& partner = elements[static_cast<std::size_t>(i)];
      Match match;
      const Eigen::Vector3d move = MoveTo(here.box, stands_for.box, partner.box);
      match.move = turn * move;
      match.room = Turned(Moved(partner.box, move), turn);
      if (IsTaken(match.room)) continue;
      match.item = items_.NumberOf(partner.item);
      match.overlaps_there = CommonDepth(stands_for.box, partner.box) > kMaxOverlap;
      match.suggestion.from = &from;
      match.suggestion.node = ComponentOf(from.connection.assembly, partner, stands_for);
      match.suggestion.element = here.name;
      match.suggestion.element_there = stands_for.name;
      match.suggestion.partner = partner.name;
      match.suggestion.distance = alike.distance;
      matches.push_back(std::move(match));
    }
  }

  // Whether a part of the body is there already.
  bool IsTaken(const BoundingBox& room) const {
    return std::any_of(parts_.begin(), parts_.end(), [&](const PrincipalPart& part) {
      const Eigen::Vector3d common =
          (room.maximum.cwiseMin(part.box.maximum) - room.minimum.cwiseMax(part.box.minimum))
              .cwiseMax(0);
      return common.prod() >= kSameRoom * std::min(VolumeOf(room), VolumeOf(part.box));
    });
  }

  // Scores the matches, of many those that are most alike.
  void Rank(std::vector<Match>& matches) {
    std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
      const Suggestion& x = a.suggestion;
      const Suggestion& y = b.suggestion;
      if (x.distance != y.distance) return x.distance < y.distance;
      return NamesOf(x) < NamesOf(y);
    });
    if (matches.size() > kMaxRanked) matches.resize(kMaxRanked);
    for (Match& match : matches) {
      if (IsLate()) return;
      std::set<std::string> assemblies, elements;
      for (const Match& other : matches) {
        if (AreOneRoom(match.room, other.room) && items_.AreSame(match.item, other.item)) {
          assemblies.insert(other.suggestion.from->source);
          elements.insert(other.suggestion.element);
        }
      }
      Suggestion& suggestion = match.suggestion;
      suggestion.assemblies = static_cast<int>(assemblies.size());
      suggestion.held_by = static_cast<int>(elements.size());
      suggestion.score = (1 + std::log2(suggestion.held_by)) *
                         (1 + std::log2(suggestion.assemblies)) /
                         (1 + suggestion.distance / options_.half_distance);
    }
  }

  const SuggestOptions& options_;
  const std::vector<PrincipalPart> parts_;
  ItemKinds items_;
  std::vector<SolidPart> solids_;
};

// Components, turned when they are first wanted so.
class TurnedComponents {
 public:
  explicit TurnedComponents(const ComponentSource& components) : components_(components) {}

  // Null where it cannot be had.
  const Assembly* Get(const Suggestion& suggestion) {
    const auto component = components_(suggestion.from->source, suggestion.node);
    if (!component.ok()) return nullptr;
    if (suggestion.turns.empty()) return *component;
    const auto [turned, is_new] =
        turned_.try_emplace({suggestion.from->source, suggestion.node, suggestion.turns});
    if (is_new) turned->second = Turned(**component, TurnOf(suggestion.turns));
    return &turned->second;
  }

 private:
  const ComponentSource& components_;
  std::map<std::tuple<std::string, std::string, std::vector<Axis>>, Assembly> turned_;
};

// Whether two suggestions are of the same component in the same room.
bool AreInOneRoom(const Suggestion& a, const Suggestion& b) {
  return a.from->source == b.from->source && a.node == b.node &&
         (a.position - b.position).norm() <= kSamePlace && (a.size - b.size).norm() <= kSamePlace;
}

bool IsSuggested(const std::vector<Suggestion>& suggested, const Suggestion& suggestion) {
  return std::any_of(suggested.begin(), suggested.end(),
                     [&](const Suggestion& other) { return AreInOneRoom(other, suggestion); });
}

// Turned otherwise it may fit.
bool IsRefused(const std::vector<Suggestion>& refused, const Suggestion& suggestion) {
  return std::any_of(refused.begin(), refused.end(), [&](const Suggestion& other) {
    return other.turns == suggestion.turns && AreInOneRoom(other, suggestion);
  });
}

// How many components there are among matches from the one of an index on.
std::int64_t CountGroups(const std::vector<Match>& matches, std::size_t from) {
  std::set<std::pair<std::string, std::string>> groups;
  for (std::size_t i = from; i < matches.size(); ++i) {
    groups.emplace(matches[i].suggestion.from->source, matches[i].suggestion.node);
  }
  return static_cast<std::int64_t>(groups.size());
}

}  // namespace

double PartDistance(const PrincipalPart& part, const Element& other, double fixed_size_weight) {
  double squares = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const bool is_fixed =
        part.is_fixed[axis] || other.limits[axis].minimum == other.limits[axis].maximum;
    const double difference = part.box.size()[a] - other.box.size()[a];
    squares += std::pow((is_fixed ? fixed_size_weight : 1) * difference, 2);
  }
  return std::sqrt(squares);
}

std::vector<Suggestion> Suggest(const Design& body,
                                const std::vector<const CollectionConnection*>& connections,
                                const ComponentSource& components, const SuggestOptions& options,
                                SearchExtent* extent) {
  Search search(body, options);
  TurnedComponents turned(components);
  std::vector<Suggestion> suggestions, refused;
  int tried = 0;
  std::vector<Match> matches = search.Matches(connections);
  SearchExtent searched{search.IsLate()};
  for (std::size_t i = 0; i < matches.size(); ++i) {
    Match& match = matches[i];
    if (static_cast<int>(suggestions.size()) >= options.count) break;
    const Assembly* const component = turned.Get(match.suggestion);
    // What cannot be had for want of time is no reason to say that it does not fit.
    searched.is_cut_short = search.IsLate();
    if (searched.is_cut_short) {
      searched.not_compared = CountGroups(matches, i);
      break;
    }
    if (component == nullptr || !search.Fits(*component, match)) continue;
    if (IsSuggested(suggestions, match.suggestion) || IsRefused(refused, match.suggestion)) {
      continue;
    }
    if (options.trial) {
      SuggestionTrial& trial = match.suggestion.trial;
      if (tried < options.most_tried && (!options.has_time || options.has_time())) {
        ++tried;
        trial = options.trial(match.suggestion);
      }
      if (trial.outcome == SuggestionTrial::Outcome::kFitsNot) {
        refused.push_back(match.suggestion);
        continue;
      }
      if (trial.outcome != SuggestionTrial::Outcome::kFits) {
        match.suggestion.score *= options.in_doubt;
      }
    }
    suggestions.push_back(match.suggestion);
  }
  std::stable_sort(suggestions.begin(), suggestions.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  if (extent != nullptr) *extent = searched;
  return suggestions;
}

}  // namespace mortise::composer
