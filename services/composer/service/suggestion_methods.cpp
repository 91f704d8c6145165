#include "services/composer/service/suggestion_methods.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "common/assembly/assembly_design.h"
#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/identifiers.h"
#include "common/design/costs/design_bill.h"
#include "common/design/template_validation.h"
#include "common/files/axis_codec.h"
#include "common/messages/vector_codec.h"
#include "services/composer/model/quarter_turn.h"
#include "services/composer/service/bundle_contents.h"
#include "services/composer/service/connecting_sources.h"
#include "services/composer/service/open_model.h"
#include "services/composer/suggestions/patience.h"
#include "services/composer/suggestions/suggest.h"
#include "services/composer/suggestions/try_suggestion.h"

namespace mortise::composer::methods {
namespace {

constexpr int kMaxCount = 50;
constexpr int kUsualCount = 10;
constexpr int kMaxItems = 1000;
constexpr int kMaxMaterials = 100;

template <typename Names>
void CheckNames(const Names& names, const std::string& field, int most,
                std::vector<FieldViolation>& findings) {
  if (names.size() > most) findings.push_back({field, absl::StrCat("are more than ", most)});
  for (int i = 0; i < std::min(names.size(), most); ++i) {
    if (ParseResourceName(names.Get(i), field, field).ok()) continue;
    findings.push_back({absl::StrCat(field, "[", i, "]"), absl::StrCat("is no ", field, "/{id}")});
  }
}

absl::Status CheckAsked(const v1::SuggestComponentsRequest& asked) {
  std::vector<FieldViolation> findings;
  CheckNames(asked.items(), "items", kMaxItems, findings);
  CheckNames(asked.materials(), "materials", kMaxMaterials, findings);
  if (asked.max_price() < 0) findings.push_back({"max_price", "must not be less than 0"});
  if (asked.count() < 0 || asked.count() > kMaxCount) {
    findings.push_back({"count", absl::StrCat("must be 1 to ", kMaxCount)});
  }
  return parametric::ToStatus(findings);
}

// A component of the collection, and what it is made of.
struct Component {
  std::shared_ptr<const parametric::ParametricAssembly> assembly;
  std::optional<parametric::Cost> price;  // if all of it is known, in one currency
};

// Components as they are asked for: those that can be added to a model, within what is asked.
class Components {
 public:
  Components(const v1::SuggestComponentsRequest& asked, const ConnectionOrigins& sources,
             ModelDrawings& drawings, IsGivenUp is_given_up)
      : asked_(asked),
        items_(asked.items().begin(), asked.items().end()),
        materials_(asked.materials().begin(), asked.materials().end()),
        sources_(sources),
        drawings_(drawings),
        is_given_up_(std::move(is_given_up)) {}

  absl::StatusOr<const parametric::Assembly*> Get(const std::string& assembly,
                                                  const std::string& node) {
    const std::pair key(assembly, node);
    if (!known_.contains(key)) known_.emplace(key, Read(assembly, node));
    const absl::StatusOr<Component>& component = known_.at(key);
    if (!component.ok()) return component.status();
    return &component->assembly->assembly();
  }

  // Of one that Get has given.
  const std::optional<parametric::Cost>& PriceOf(const std::string& assembly,
                                                 const std::string& node) const {
    return known_.at({assembly, node})->price;
  }

 private:
  absl::StatusOr<Component> Read(const std::string& assembly, const std::string& node) {
    const Drawing& drawing = *sources_.at(assembly).drawing;
    Component component;
    MORTISE_ASSIGN_OR_RETURN(component.assembly,
                             drawings_.Parametrize(drawing, node, is_given_up_));
    MORTISE_ASSIGN_OR_RETURN(const BundleContents contents, ContentsOf(drawing.bundle));
    const parametric::DesignBill bill = parametric::BillOf(
        parametric::DesignAt(*component.assembly, component.assembly->drawn(), contents.items, {}),
        contents.items);
    if (bill.unpriced == 0 && bill.totals.size() == 1) component.price = bill.totals.front();
    if (asked_.max_price() > 0 &&
        (!component.price || component.price->amount > asked_.max_price())) {
      return absl::NotFoundError("costs too much");
    }
    for (const parametric::BillLine& line : bill.lines) {
      if (!IsAtHand(line.item, contents)) return absl::NotFoundError("is not at hand");
    }
    return component;
  }

  bool IsAtHand(const std::string& name, const BundleContents& contents) const {
    if (items_.empty() && materials_.empty()) return true;
    const parametric::Item* const item = parametric::FindItem(contents.items, name);
    return items_.contains(name) || (item != nullptr && materials_.contains(item->material));
  }

  const v1::SuggestComponentsRequest& asked_;
  const std::set<std::string> items_, materials_;
  const ConnectionOrigins& sources_;
  ModelDrawings& drawings_;
  const IsGivenUp is_given_up_;
  std::map<std::pair<std::string, std::string>, absl::StatusOr<Component>> known_;
};

// Drops, snaps and connects what is suggested, as AddComponent, SnapComponent and ConnectComponent
// would.
class Trials {
 public:
  // All outlive it. `turns` are those of the model's components.
  Trials(const Design& body, const Drawing& drawing, std::vector<Eigen::Matrix3d> turns,
         const ConnectionOrigins& sources, const Composer& composer, const IsGivenUp& is_given_up)
      : body_(body),
        drawing_(drawing),
        turns_(std::move(turns)),
        sources_(sources),
        composer_(composer),
        is_given_up_(is_given_up) {}

  // What becomes of it; it is not tried where it cannot be had, or nobody waits any more.
  SuggestionTrial Try(const Suggestion& suggestion) {
    absl::StatusOr<SuggestionTrial> trial = Made(suggestion);
    return trial.ok() ? *std::move(trial) : SuggestionTrial();
  }

 private:
  absl::StatusOr<SuggestionTrial> Made(const Suggestion& suggestion) {
    ModelDrawings& drawings = composer_.drawings;
    const Eigen::Matrix3d turn = TurnOf(suggestion.turns);
    const std::string& source = suggestion.from->source;
    OwnOrigin own;
    MORTISE_ASSIGN_OR_RETURN(own.drawing, drawings.Turned(sources_.at(source).drawing, turn));
    MORTISE_ASSIGN_OR_RETURN(own.connections, drawings.ConnectionsIn(*own.drawing));
    Design dropped;
    MORTISE_ASSIGN_OR_RETURN(dropped.assembly,
                             drawings.Parametrize(*own.drawing, suggestion.node, is_given_up_));
    dropped.q = dropped.assembly->drawn();
    MoveTo(suggestion.position, &dropped);
    Original original{source, {}, own.connections};
    MORTISE_ASSIGN_OR_RETURN(original.design.assembly,
                             drawings.Parametrize(*own.drawing, "", is_given_up_));
    original.design.q = original.design.assembly->drawn();
    MORTISE_ASSIGN_OR_RETURN(
        const ConnectionOrigins others,
        SourcesFor(sources_, With(turn), own, drawing_, composer_.collection, is_given_up_));
    if (is_given_up_()) return SuggestionTrial();
    return TryComponent(body_, dropped, suggestion.node, &original, ConnectionsIn(others),
                        ConnectOptionsFor(drawing_, others));
  }

  // The turns of the model's components, and of one more.
  std::vector<Eigen::Matrix3d> With(const Eigen::Matrix3d& turn) const {
    std::vector<Eigen::Matrix3d> turns = turns_;
    const bool is_new = std::find(turns.begin(), turns.end(), turn) == turns.end();
    if (is_new && !turn.isIdentity(0)) turns.push_back(turn);
    return turns;
  }

  const Design& body_;
  const Drawing& drawing_;
  const std::vector<Eigen::Matrix3d> turns_;
  const ConnectionOrigins& sources_;
  const Composer& composer_;
  const IsGivenUp& is_given_up_;
};

// How pieces are turned before they are suggested: about the vertical, as people turn what they
// place in a room, and as what the model has is turned.
std::vector<Eigen::Matrix3d> TurnsToSuggest(const std::vector<Eigen::Matrix3d>& in_model) {
  std::vector<Eigen::Matrix3d> turns;
  for (int quarters = 0; quarters < 4; ++quarters) {
    turns.push_back(TurnOf(std::vector<Axis>(static_cast<std::size_t>(quarters), Axis::kZ)));
  }
  for (const Eigen::Matrix3d& turn : in_model) {
    if (std::find(turns.begin(), turns.end(), turn) == turns.end()) turns.push_back(turn);
  }
  return turns;
}

SameMaterial SameMaterialBy(const ConnectOptions& options) {
  return [material_of = options.material_of](const std::string& item, const std::string& other) {
    if (item == other) return true;
    const std::string material = material_of(item);
    return !material.empty() && material == material_of(other);
  };
}

v1::ComponentSuggestion::Trial TrialOf(const SuggestionTrial& trial) {
  switch (trial.outcome) {
    case SuggestionTrial::Outcome::kFits:
      return v1::ComponentSuggestion::FITS;
    case SuggestionTrial::Outcome::kHeldInPart:
      return v1::ComponentSuggestion::HELD_IN_PART;
    default:
      return v1::ComponentSuggestion::NOT_TRIED;
  }
}

v1::ComponentSuggestion ToProto(const Suggestion& suggestion, const ConnectionOrigin& origin,
                                const std::optional<parametric::Cost>& price) {
  v1::ComponentSuggestion message;
  message.set_template_(origin.template_name);
  message.set_template_revision(origin.template_revision);
  message.set_group(suggestion.node);
  for (const Axis axis : suggestion.turns) message.add_turns(parametric::AxisToProto(axis));
  *message.mutable_position() = VectorToProto(suggestion.position);
  message.set_element(suggestion.element);
  message.set_element_there(suggestion.element_there);
  message.set_text(absl::StrFormat(
      "'%s' is held by '%s' in %s, which is %s as '%s'", suggestion.partner,
      suggestion.element_there, suggestion.from->source,
      suggestion.distance < 1e-6 ? "as large" : "nearly as large", suggestion.element));
  message.set_distance(suggestion.distance);
  message.set_held_by(suggestion.held_by);
  message.set_assemblies(suggestion.assemblies);
  if (price) {
    message.mutable_price()->set_currency(price->currency);
    message.mutable_price()->set_amount(price->amount);
  }
  message.set_score(suggestion.score);
  message.set_trial(TrialOf(suggestion.trial));
  message.set_trial_text(suggestion.trial.text);
  return message;
}

}  // namespace

absl::StatusOr<v1::ComponentSuggestions> SuggestComponents(
    const Composer& composer, const rpc::Call& call, const v1::SuggestComponentsRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CheckAsked(asked));
  Patience patience(call.deadline(), [] { return absl::Now(); });
  const IsGivenUp is_given_up = [&call] { return call.cancelled(); };
  // Looking and trying end in time to tell of what was found.
  const IsGivenUp is_late = [&] { return call.cancelled() || patience.IsOver(); };
  MORTISE_ASSIGN_OR_RETURN(const StoredModel stored, ReadModel(*composer.store, asked.name()));
  MORTISE_ASSIGN_OR_RETURN(const OpenModel model, Open(stored, composer.drawings, is_given_up));
  if (!model.body) {
    return PreconditionFailed("MODEL_EMPTY", absl::StrCat("nothing is in ", model.name, " yet"),
                              "name");
  }
  const Design& body = model.body->design;
  SuggestOptions options;
  options.count = asked.count() == 0 ? kUsualCount : asked.count();
  if (!asked.node().empty()) {
    const auto named = parametric::PartsOfNode(body.assembly->assembly(), asked.node());
    if (!named.ok()) return InvalidField("node", std::string(named.status().message()));
    options.near = {named->begin(), named->end()};
  }
  MORTISE_ASSIGN_OR_RETURN(const auto drawing,
                           composer.drawings.Get(model.name, model.body->drawing));
  MORTISE_ASSIGN_OR_RETURN(ConnectionOrigins sources,
                           composer.collection.All(rpc::ForwardedFrom(call), is_given_up));
  LeaveOutOtherItems(drawing->bundle, sources);
  options.same_material = SameMaterialBy(ConnectOptionsFor(*drawing, sources));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::Matrix3d> turns, TurnsIn(model));
  options.turns = TurnsToSuggest(turns);
  Components components(asked, sources, composer.drawings, is_late);
  Trials trials(body, *drawing, turns, sources, composer, is_late);
  options.has_time = [&] { return !call.cancelled() && patience.HasTimeForTrial(); };
  options.is_late = is_late;
  options.trial = [&](const Suggestion& suggestion) {
    SuggestionTrial trial;
    patience.Try([&] { trial = trials.Try(suggestion); });
    return trial;
  };
  const std::vector<const CollectionConnection*> connections = ConnectionsIn(sources);
  const ComponentSource source = [&](const std::string& assembly, const std::string& node) {
    return components.Get(assembly, node);
  };
  SearchExtent extent;
  const std::vector<Suggestion> found = Suggest(body, connections, source, options, &extent);
  if (call.cancelled()) return absl::CancelledError("nobody waits for the answer any more");
  // None would say that nothing goes there.
  if (extent.is_cut_short && found.empty()) {
    return absl::DeadlineExceededError(
        "there was no time to look at what might come next: ask again, with a later deadline");
  }
  v1::ComponentSuggestions message;
  message.set_revision(stored.head.revision());
  message.set_not_compared(extent.not_compared);
  for (const Suggestion& each : found) {
    const std::string& assembly = each.from->source;
    *message.add_suggestions() =
        ToProto(each, sources.at(assembly), components.PriceOf(assembly, each.node));
  }
  return message;
}

}  // namespace mortise::composer::methods
