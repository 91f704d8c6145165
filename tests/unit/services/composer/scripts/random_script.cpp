#include "tests/unit/services/composer/scripts/random_script.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/composer/connecting/connect.h"
#include "services/composer/model/controls.h"
#include "services/composer/model/overlap.h"
#include "services/composer/model/removal.h"
#include "services/composer/snapping/snap.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::PlacedPart;

constexpr double kHolds = 1e-6;  // m, within which relationships hold

struct LoosePiece {
  std::string id, from, node;  // node of the design `from`
  Design design;
  bool snapped = false;
};

struct State {
  std::optional<Design> body;
  ShippedOrigins parts, joints;  // of the body
  std::vector<LoosePiece> loose;
  std::set<std::string> excused;  // elements that need no connection: warned of, or drawn without
};

bool Same(const Design& a, const Design& b) {
  const std::vector<PlacedPart> first = PartsOf(a), second = PartsOf(b);
  return a.q == b.q && a.shift == b.shift &&
         std::equal(first.begin(), first.end(), second.begin(), second.end(),
                    [](const PlacedPart& one, const PlacedPart& other) {
                      return one.name == other.name && one.box.minimum == other.box.minimum &&
                             one.box.maximum == other.box.maximum;
                    });
}

bool Same(const State& a, const State& b) {
  if (a.body.has_value() != b.body.has_value() || a.loose.size() != b.loose.size()) return false;
  if (a.body && !Same(*a.body, *b.body)) return false;
  for (std::size_t i = 0; i < a.loose.size(); ++i) {
    if (a.loose[i].id != b.loose[i].id || !Same(a.loose[i].design, b.loose[i].design)) return false;
  }
  return true;
}

using Command = std::function<absl::StatusOr<State>(const State&)>;

class Script {
 public:
  explicit Script(const RandomScriptOptions& options) : options_(options), random_(options.seed) {}

  ScriptOutcome Run() {
    for (int step = 0; step < options_.steps; ++step) TakeStep();
    const State& end = Present();
    if (end.body) {
      outcome_.parts = PartsOf(*end.body).size();
      outcome_.body = ComposedBody{*end.body, end.parts, end.joints};
    }
    return std::move(outcome_);
  }

 private:
  struct Step {
    Command command;
    State state;
  };

  const State& Present() const { return now_ == 0 ? empty_ : history_[now_ - 1].state; }
  std::size_t Below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  double Share() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  bool Chance(double share) { return Share() < share; }

  void TakeStep() {
    const State& state = Present();
    if (now_ < history_.size() && Chance(0.6)) return Redo();
    if (!state.body) return Add();
    if (!state.loose.empty() && Chance(0.75)) {
      const std::size_t piece = AnyLoose();
      // Most are connected once they have snapped.
      const bool connects = state.loose[piece].snapped == Chance(0.9);
      if (Chance(0.85)) return connects ? Connect(piece) : Snap(piece);
      return Chance(0.5) ? Move(piece) : DragLoose(piece);
    }
    const double what = Share();
    if (what < 0.45 && state.loose.size() < 3) return Add();
    if (what < 0.7) return DragBody();
    if (what < 0.8) return Remove();
    Undo();
  }

  // Does a command, and notes what came of it.
  void Do(const std::string& name, const std::string& what, const Command& command) {
    step_ = absl::StrCat(name, " ", what);
    const auto began = std::chrono::steady_clock::now();
    absl::StatusOr<State> made = command(Present());
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - began;
    outcome_.seconds[name] += spent.count();
    if (!made.ok()) return Refused(name, made.status());
    ++outcome_.done[name];
    outcome_.steps.push_back(step_);
    history_.resize(now_);
    history_.push_back({command, *std::move(made)});
    ++now_;
    Check();
  }

  void Refused(const std::string& name, const absl::Status& status) {
    const std::string reason = DetailOf(status).reason;
    ++outcome_.refused[absl::StrCat(name, ": ", reason)];
    outcome_.steps.push_back(absl::StrCat(step_, ": ", status.message()));
    const bool is_told = absl::IsFailedPrecondition(status) || absl::IsInvalidArgument(status);
    if (reason.empty() || !is_told) Violated(absl::StrCat("no reason: ", status.ToString()));
  }

  void Violated(const std::string& text) {
    outcome_.violations.push_back(
        absl::StrCat("step ", outcome_.steps.size(), ", ", step_, ": ", text));
  }

  // ---- Commands ---------------------------------------------------------------------------------

  // A node of a design that ships: a group, a part, a row, or all of it.
  std::pair<std::string, std::string> AnyNode() {
    const std::vector<std::string> ids = parametric::ShippedAssemblyIds();
    const std::string& id = ids[Below(ids.size())];
    const std::vector<std::string> nodes = NodesOf(id, Present().body.has_value());
    if (nodes.empty() || Chance(0.05)) return {id, ""};
    return {id, nodes[Below(nodes.size())]};
  }

  static std::vector<std::string> NodesOf(const std::string& id, bool elements) {
    const parametric::ParametricAssembly& design = *ShippedDesign(id).assembly;
    std::vector<std::string> nodes = parametric::DistinctSubTrees(design.assembly());
    if (!elements) return nodes;
    for (const parametric::Element& element : design.elements()) {
      if (!element.connecting) nodes.push_back(element.name);
    }
    return nodes;
  }

  // A node of the design that the body began with, of which nothing is in the body; empty if there
  // is none.
  std::string AnyMissingNode() {
    std::set<std::string> there;
    for (const PlacedPart& part : PartsOf(*Present().body)) there.insert(part.name);
    std::vector<std::string> missing;
    for (const std::string& node : NodesOf(body_from_, true)) {
      const auto parts =
          parametric::PartsOfNode(ShippedDesign(body_from_).assembly->assembly(), node);
      const bool is_there = std::any_of(parts->begin(), parts->end(), [&](const std::string& each) {
        return there.contains(each);
      });
      if (!is_there) missing.push_back(node);
    }
    return missing.empty() ? "" : missing[Below(missing.size())];
  }

  void Add() {
    // Two of three are missing pieces of the design that the body began with, near their places.
    auto [id, node] = AnyNode();
    const std::string missing = Present().body && Chance(0.67) ? AnyMissingNode() : "";
    const bool is_own = !missing.empty();
    if (is_own) std::tie(id, node) = std::pair(body_from_, missing);
    const std::string name = absl::StrCat("c", ++added_);
    const std::uint64_t where = random_();
    const std::size_t most = options_.most_parts;
    if (!Present().body) body_from_ = id;
    Do("add", absl::StrCat(node, " of ", id),
       [=, id = id, node = node](const State& state) -> absl::StatusOr<State> {
         MORTISE_ASSIGN_OR_RETURN(
             parametric::Assembly part,
             parametric::SubTreeOf(ShippedDesign(id).assembly->assembly(), node));
         MORTISE_ASSIGN_OR_RETURN(Design piece, AsDrawn(std::move(part)));
         State next = state;
         std::size_t parts = PartsOf(piece).size();
         if (state.body) parts += PartsOf(*state.body).size();
         if (parts > most)
           return PreconditionFailed("TOO_MANY_PARTS", "the model would be too large");
         if (!state.body) {
           next.parts = OriginsIn(piece.assembly->assembly().parts, id);
           next.joints = OriginsIn(piece.assembly->assembly().joints, id);
           next.body = std::move(piece);
           for (const std::string& each : Unconnected(*next.body)) next.excused.insert(each);
         } else {
           next.loose.push_back({name, id, node,
                                 is_own ? Jittered(std::move(piece), where)
                                        : DroppedNear(std::move(piece), *state.body, where)});
         }
         return next;
       });
  }

  // Up to 2 cm off along each axis.
  static Design Jittered(Design piece, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (Eigen::Index i = 0; i < 3; ++i) {
      piece.shift[i] += 0.02 * (static_cast<double>(random() % 1000) / 500 - 1);
    }
    return piece;
  }

  // Onto, below or beside a part of the body, up to 2 cm off.
  static Design DroppedNear(Design piece, const Design& body, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const std::vector<PlacedPart> parts = PartsOf(body);
    const BoundingBox& target = parts[random() % parts.size()].box;
    const auto axis = static_cast<Eigen::Index>(random() % 3);
    const double side = random() % 2 == 0 ? 1 : -1;
    Eigen::Vector3d middle = target.center();
    middle[axis] += side * (target.size()[axis] + BoundsOf(piece).size()[axis]) / 2;
    return Jittered(DroppedAt(std::move(piece), middle), random());
  }

  std::size_t AnyLoose() { return Below(Present().loose.size()); }

  void Snap(std::size_t i) {
    Do("snap", Present().loose[i].id, [i](const State& state) -> absl::StatusOr<State> {
      State next = state;
      LoosePiece& piece = next.loose[i];
      std::optional<Original> original;
      if (!piece.node.empty()) original = ShippedOriginal(piece.from);
      MORTISE_ASSIGN_OR_RETURN(
          Snapped snapped,
          composer::Snap(piece.design, original ? &original->design : nullptr, *state.body));
      piece.design = std::move(snapped.component);
      piece.snapped = true;
      return next;
    });
  }

  void Connect(std::size_t i) {
    Do("connect", Present().loose[i].id, [i, this](const State& state) -> absl::StatusOr<State> {
      State next = state;
      const LoosePiece& piece = state.loose[i];
      std::optional<Original> original;
      if (!piece.node.empty()) original = ShippedOriginal(piece.from);
      MORTISE_ASSIGN_OR_RETURN(
          Connected made,
          composer::Connect(*state.body, piece.design, piece.id, original ? &*original : nullptr,
                            AllShippedConnections(), ShippedOptions()));
      CheckConnected(made);
      TakeNames(made, piece.design, &next);
      const parametric::Assembly& merged = made.model.assembly->assembly();
      next.parts = OriginsOf(merged.parts, made.parts, state.parts, piece.from);
      next.joints = OriginsOf(merged.joints, made.joints, state.joints, piece.from);
      next.body = std::move(made.model);
      next.loose.erase(next.loose.begin() + static_cast<std::ptrdiff_t>(i));
      return next;
    });
  }

  void Move(std::size_t i) {
    const std::uint64_t where = random_();
    Do("move", Present().loose[i].id, [i, where](const State& state) -> absl::StatusOr<State> {
      State next = state;
      next.loose[i].design = DroppedNear(next.loose[i].design, *state.body, where);
      next.loose[i].snapped = false;
      return next;
    });
  }

  // A node of a design, as people may name them.
  std::string AnyNodeIn(const Design& design) {
    std::vector<std::string> nodes = {""};
    const auto& groups = design.assembly->assembly().groups;
    for (std::size_t i = 1; i < groups.size(); ++i) nodes.push_back(groups[i].name);
    for (const parametric::Element& element : design.assembly->elements()) {
      if (!element.connecting) nodes.push_back(element.name);
    }
    return nodes[Below(nodes.size())];
  }

  // Drags any control of a node anywhere in its range, and beyond.
  static absl::StatusOr<Design> Dragged(const Design& design, const std::string& node,
                                        std::size_t which, double share) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<Control> controls, ControlsOf(design, node));
    if (controls.empty()) return PreconditionFailed("NO_CONTROLS", "nothing can be dragged");
    const Control& control = controls[which % controls.size()];
    const double value = control.minimum + share * (control.maximum - control.minimum);
    return Drag(design, node, control.kind, control.axis, value);
  }

  void DragBody() {
    const std::string node = AnyNodeIn(*Present().body);
    const std::size_t which = Below(6);
    const double share = 1.2 * Share() - 0.1;
    Do("drag", node, [=](const State& state) -> absl::StatusOr<State> {
      State next = state;
      MORTISE_ASSIGN_OR_RETURN(next.body, Dragged(*state.body, node, which, share));
      return next;
    });
  }

  void DragLoose(std::size_t i) {
    const std::string node = AnyNodeIn(Present().loose[i].design);
    const std::size_t which = Below(6);
    const double share = 1.2 * Share() - 0.1;
    Do("drag", absl::StrCat(node, " of ", Present().loose[i].id),
       [=](const State& state) -> absl::StatusOr<State> {
         State next = state;
         MORTISE_ASSIGN_OR_RETURN(next.loose[i].design,
                                  Dragged(state.loose[i].design, node, which, share));
         next.loose[i].snapped = false;
         return next;
       });
  }

  void Remove() {
    const std::string node = AnyNodeIn(*Present().body);
    Do("remove", node, [node, this](const State& state) -> absl::StatusOr<State> {
      if (node.empty()) return InvalidField("node", "is empty");
      State next = state;
      MORTISE_ASSIGN_OR_RETURN(parametric::Assembly rest, WithoutNode(*state.body, node));
      MORTISE_ASSIGN_OR_RETURN(const Redrawn redrawn, Redraw(*state.body));
      next.parts = OriginsOf(redrawn, state.parts);
      MORTISE_ASSIGN_OR_RETURN(next.body, AsDrawn(std::move(rest)));
      for (const std::string& each : Unconnected(*next.body)) {
        outcome_.left_unheld += next.excused.insert(each).second ? 1 : 0;
      }
      return next;
    });
  }

  void Undo() {
    --now_;
    ++outcome_.done["undo"];
    outcome_.steps.emplace_back("undo");
  }

  // Does again what was undone, from the state that it was done from.
  void Redo() {
    const Step& step = history_[now_];
    step_ = "redo";
    const absl::StatusOr<State> again = step.command(Present());
    ++now_;
    ++outcome_.done["redo"];
    outcome_.steps.emplace_back("redo");
    if (!again.ok() || !Same(*again, step.state)) Violated("done again, it is another state");
  }

  // ---- What must be true ------------------------------------------------------------------------

  void Check() {
    const State& state = Present();
    for (const LoosePiece& piece : state.loose) CheckRelationships(piece.design, piece.id);
    if (!state.body) return;
    CheckRelationships(*state.body, "the body");
    CheckPenetration(*state.body);
    for (const std::string& name : Unconnected(*state.body)) {
      if (!state.excused.contains(name)) Violated(absl::StrCat("nothing connects ", name));
    }
  }

  void CheckRelationships(const Design& design, const std::string& what) {
    for (const auto& each : design.assembly->feasible_set().Violations(design.q, kHolds)) {
      Violated(absl::StrCat(what, " does not keep to ", each.description, ", by ",
                            1000 * each.amount, " mm"));
    }
  }

  void CheckPenetration(const Design& body) {
    const auto faults = body.assembly->FaultsAt(body.q);
    if (!faults.ok()) return Violated(faults.status().ToString());
    for (const parametric::ContactFault& fault : *faults) Violated(parametric::Describe(fault));
  }

  // The principal parts that are in no connection, where there are several.
  static std::vector<std::string> Unconnected(const Design& design) {
    std::set<int> connected;
    for (const parametric::ElementConnection& each : design.assembly->connections()) {
      connected.insert(each.principals.begin(), each.principals.end());
    }
    std::vector<std::string> names;
    const auto& elements = design.assembly->elements();
    int principals = 0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (elements[i].connecting) continue;
      ++principals;
      if (connected.contains(static_cast<int>(i))) continue;
      for (const int part : elements[i].parts) {
        names.push_back(design.assembly->assembly().parts[static_cast<std::size_t>(part)].name);
      }
    }
    if (principals < 2 && names.size() < 2) names.clear();  // a part alone, and no row
    return names;
  }

  // Who needs no connection in what comes out: who did not before, and who is warned of.
  static void TakeNames(const Connected& made, const Design& piece, State* next) {
    const auto& parts = made.model.assembly->assembly().parts;
    const std::vector<std::string> alone = Unconnected(piece);
    std::set<std::string> of_piece(alone.begin(), alone.end());
    std::set<std::string> of_body = std::exchange(next->excused, {});
    for (const ConnectionWarning& warning : made.warnings) {
      of_body.insert(warning.first);
      of_piece.insert(warning.second);
      for (const auto& [first, second] : warning.others) {
        of_body.insert(first);
        of_piece.insert(second);
      }
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Provenance& from = made.parts[i];
      const bool is_excused =
          (from.from == Provenance::From::kBody && of_body.contains(from.name)) ||
          (from.from == Provenance::From::kComponent && of_piece.contains(from.name));
      if (is_excused) next->excused.insert(parts[i].name);
    }
  }

  // Nothing new in anything that it does not connect, and nothing of the piece in the body.
  void CheckConnected(const Connected& made) {
    const auto& parts = made.model.assembly->assembly().parts;
    std::map<std::string, std::set<std::string>> together;  // by part: who shares its connections
    for (const MadeConnection& connection : made.connections) {
      std::set<std::string> all(connection.principals.begin(), connection.principals.end());
      all.insert(connection.parts.begin(), connection.parts.end());
      for (const std::string& name : all) together[name].insert(all.begin(), all.end());
      outcome_.made_connections += connection.parts.empty() ? 0 : 1;
    }
    std::vector<SolidPart> solids;
    for (const parametric::AssemblyPart& part : parts) solids.emplace_back(part);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (made.parts[i].from == made.parts[j].from &&
            made.parts[i].from != Provenance::From::kConnection) {
          continue;
        }
        if (together[parts[i].name].contains(parts[j].name)) continue;
        const double depth = SolidPart::DepthOf(solids[i], solids[j]);
        if (depth == 0) continue;
        Violated(
            absl::StrCat(parts[i].name, " reaches ", 1000 * depth, " mm into ", parts[j].name));
      }
    }
  }

  const RandomScriptOptions options_;
  std::mt19937_64 random_;
  const State empty_;
  std::vector<Step> history_;
  std::size_t now_ = 0;  // steps that are not undone
  int added_ = 0;
  std::string body_from_;  // the design of the first piece
  std::string step_;
  ScriptOutcome outcome_;
};

}  // namespace

ScriptOutcome RunRandomScript(const RandomScriptOptions& options) { return Script(options).Run(); }

}  // namespace mortise::composer
