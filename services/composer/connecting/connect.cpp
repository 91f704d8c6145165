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
#include "services/composer/connecting/component_motion.h"
#include "services/composer/connecting/connection_descriptor.h"
#include "services/composer/connecting/connection_warnings.h"
#include "services/composer/connecting/filled_space.h"
#include "services/composer/connecting/fit_programme.h"
#include "services/composer/connecting/hold.h"
#include "services/composer/connecting/linked_parts.h"
#include "services/composer/connecting/merge.h"
#include "services/composer/connecting/original_binding.h"
#include "services/composer/connecting/original_fit.h"
#include "services/composer/connecting/side_overlaps.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::ElementConnection;
using parametric::OptimizedConnection;
using enum LeftPair::Reason;

constexpr double kMinShared = 1e-6;  // m; parts that share less meet in an edge only

class Connector {
 public:
  Connector(const Design& body, const Design& component, const std::string& component_id,
            const Original* original, const std::vector<const CollectionConnection*>& others,
            const ConnectOptions& options)
      : sides_(SidesOf(body, component)),
        original_(original),
        others_(others),
        options_(options),
        tolerance_(std::max(body.assembly->tolerance(), component.assembly->tolerance())),
        snapped_(sides_),
        component_id_(component_id),
        motion_(sides_, component_id, original, options.item_kind_of) {}

  absl::StatusOr<ConnectTrial> Try() {
    MORTISE_RETURN_IF_ERROR(Find().status());
    return ConnectTrial{
        std::any_of(used_.begin(), used_.end(),
                    [](const Used& used) { return HasParts(*used.candidate.from); }),
        std::move(warnings_)};
  }

  absl::StatusOr<Connected> Connect() {
    MORTISE_ASSIGN_OR_RETURN(std::vector<UsedConnection> used, Find());
    MORTISE_ASSIGN_OR_RETURN(Merged merged, Merge(sides_, component_id_, used));
    Connected connected;
    connected.parts = std::move(merged.parts);
    connected.joints = std::move(merged.joints);
    connected.connections = std::move(merged.connections);
    connected.group = std::move(merged.group);
    connected.insert_below = std::move(merged.insert_below);
    connected.warnings = std::move(warnings_);
    const auto rename = [&](std::string& part) {
      const auto renamed = merged.component_names.find(part);
      if (renamed != merged.component_names.end()) part = renamed->second;
    };
    for (ConnectionWarning& warning : connected.warnings) {
      rename(warning.second);
      for (auto& [first, second] : warning.others) rename(second);
    }
    MORTISE_ASSIGN_OR_RETURN(
        connected.model, AsDrawn(std::move(merged.assembly),
                                 {sides_.body.assembly.get(), sides_.component.assembly.get()}));
    return connected;
  }

 private:
  // Finds what connects the two, and puts it in its place.
  absl::StatusOr<std::vector<UsedConnection>> Find() {
    MORTISE_RETURN_IF_ERROR(FindLinked());
    if (original_ != nullptr) {
      MORTISE_RETURN_IF_ERROR(UseOriginal());
    }
    UseOthers();
    MORTISE_RETURN_IF_ERROR(CheckHeld());
    MORTISE_ASSIGN_OR_RETURN(std::vector<UsedConnection> used, PlaceAll());
    MORTISE_RETURN_IF_ERROR(CheckOverlap());
    return used;
  }

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
    const LinkedPair nearest = NearestParts(sides_.body_parts, sides_.component_parts);
    return PreconditionFailed(
        "NOTHING_NEAR",
        absl::StrCat("no part of the model lies against the component: '", NameOf(true, nearest),
                     "' is ", Millimetres(nearest.apart), " from '", NameOf(false, nearest),
                     "', the nearest; move it there, or snap it, first"));
  }

  // What a part of a pair is called.
  const std::string& NameOf(bool of_component, const LinkedPair& pair) const {
    return sides_.PartOf({of_component, of_component ? pair.component : pair.body}).name;
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
      for (const CollectionConnection& connection : *original_->connections) {
        std::set<std::string> missing;
        const std::optional<Candidate> candidate = Bind(connection, by_name, missing);
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
    for (const PartPair& pair : PairsOf(candidate)) {
      if (AreLinked(pair.first, pair.second)) refused_.try_emplace(pair, why);
    }
  }

  bool IsRefused(const Candidate& candidate) const {
    const std::vector<PartPair> pairs = PairsOf(candidate);
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const PartPair& pair) { return refused_.contains(pair); });
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
      const std::optional<Candidate> candidate = Bind(*made_.back(), by_name, still_missing);
      if (candidate && (with_parts || !IsRefused(*candidate))) TryOriginal(*candidate);
    }
    return absl::OkStatus();
  }

  std::optional<Candidate> Bind(const CollectionConnection& connection,
                                const std::map<std::string, const PrincipalPart*>& fitted,
                                std::set<std::string>& missing) const {
    return BindOriginal(
        connection, sides_, linked_, fitted,
        [this](const std::string& a, const std::string& b) { return SameMaterial(a, b); }, missing);
  }

  static std::vector<PartPair> PairsOf(const Candidate& candidate) {
    std::vector<PartPair> pairs;
    for (const BoundPrincipal& a : candidate.principals) {
      for (const BoundPrincipal& b : candidate.principals) {
        if (!a.of_component && b.of_component) pairs.emplace_back(a.part, b.part);
      }
    }
    return pairs;
  }

  bool IsConnected(const Candidate& candidate) const {
    const std::vector<PartPair> pairs = PairsOf(candidate);
    return std::all_of(pairs.begin(), pairs.end(),
                       [&](const PartPair& pair) { return connected_.contains(pair); });
  }

  // Uses the connection if it can be used; says why not otherwise.
  std::string Try(const Candidate& candidate) {
    if (IsConnected(candidate)) return "";
    if (std::string why = motion_.WhyNotHeld(candidate, sides_); !why.empty()) return why;
    absl::StatusOr<OptimizedConnection> placed = Place(candidate, sides_);
    std::optional<Room> room;
    if (!placed.ok()) {
      room.emplace();
      if (std::string why = MakeRoomFor(candidate, placed.status(), &*room); !why.empty()) {
        return why;
      }
      placed = std::move(room->placed);
    }
    FilledSpace& space = room ? *room->space : Space();
    const BothSides& sides = room ? room->sides : sides_;
    if (std::string clash = space.ClashOf(candidate, *placed, sides); !clash.empty()) return clash;
    if (std::string why = motion_.WhyNotMoved(candidate, *placed); !why.empty()) return why;
    space.Add(candidate, *placed);
    if (room) {
      sides_ = std::move(room->sides);
      space_ = std::move(room->space);
    }
    for (const PartPair& pair : PairsOf(candidate)) connected_.insert(pair);
    used_.push_back({candidate, room ? room->moved_by : 0});
    motion_.Take(candidate, *placed);
    return "";
  }

  // Both sides after a change, with the connections that are used in their places.
  struct Room {
    BothSides sides;
    OptimizedConnection placed;  // the new one
    std::optional<FilledSpace> space;
    double moved_by = 0;
  };

  // Makes room for a connection that cannot be placed; says why not, where that cannot be done.
  std::string MakeRoomFor(const Candidate& candidate, const absl::Status& unplaced, Room* room) {
    const std::string why(unplaced.message());
    if (!spaces_) spaces_.emplace(FitSpacesOf(sides_));
    absl::StatusOr<FittedSides> moved =
        FitSides(sides_, *spaces_, UsedCandidates(candidate), options_.hold);
    if (!moved.ok()) return why;
    const FittedSides since = ChangesBetween(snapped_, moved->sides);
    if (since.moved_by > options_.most_moved || since.resized_by > options_.most_resized) {
      return absl::StrCat(why, "; parts would have to change by ", Millimetres(since.moved_by),
                          ", a size by ", std::round(100 * since.resized_by), " %");
    }
    auto placed = Place(candidate, moved->sides);
    if (!placed.ok()) return std::string(placed.status().message());
    const std::vector<Candidate> all = UsedCandidates(candidate);
    FilledSpace space(moved->sides);
    const std::vector<SideOverlap> made = NewOverlaps(
        Unwanted(Space().Overlaps(), sides_, all), Unwanted(space.Overlaps(), moved->sides, all));
    if (!made.empty()) return absl::StrCat("with room for it, ", Describe(made.front()));
    for (const Used& known : used_) {
      const auto its = Place(known.candidate, moved->sides);
      const std::string clash = its.ok() ? space.ClashOf(known.candidate, *its, moved->sides)
                                         : std::string(its.status().message());
      if (!clash.empty()) return absl::StrCat("with room for it, ", clash);
      space.Add(known.candidate, *its);
    }
    *room = {std::move(moved->sides), *std::move(placed), std::move(space), moved->moved_by};
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

  // What fills space now.
  FilledSpace& Space() {
    if (!space_) space_.emplace(sides_);
    return *space_;
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

  // For each linked pair that nothing connects yet, the nearest of the collection.
  void UseOthers() {
    std::vector<LeftPair> left;
    if (motion_.IsLetMove()) {  // what a joint moves is held by that
      for (const auto& [pair, why] : refused_) {
        if (connected_.contains(pair) || !MayFasten(pair)) continue;
        left.push_back(Left(pair, kOriginal, why));
      }
      warnings_ = WarningsOf(left);
      return;
    }
    // It is not enough that what is to move touches: pairs that are only so need a connection
    // still.
    if (motion_.wanted().moves) connected_.clear();
    std::vector<const CollectionConnection*> all = others_;
    if (original_ != nullptr) {
      for (const CollectionConnection& one : *original_->connections) all.push_back(&one);
    }
    std::optional<ConnectionIndex> index;  // which takes some time, if it is needed
    for (const LinkedPair& linked : PairsToFasten()) {
      const PartPair pair(linked.body, linked.component);
      if (connected_.contains(pair) || !MayFasten(pair)) continue;
      // Gaps are bridged for what is not held otherwise, or what moves, as on two slides.
      if (linked.apart > tolerance_ && !used_.empty() && !motion_.wanted().moves) continue;
      if (!index) {
        index.emplace(
            all, [this](const std::string& item) { return KindOf(item); }, options_.item_kind_of);
      }
      if (std::optional<LeftPair> one = UseNearest(*index, pair)) left.push_back(*std::move(one));
    }
    if (!motion_.wanted().moves) {
      warnings_ = WarningsOf(left);
    } else if (!motion_.IsLetMove() && !left.empty()) {
      warnings_ = {WarningOfMotion(left, component_id_, motion_.wanted())};
    }
  }

  bool MayFasten(const PartPair& pair) const {
    return motion_.frames().MayFasten(pair.first, pair.second);
  }

  // The linked pairs, those that neither side's joints move first. Where any of these touch, what
  // moves is not fastened.
  std::vector<LinkedPair> PairsToFasten() const {
    std::vector<LinkedPair> pairs = linked_;
    const auto moved =
        std::stable_partition(pairs.begin(), pairs.end(), [&](const LinkedPair& pair) {
          return motion_.frames().BothStay(pair.body, pair.component);
        });
    if (std::any_of(pairs.begin(), moved,
                    [&](const LinkedPair& pair) { return pair.apart <= tolerance_; })) {
      pairs.erase(moved, pairs.end());
    }
    return pairs;
  }

  // Uses the nearest connection of the collection that can be used for a pair; says what is left
  // otherwise.
  std::optional<LeftPair> UseNearest(ConnectionIndex& index, const PartPair& pair) {
    const PrincipalPart& first = sides_.body_parts[static_cast<std::size_t>(pair.first)];
    const PrincipalPart& second = sides_.component_parts[static_cast<std::size_t>(pair.second)];
    const auto refused = refused_.find(pair);
    std::optional<LeftPair> left;
    if (refused != refused_.end()) left = Left(pair, kOriginal, refused->second);
    for (const RankedConnection& ranked : index.Nearest(
             first, second, motion_.wanted(), options_.fixed_size_weight, options_.candidates)) {
      const std::string because = TryRanked(ranked, pair);
      if (because.empty()) return std::nullopt;
      if (left) continue;
      left = Left(pair, kNearest,
                  absl::StrCat(ranked.connection->connection.name, " of ",
                               ranked.connection->source, ", does not fit: ", because));
    }
    return left ? left : Left(pair, kNoSuch, "");
  }

  std::string TryRanked(const RankedConnection& ranked, const PartPair& pair) {
    const CollectionConnection* from = ranked.connection;
    const std::vector<std::string> names = from->Principals();
    const std::string& first = names[static_cast<std::size_t>(ranked.first)];
    if (names.size() > 2) {
      auto rest = ConnectionsAmong(*from, {first, names[static_cast<std::size_t>(ranked.second)]});
      if (!rest.ok()) return std::string(rest.status().message());
      std::erase_if(*rest, [](const CollectionConnection& one) { return !HasParts(one); });
      if (rest->empty()) return "nothing of it is between two such parts alone";
      made_.push_back(std::make_unique<const CollectionConnection>(std::move(rest->front())));
      from = made_.back().get();
    }
    Candidate candidate{from, {{false, pair.first}, {true, pair.second}}};
    if (from->Principals().front() != first) {
      std::swap(candidate.principals[0], candidate.principals[1]);
    }
    return Try(candidate);
  }

  LeftPair Left(const PartPair& pair, LeftPair::Reason reason, const std::string& why) const {
    return {reason, sides_.body_parts[static_cast<std::size_t>(pair.first)].name,
            sides_.component_parts[static_cast<std::size_t>(pair.second)].name, why};
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
      placed.push_back(
          {used.candidate, std::move(made), used.moved_by, motion_.BringsJoint(used.candidate)});
    }
    return placed;
  }

  absl::Status CheckOverlap() {
    const std::vector<SideOverlap> overlaps =
        Unwanted(Space().Overlaps(), sides_, UsedCandidates());
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
  const std::string& component_id_;
  ComponentMotion motion_;
  std::optional<FilledSpace> space_;  // of sides_ and what is used, once it is needed
  std::optional<FitSpaces> spaces_;   // of sides_, once they are needed
  std::vector<LinkedPair> linked_;
  std::set<PartPair> connected_;
  std::map<PartPair, std::string> refused_;  // why the original's connection of a pair is not used
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
  return Connector(body, component, component_id, original, others, options).Connect();
}

absl::StatusOr<ConnectTrial> TryToConnect(const Design& body, const Design& component,
                                          const std::string& component_id, const Original* original,
                                          const std::vector<const CollectionConnection*>& others,
                                          const ConnectOptions& options) {
  return Connector(body, component, component_id, original, others, options).Try();
}

}  // namespace mortise::composer
