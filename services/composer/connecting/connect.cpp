#include "services/composer/connecting/connect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/connections/connection_optimizer.h"
#include "common/base/errors.h"
#include "services/composer/connecting/candidate.h"
#include "services/composer/connecting/connection_descriptor.h"
#include "services/composer/connecting/fit_programme.h"
#include "services/composer/connecting/hold.h"
#include "services/composer/connecting/linked_parts.h"
#include "services/composer/connecting/merge.h"
#include "services/composer/connecting/original_fit.h"
#include "services/composer/connecting/side_overlaps.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::ElementConnection;
using parametric::OptimizedConnection;

constexpr double kMinShared = 1e-6;  // m; parts that share less meet in an edge only

std::string Millimetres(double metres) { return absl::StrCat(1000 * metres, " mm"); }

class Connector {
 public:
  Connector(const Design& body, const Design& component, const Original* original,
            const std::vector<const CollectionConnection*>& others, const ConnectOptions& options)
      : sides_(SidesOf(body, component)),
        original_(original),
        others_(others),
        options_(options),
        tolerance_(std::max(body.assembly->tolerance(), component.assembly->tolerance())),
        snapped_(sides_) {}

  absl::StatusOr<Connected> Connect(const std::string& component_id) {
    MORTISE_RETURN_IF_ERROR(FindLinked());
    if (original_ != nullptr) {
      MORTISE_RETURN_IF_ERROR(UseOriginal());
    }
    UseOthers();
    MORTISE_RETURN_IF_ERROR(CheckHeld());
    MORTISE_ASSIGN_OR_RETURN(std::vector<UsedConnection> used, PlaceAll());
    MORTISE_RETURN_IF_ERROR(CheckOverlap());
    MORTISE_ASSIGN_OR_RETURN(Merged merged, Merge(sides_, component_id, used));
    Connected connected;
    connected.parts = std::move(merged.parts);
    connected.joints = std::move(merged.joints);
    connected.connections = std::move(merged.connections);
    connected.group = std::move(merged.group);
    connected.insert_below = std::move(merged.insert_below);
    connected.warnings = std::move(warnings_);
    for (ConnectionWarning& warning : connected.warnings) {
      const auto renamed = merged.component_names.find(warning.second);
      if (renamed != merged.component_names.end()) warning.second = renamed->second;
    }
    MORTISE_ASSIGN_OR_RETURN(
        connected.model, AsDrawn(std::move(merged.assembly),
                                 {sides_.body.assembly.get(), sides_.component.assembly.get()}));
    return connected;
  }

 private:
  // The item's material; the item itself where that is not known.
  std::string KindOf(const std::string& item) const {
    std::string material = options_.material_of ? options_.material_of(item) : "";
    return material.empty() ? item : material;
  }

  bool SameMaterial(const std::string& item, const std::string& other) const {
    return item == other || KindOf(item) == KindOf(other);
  }

  absl::Status FindLinked() {
    linked_ = FindLinkedParts(sides_.body_parts, sides_.component_parts, options_.linked_distance,
                              kMinShared);
    if (!linked_.empty()) return absl::OkStatus();
    double nearest = std::numeric_limits<double>::infinity();
    std::string name;
    for (const PrincipalPart& body : sides_.body_parts) {
      for (const PrincipalPart& part : sides_.component_parts) {
        const double distance = DistanceBetween(body.box, part.box);
        if (distance >= nearest) continue;
        nearest = distance;
        name =
            absl::StrCat("'", part.name, "' is ", Millimetres(distance), " from '", body.name, "'");
      }
    }
    return PreconditionFailed(
        "NOTHING_NEAR", absl::StrCat("no part of the model lies against the component: ", name,
                                     ", the nearest; move it there, or snap it, first"));
  }

  bool AreLinked(int body, int component) const {
    return std::any_of(linked_.begin(), linked_.end(), [&](const LinkedPair& pair) {
      return pair.body == body && pair.component == component;
    });
  }

  // The connections of the original between the component and the rest, for what stands in the
  // model where that stood.
  absl::Status UseOriginal() {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<PrincipalPart> fitted,
                             FitOriginal(original_->design, sides_.component));
    std::map<std::string, const PrincipalPart*> by_name;
    for (const PrincipalPart& part : fitted) by_name[part.name] = &part;
    // Those that hold by something come first: what only touches must not keep them out.
    for (const bool with_parts : {true, false}) {
      for (const CollectionConnection& connection : original_->connections) {
        std::set<std::string> missing;
        const std::optional<Candidate> candidate = BindOriginal(connection, by_name, missing);
        if (candidate && HasParts(connection) == with_parts) TryOriginal(*candidate);
        if (missing.empty()) continue;
        MORTISE_RETURN_IF_ERROR(UseRestOf(connection, by_name, missing, with_parts));
      }
    }
    return absl::OkStatus();
  }

  static bool HasParts(const CollectionConnection& connection) {
    return !connection.connection.connecting.empty();
  }

  // Remembers why a connection of the original cannot be used.
  void TryOriginal(const Candidate& candidate) {
    const std::string why = Try(candidate);
    if (why.empty() || candidate.from->connection.connecting.empty()) return;
    for (const Pair& pair : PairsOf(candidate)) {
      if (AreLinked(pair.first, pair.second)) refused_.try_emplace(pair, why);
    }
  }

  bool IsRefused(const Candidate& candidate) const {
    const std::vector<Pair> pairs = PairsOf(candidate);
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const Pair& pair) { return refused_.contains(pair); });
  }

  // What such a connection is without those for which nothing stands in the model: the slides of a
  // drawer go without the handle whose screws touch theirs. First those with parts.
  absl::Status UseRestOf(const CollectionConnection& connection,
                         const std::map<std::string, const PrincipalPart*>& by_name,
                         const std::set<std::string>& missing, bool with_parts) {
    std::set<std::string> there;
    for (const std::string& name : connection.Principals()) {
      if (!missing.contains(name)) there.insert(name);
    }
    MORTISE_ASSIGN_OR_RETURN(std::vector<CollectionConnection> rest,
                             ConnectionsAmong(connection, there));
    for (CollectionConnection& one : rest) {
      if (HasParts(one) != with_parts) continue;
      made_.push_back(std::make_unique<const CollectionConnection>(std::move(one)));
      std::set<std::string> still_missing;
      const std::optional<Candidate> candidate =
          BindOriginal(*made_.back(), by_name, still_missing);
      if (candidate && (with_parts || !IsRefused(*candidate))) TryOriginal(*candidate);
    }
    return absl::OkStatus();
  }

  int ComponentPart(const std::string& name) const {
    for (std::size_t i = 0; i < sides_.component_parts.size(); ++i) {
      if (sides_.component_parts[i].name == name) return static_cast<int>(i);
    }
    return -1;
  }

  // The connection with the component's parts for those inside of it, and for those outside the
  // linked parts of the body whose boxes are nearest; nothing if it is all inside, or outside, or
  // nothing stands for some principals: these are `missing`.
  std::optional<Candidate> BindOriginal(const CollectionConnection& connection,
                                        const std::map<std::string, const PrincipalPart*>& fitted,
                                        std::set<std::string>& missing) const {
    const std::vector<std::string> names = connection.Principals();
    Candidate candidate{&connection, {}};
    std::vector<int> inside;
    for (const std::string& name : names) {
      const int part = ComponentPart(name);
      candidate.principals.push_back({part >= 0, part});
      if (part >= 0) inside.push_back(part);
    }
    if (inside.empty() || inside.size() == names.size()) return std::nullopt;
    std::set<int> taken;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (candidate.principals[i].of_component) continue;
      const auto its = fitted.find(names[i]);
      const std::string& item = connection.connection.elements[i].item;
      const BoundingBox& box =
          its == fitted.end() ? connection.connection.elements[i].box : its->second->box;
      const int part =
          NearestOfBody(item, box, inside, taken, connection.connection.connecting.empty());
      if (part < 0) missing.insert(names[i]);
      taken.insert(part);
      candidate.principals[i].part = part;
    }
    if (!missing.empty()) return std::nullopt;
    return candidate;
  }

  int NearestOfBody(const std::string& item, const BoundingBox& box, const std::vector<int>& inside,
                    const std::set<int>& taken, bool any_material) const {
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    for (const LinkedPair& pair : linked_) {
      if (taken.contains(pair.body)) continue;
      if (std::find(inside.begin(), inside.end(), pair.component) == inside.end()) continue;
      const PrincipalPart& part = sides_.body_parts[static_cast<std::size_t>(pair.body)];
      if (!any_material && !SameMaterial(item, part.item)) continue;
      const double distance = CornerDistance(box, part.box);
      if (distance < least) {
        least = distance;
        nearest = pair.body;
      }
    }
    return nearest;
  }

  using Pair = std::pair<int, int>;  // of the body, of the component

  static std::vector<Pair> PairsOf(const Candidate& candidate) {
    std::vector<Pair> pairs;
    for (const BoundPrincipal& a : candidate.principals) {
      for (const BoundPrincipal& b : candidate.principals) {
        if (!a.of_component && b.of_component) pairs.emplace_back(a.part, b.part);
      }
    }
    return pairs;
  }

  bool IsConnected(const Candidate& candidate) const {
    const std::vector<Pair> pairs = PairsOf(candidate);
    return std::all_of(pairs.begin(), pairs.end(),
                       [&](const Pair& pair) { return connected_.contains(pair); });
  }

  // Uses the connection if it can be used; says why not otherwise.
  std::string Try(const Candidate& candidate) {
    if (IsConnected(candidate)) return "";
    absl::StatusOr<OptimizedConnection> placed = Place(candidate, sides_);
    FittedSides fitted;
    if (placed.ok()) {
      fitted.sides = sides_;
    } else {
      absl::StatusOr<FittedSides> moved = MakeRoomFor(candidate);
      if (!moved.ok()) return std::string(placed.status().message());
      const FittedSides since = ChangesBetween(snapped_, moved->sides);
      if (since.moved_by > options_.most_moved || since.resized_by > options_.most_resized) {
        return absl::StrCat(placed.status().message(), "; parts would have to change by ",
                            Millimetres(since.moved_by), ", a size by ",
                            std::round(100 * since.resized_by), " %");
      }
      placed = Place(candidate, moved->sides);
      if (!placed.ok()) return std::string(placed.status().message());
      const std::vector<Candidate> all = UsedCandidates(candidate);
      const std::vector<SideOverlap> made =
          NewOverlaps(OverlapsBetween(sides_, all), OverlapsBetween(moved->sides, all));
      if (!made.empty()) return absl::StrCat("with room for it, ", Describe(made.front()));
      if (std::string clash = ClashOfUsed(moved->sides); !clash.empty()) {
        return absl::StrCat("with room for it, ", clash);
      }
      fitted = *std::move(moved);
    }
    if (std::string clash = ClashOf(candidate, *placed, fitted.sides); !clash.empty()) {
      return clash;
    }
    sides_ = std::move(fitted.sides);
    for (const Pair& pair : PairsOf(candidate)) connected_.insert(pair);
    used_.push_back({candidate, fitted.moved_by});
    return "";
  }

  // The connection between the parts as they are, if it holds.
  absl::StatusOr<OptimizedConnection> Place(const Candidate& candidate, const BothSides& sides) {
    MORTISE_ASSIGN_OR_RETURN(OptimizedConnection placed,
                             OptimizerOf(*candidate.from).Optimize(sides.BoxesOf(candidate)));
    const std::string loose = LooseHold(candidate.from->connection, placed, options_.hold);
    if (!loose.empty()) return PreconditionFailed("CONNECTION_LOOSE", loose);
    return placed;
  }

  // Both sides so that this connection has room, with those that are used already.
  absl::StatusOr<FittedSides> MakeRoomFor(const Candidate& candidate) const {
    return FitSides(sides_, UsedCandidates(candidate), options_.hold);
  }

  // The connections that are used, and one more if there is one.
  std::vector<Candidate> UsedCandidates(const std::optional<Candidate>& more = std::nullopt) const {
    std::vector<Candidate> all;
    for (const Used& used : used_) all.push_back(used.candidate);
    if (more) all.push_back(*more);
    return all;
  }

  const parametric::ConnectionOptimizer& OptimizerOf(const CollectionConnection& connection) {
    return optimizers_.try_emplace(&connection, connection.connection).first->second;
  }

  // Whether new parts would run into something else than what they connect: says into what.
  std::string ClashOf(const Candidate& candidate, const OptimizedConnection& placed,
                      const BothSides& sides) {
    std::set<std::string> body, component;  // names of what it connects
    for (const BoundPrincipal& bound : candidate.principals) {
      (bound.of_component ? component : body).insert(sides.PartOf(bound).name);
    }
    std::vector<SolidPart> made = SolidsOf(*candidate.from, placed);
    for (const auto& [design, own] :
         {std::pair(&sides.body, &body), std::pair(&sides.component, &component)}) {
      for (const SolidPart& solid : composer::SolidsOf(*design)) {
        if (own->contains(solid.name())) continue;
        for (const SolidPart& part : made) {
          const double depth = SolidPart::DepthOf(part, solid);
          if (depth > 0) return Clash(part, solid, depth);
        }
      }
    }
    for (const Used& known : used_) {
      if (&known.candidate == &candidate) continue;
      const auto its = Place(known.candidate, sides);
      if (!its.ok()) return std::string(its.status().message());
      for (const SolidPart& solid : SolidsOf(*known.candidate.from, *its)) {
        for (const SolidPart& part : made) {
          const double depth = SolidPart::DepthOf(part, solid);
          if (depth > 0) return Clash(part, solid, depth);
        }
      }
    }
    return "";
  }

  // The same of the connections that are used already, which move with the sides.
  std::string ClashOfUsed(const BothSides& sides) {
    for (const Used& known : used_) {
      const auto placed = Place(known.candidate, sides);
      if (!placed.ok()) return std::string(placed.status().message());
      if (std::string clash = ClashOf(known.candidate, *placed, sides); !clash.empty()) {
        return clash;
      }
    }
    return "";
  }

  static std::vector<SolidPart> SolidsOf(const CollectionConnection& from,
                                         const OptimizedConnection& placed) {
    std::vector<SolidPart> solids;
    for (const parametric::PlacedPart& part : placed.parts) {
      solids.emplace_back(part.name, part.box,
                          from.connection.elements[static_cast<std::size_t>(part.element)].shape,
                          part.stretch);
    }
    return solids;
  }

  static std::string Clash(const SolidPart& part, const SolidPart& solid, double depth) {
    return absl::StrCat("'", part.name(), "' would run ", Millimetres(depth), " into '",
                        solid.name(), "'");
  }

  // Whether a connection lets the component move: what a joint moves is held by that.
  bool IsJointed() const {
    return std::any_of(used_.begin(), used_.end(), [&](const Used& used) {
      return !used.candidate.from->connection.connecting.empty() &&
             JointOfComponent(used.candidate).has_value();
    });
  }

  // For each linked pair that nothing connects yet, the nearest of the collection.
  void UseOthers() {
    if (IsJointed()) {
      for (const auto& [pair, why] : refused_) {
        if (!connected_.contains(pair)) Warn(pair, WhyOfOriginal(why));
      }
      return;
    }
    std::vector<const CollectionConnection*> all = others_;
    if (original_ != nullptr) {
      for (const CollectionConnection& one : original_->connections) all.push_back(&one);
    }
    std::optional<ConnectionIndex> index;  // which takes some time, if it is needed
    std::vector<std::pair<LinkedPair, std::string>> left;
    for (const LinkedPair& pair : linked_) {
      if (connected_.contains({pair.body, pair.component})) continue;
      // Gaps are bridged for what is not held otherwise.
      if (pair.apart > tolerance_ && !used_.empty()) continue;
      const PrincipalPart& first = sides_.body_parts[static_cast<std::size_t>(pair.body)];
      const PrincipalPart& second =
          sides_.component_parts[static_cast<std::size_t>(pair.component)];
      const auto refused = refused_.find({pair.body, pair.component});
      std::string why = refused == refused_.end()
                            ? "nothing in the collection connects such parts of these materials"
                            : WhyOfOriginal(refused->second);
      if (!index) index.emplace(all, [this](const std::string& item) { return KindOf(item); });
      const std::vector<RankedConnection> nearest =
          index->Nearest(first, second, options_.fixed_size_weight, options_.candidates);
      for (const RankedConnection& ranked : nearest) {
        Candidate candidate{ranked.connection, {{false, pair.body}, {true, pair.component}}};
        if (ranked.exchanged) std::swap(candidate.principals[0], candidate.principals[1]);
        std::string because = Try(candidate);
        if (because.empty()) {
          why.clear();
          break;
        }
        if (&ranked != &nearest.front() || refused != refused_.end()) continue;
        why = absl::StrCat("the nearest of the collection, ", ranked.connection->connection.name,
                           " of ", ranked.connection->source, ", does not fit: ", because);
      }
      if (!why.empty()) left.emplace_back(pair, std::move(why));
    }
    for (const auto& [pair, why] : left) Warn({pair.body, pair.component}, why);
  }

  static std::string WhyOfOriginal(const std::string& why) {
    return absl::StrCat("the connection of the original design does not fit: ", why);
  }

  void Warn(const Pair& pair, const std::string& why) {
    const std::string& first = sides_.body_parts[static_cast<std::size_t>(pair.first)].name;
    const std::string& second = sides_.component_parts[static_cast<std::size_t>(pair.second)].name;
    warnings_.push_back(
        {first, second,
         absl::StrCat("nothing holds '", first, "' and '", second, "' together: ", why)});
  }

  // Whether the component would at least touch the model: what only has a gap to it hangs in the
  // air.
  absl::Status CheckHeld() const {
    const LinkedPair& nearest = linked_.front();
    if (!used_.empty() || nearest.apart <= tolerance_) return absl::OkStatus();
    return PreconditionFailed("NOTHING_HOLDS",
                              absl::StrCat("the component is ", Millimetres(nearest.apart),
                                           " from the model, and no connection bridges that: ",
                                           warnings_.empty() ? "" : warnings_.front().text));
  }

  // All connections in their places, now that both sides stand.
  absl::StatusOr<std::vector<UsedConnection>> PlaceAll() {
    std::vector<UsedConnection> placed;
    for (const Used& used : used_) {
      MORTISE_ASSIGN_OR_RETURN(OptimizedConnection made, Place(used.candidate, sides_));
      placed.push_back({used.candidate, std::move(made), used.moved_by});
    }
    return placed;
  }

  absl::Status CheckOverlap() const {
    const std::vector<SideOverlap> overlaps = OverlapsBetween(sides_, UsedCandidates());
    if (overlaps.empty()) return absl::OkStatus();
    return PreconditionFailed("COMPONENT_OVERLAPS", absl::StrCat(Describe(overlaps.front()),
                                                                 ": move it, or make it smaller"));
  }

  struct Used {
    Candidate candidate;
    double moved_by = 0;
  };

  BothSides sides_;
  const Original* original_;
  const std::vector<const CollectionConnection*>& others_;
  const ConnectOptions& options_;
  const double tolerance_;
  const BothSides snapped_;
  std::vector<LinkedPair> linked_;
  std::set<Pair> connected_;
  std::map<Pair, std::string> refused_;  // why the original's connection of a pair is not used
  std::vector<Used> used_;
  std::vector<ConnectionWarning> warnings_;
  std::map<const CollectionConnection*, parametric::ConnectionOptimizer> optimizers_;
  std::vector<std::unique_ptr<const CollectionConnection>> made_;  // what is left of others
};

}  // namespace

absl::StatusOr<Connected> Connect(const Design& body, const Design& component,
                                  const std::string& component_id, const Original* original,
                                  const std::vector<const CollectionConnection*>& others,
                                  const ConnectOptions& options) {
  return Connector(body, component, original, others, options).Connect(component_id);
}

}  // namespace mortise::composer
