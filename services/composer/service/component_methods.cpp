#include "services/composer/service/component_methods.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/design/template_validation.h"
#include "common/messages/vector_codec.h"
#include "services/composer/connecting/connect.h"
#include "services/composer/service/connecting_sources.h"
#include "services/composer/service/new_body.h"
#include "services/composer/service/turn_methods.h"
#include "services/composer/service/unheld_warnings.h"
#include "services/composer/snapping/snap.h"

namespace mortise::composer::methods {
namespace {

constexpr int kMaxDemands = 100;
constexpr int kMaxLoose = 50;
constexpr std::size_t kMaxParts = 2000;
constexpr std::size_t kMaxId = 50;  // of those that are made here; a number may follow

IsGivenUp GivenUpWith(const rpc::Call& call) {
  return [&call] { return call.cancelled(); };
}

absl::Status CheckPosition(const v1::Vector3& position, const std::string& field) {
  if (VectorFromProto(position).cwiseAbs().maxCoeff() <= parametric::kMaxFromOrigin) {
    return absl::OkStatus();
  }
  return InvalidField(field, absl::StrCat("must be within ", parametric::kMaxFromOrigin,
                                          " m of the origin along each axis"));
}

absl::Status CheckAddition(const v1::AddComponentRequest& asked) {
  std::vector<FieldViolation> findings;
  if (!asked.component_id().empty() && !IsResourceId(asked.component_id())) {
    findings.push_back({"component_id",
                        "must be 1 to 63 lower-case letters, digits and hyphens, and begin and end "
                        "with a letter or digit"});
  }
  if (asked.demands_size() > kMaxDemands) {
    findings.push_back({"demands", absl::StrCat("are more than ", kMaxDemands)});
  }
  return CombineViolations(CombineViolations(parametric::ToStatus(findings),
                                             CheckPosition(asked.position(), "position")),
                           ParseResourceName(asked.template_(), "templates", "template").status());
}

// The letters of ids that a name has, such as "left-drawer" of "Left drawer".
std::string IdOf(const std::string& name) {
  std::string id;
  for (const char letter : absl::AsciiStrToLower(name)) {
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0) {
      id += letter;
    } else if (!id.empty() && id.back() != '-') {
      id += '-';
    }
  }
  id = id.substr(0, kMaxId);
  while (!id.empty() && id.back() == '-') id.pop_back();
  return id.empty() ? "component" : id;
}

bool HasComponent(const OpenModel& model, const std::string& id) {
  return std::any_of(model.components.begin(), model.components.end(),
                     [&](const v1::ModelComponent& component) { return component.id() == id; });
}

// The id of a new component: the one wanted, or one made of where it comes from.
absl::StatusOr<std::string> NewId(const OpenModel& model, const v1::AddComponentRequest& asked,
                                  const std::string& group) {
  if (!asked.component_id().empty()) {
    if (!HasComponent(model, asked.component_id())) return asked.component_id();
    return InvalidField("component_id", absl::StrCat("'", asked.component_id(), "' is in ",
                                                     model.name, " already"));
  }
  const std::string origin = asked.template_().substr(asked.template_().find('/') + 1);
  const std::string base = IdOf(group.empty() ? origin : group);
  std::string id = base;
  for (int number = 2; HasComponent(model, id); ++number) id = absl::StrCat(base, "-", number);
  return id;
}

// Whether what the model has is made of the same items as the origin. ITEM_DIFFERS.
absl::Status CheckItems(const OpenModel& model, const Drawing& origin, ModelDrawings& drawings) {
  v1::AssemblyBundle together = origin.bundle;
  std::vector<std::string> digests;
  if (model.body) digests.push_back(model.body->drawing);
  for (const OpenLoose& loose : model.loose) digests.push_back(loose.part.drawing);
  for (const std::string& digest : digests) {
    MORTISE_ASSIGN_OR_RETURN(const auto drawing, drawings.Get(model.name, digest));
    MORTISE_RETURN_IF_ERROR(CombineItems(drawing->bundle, &together));
  }
  return absl::OkStatus();
}

absl::Status CheckRoom(const OpenModel& model, const Design& added) {
  if (model.loose.size() >= kMaxLoose) {
    return TooLarge("the model", absl::StrCat(kMaxLoose, " components that are not connected"));
  }
  std::size_t parts = PartsOf(added).size();
  if (model.body) parts += PartsOf(model.body->design).size();
  for (const OpenLoose& loose : model.loose) parts += PartsOf(loose.part.design).size();
  if (parts <= kMaxParts) return absl::OkStatus();
  return TooLarge("the model", absl::StrCat(kMaxParts, " parts"));
}

// Where the middle of the lower side of a design's box lay before it was turned about the origin,
// m.
Eigen::Vector3d FootBefore(const Eigen::Matrix3d& turn, const Design& turned) {
  const parametric::BoundingBox box = BoundsOf(turned);
  const Eigen::Vector3d center = turn.transpose() * box.center();
  const Eigen::Vector3d size = turn.transpose().cwiseAbs() * box.size();
  return center - Eigen::Vector3d::UnitZ() * size.z() / 2;
}

// The component as it was asked for: its sizes, and where it is dropped. It is turned already.
absl::StatusOr<Design> Dropped(std::shared_ptr<const parametric::ParametricAssembly> assembly,
                               const Eigen::Matrix3d& turn, const v1::AddComponentRequest& asked) {
  Design design;
  design.assembly = std::move(assembly);
  design.q = design.assembly->drawn();
  const Eigen::Vector3d drawn = FootBefore(turn, design);
  if (asked.demands_size() > 0) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<parametric::MeasureDemand> demands,
                             parametric::FromProto(asked.demands()));
    MORTISE_ASSIGN_OR_RETURN(
        parametric::Adjustment adjusted,
        design.assembly->Adjust(design.q, demands, parametric::DemandPolicy::kStrict));
    design.q = std::move(adjusted.q);
  }
  if (asked.has_position()) {
    MoveTo(VectorFromProto(asked.position()), &design);
  } else if (!turn.isIdentity(0)) {
    MoveTo(drawn, &design);
  }
  return design;
}

// The whole design that a component is a sub-tree of; nothing where it is all of it.
absl::StatusOr<std::optional<Design>> WholeOf(const OpenModel& model, const OpenDesign& part,
                                              ModelDrawings& drawings,
                                              const IsGivenUp& is_given_up) {
  if (part.group.empty()) return std::nullopt;
  MORTISE_ASSIGN_OR_RETURN(const auto drawing, drawings.Get(model.name, part.drawing));
  Design whole;
  MORTISE_ASSIGN_OR_RETURN(whole.assembly, drawings.Parametrize(*drawing, "", is_given_up));
  whole.q = whole.assembly->drawn();
  return whole;
}

void SetAlignments(const std::vector<Alignment>& alignments, v1::ModelComponent* component) {
  component->clear_alignments();
  for (const Alignment& alignment : alignments) {
    v1::SnapAlignment* const added = component->add_alignments();
    added->set_element(alignment.component_element);
    added->set_plane(alignment.component_plane);
    added->set_other_element(alignment.body_element);
    added->set_other_plane(alignment.body_plane);
    added->set_axis(static_cast<v1::Axis>(static_cast<int>(alignment.axis) + v1::X));
    added->set_moved_by(alignment.moved_by);
    added->set_from_original(alignment.from_original);
    added->set_text(alignment.text);
  }
}

// What clients are told of how a component was connected.
void TellOf(const Connected& connected, const ConnectionOrigins& sources,
            v1::ModelComponent* component, OpenModel* model) {
  component->set_state(v1::ModelComponent::CONNECTED);
  component->clear_alignments();
  component->set_node(connected.group);
  for (const MadeConnection& made : connected.connections) {
    v1::ModelConnection* const added = component->add_connections();
    added->mutable_principals()->Assign(made.principals.begin(), made.principals.end());
    added->set_source(sources.at(made.source).drawing->bundle.assembly().name());
    added->set_copy_of(made.as);
    added->mutable_parts()->Assign(made.parts.begin(), made.parts.end());
    added->set_moved_by(made.moved_by);
  }
  for (const ConnectionWarning& warning : connected.warnings) {
    v1::ModelWarning& added = model->warnings.emplace_back();
    added.set_component(component->id());
    added.set_element(warning.second);
    added.set_other_element(warning.first);
    added.set_text(warning.text);
    for (const auto& [first, second] : warning.others) {
      v1::ElementPair* const other = added.add_others();
      other->set_element(second);
      other->set_other_element(first);
    }
  }
}

}  // namespace

absl::StatusOr<ModelChange> AddComponent(const Composer& composer, const rpc::Call& call,
                                         const v1::AddComponentRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CheckAddition(asked));
  MORTISE_ASSIGN_OR_RETURN(ModelAtWork at_work, OpenFor(composer, call, asked));
  OpenModel& model = at_work.model;
  MORTISE_ASSIGN_OR_RETURN(
      const ComponentOrigin origin,
      composer.origins.Get(asked.template_(), asked.template_revision(), rpc::ForwardedFrom(call)));
  const std::string& group = asked.group().empty() ? origin.group : asked.group();
  MORTISE_ASSIGN_OR_RETURN(const std::string id, NewId(model, asked, group));
  MORTISE_RETURN_IF_ERROR(CheckItems(model, *origin.drawing, composer.drawings));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3d turn, ReadTurns(asked.turns()));
  MORTISE_ASSIGN_OR_RETURN(const auto drawing, composer.drawings.Turned(origin.drawing, turn));
  MORTISE_ASSIGN_OR_RETURN(auto assembly,
                           composer.drawings.Parametrize(*drawing, group, GivenUpWith(call)));
  MORTISE_ASSIGN_OR_RETURN(Design design, Dropped(std::move(assembly), turn, asked));
  MORTISE_RETURN_IF_ERROR(CheckRoom(model, design));
  v1::ModelComponent& component = model.components.emplace_back();
  component.set_id(id);
  component.set_template_(origin.template_name);
  component.set_template_revision(origin.revision);
  component.set_group(group);
  *component.mutable_turns() = TurnsToProto(turn);
  OpenDesign part{drawing->digest, group, std::move(design)};
  if (model.body) {
    component.set_state(v1::ModelComponent::PLACED);
    OpenLoose& loose = model.loose.emplace_back(OpenLoose{id, std::move(part), {}});
    if (!turn.isIdentity(0)) {
      loose.turned.set_drawing(origin.drawing->digest);
      *loose.turned.mutable_turns() = component.turns();
    }
  } else {
    component.set_state(v1::ModelComponent::CONNECTED);
    for (const parametric::AssemblyPart& each : part.design.assembly->assembly().parts) {
      model.owners[each.name] = id;
    }
    model.body = std::move(part);
  }
  return at_work.Done(absl::StrCat("add ", id), {origin.drawing, drawing});
}

absl::StatusOr<ModelChange> SnapComponent(const Composer& composer, const rpc::Call& call,
                                          const v1::SnapComponentRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(ModelAtWork at_work, OpenFor(composer, call, asked));
  OpenModel& model = at_work.model;
  MORTISE_ASSIGN_OR_RETURN(OpenLoose* const loose, FindLoose(model, asked.component()));
  MORTISE_ASSIGN_OR_RETURN(const std::optional<Design> whole,
                           WholeOf(model, loose->part, composer.drawings, GivenUpWith(call)));
  MORTISE_ASSIGN_OR_RETURN(Snapped snapped, Snap(loose->part.design, whole ? &*whole : nullptr,
                                                 model.body->design, SnapOptions()));
  loose->part.design = std::move(snapped.component);
  MORTISE_ASSIGN_OR_RETURN(v1::ModelComponent* const component,
                           FindComponent(model, asked.component()));
  SetPlaced(model, asked.component());
  component->set_state(v1::ModelComponent::SNAPPED);
  SetAlignments(snapped.alignments, component);
  ModelChange change = at_work.Done(absl::StrCat("snap ", asked.component()));
  change.preview = asked.preview();
  return change;
}

absl::StatusOr<ModelChange> ConnectComponent(const Composer& composer, const rpc::Call& call,
                                             const v1::ConnectComponentRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(ModelAtWork at_work, OpenFor(composer, call, asked));
  OpenModel& model = at_work.model;
  ModelDrawings& drawings = composer.drawings;
  MORTISE_ASSIGN_OR_RETURN(OpenLoose* const loose, FindLoose(model, asked.component()));
  MORTISE_ASSIGN_OR_RETURN(const auto body, drawings.Get(model.name, model.body->drawing));
  MORTISE_ASSIGN_OR_RETURN(const auto origin, drawings.Get(model.name, loose->part.drawing));
  MORTISE_ASSIGN_OR_RETURN(std::optional<Design> whole,
                           WholeOf(model, loose->part, drawings, GivenUpWith(call)));
  MORTISE_ASSIGN_OR_RETURN(const auto own, drawings.ConnectionsIn(*origin));
  const std::string& source = origin->bundle.assembly().name();
  std::optional<Original> original;
  if (whole) original = Original{source, *std::move(whole), own};
  MORTISE_ASSIGN_OR_RETURN(const ConnectionOrigins drawn,
                           composer.collection.All(rpc::ForwardedFrom(call), GivenUpWith(call)));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::Matrix3d> turns, TurnsIn(model));
  MORTISE_ASSIGN_OR_RETURN(
      const ConnectionOrigins sources,
      SourcesFor(drawn, turns, {origin, own}, *body, composer.collection, GivenUpWith(call)));
  MORTISE_ASSIGN_OR_RETURN(const Connected connected,
                           Connect(model.body->design, loose->part.design, asked.component(),
                                   original ? &*original : nullptr, ConnectionsIn(sources),
                                   ConnectOptionsFor(*body, sources)));
  UnheldBefore before;
  MORTISE_ASSIGN_OR_RETURN(
      before.component,
      UnheldByDesign(original ? original->design : loose->part.design, *own, *origin));
  if (!IsFastened(connected)) {
    MORTISE_ASSIGN_OR_RETURN(before.body, UnheldByDesign(model, *body));
  }
  MORTISE_ASSIGN_OR_RETURN(const auto drawing,
                           TakeConnected(connected, asked.component(), {*body, *origin, sources},
                                         drawings, GivenUpWith(call), &model));
  MORTISE_ASSIGN_OR_RETURN(v1::ModelComponent* const component,
                           FindComponent(model, asked.component()));
  TellOf(connected, sources, component, &model);
  MORTISE_RETURN_IF_ERROR(WarnOfUnheldNow(connected, before, *drawing, &model));
  return at_work.Done(absl::StrCat("connect ", asked.component()), {drawing});
}

absl::StatusOr<ModelChange> MoveComponent(const Composer& composer, const rpc::Call& call,
                                          const v1::MoveComponentRequest& asked) {
  if (!asked.has_position()) return InvalidField("position", "is missing");
  MORTISE_RETURN_IF_ERROR(CheckPosition(asked.position(), "position"));
  MORTISE_ASSIGN_OR_RETURN(ModelAtWork at_work, OpenFor(composer, call, asked));
  MORTISE_ASSIGN_OR_RETURN(OpenLoose* const loose, FindLoose(at_work.model, asked.component()));
  MoveTo(VectorFromProto(asked.position()), &loose->part.design);
  SetPlaced(at_work.model, asked.component());
  return at_work.Done(absl::StrCat("move ", asked.component()));
}

absl::StatusOr<ModelChange> RemoveNode(const Composer& composer, const rpc::Call& call,
                                       const v1::RemoveNodeRequest& asked) {
  if (asked.component().empty() == asked.node().empty()) {
    return InvalidField("node", "must be given, or else a component that is not connected");
  }
  MORTISE_ASSIGN_OR_RETURN(ModelAtWork at_work, OpenFor(composer, call, asked));
  OpenModel& model = at_work.model;
  if (!asked.component().empty()) {
    MORTISE_RETURN_IF_ERROR(FindLoose(model, asked.component()).status());
    const auto is_it = [&](const auto& component) { return component.id() == asked.component(); };
    std::erase_if(model.loose, [&](const OpenLoose& each) { return each.id == asked.component(); });
    std::erase_if(model.components, is_it);
    return at_work.Done(absl::StrCat("remove ", asked.component()));
  }
  MORTISE_RETURN_IF_ERROR(FindDesign(model, "").status());
  MORTISE_ASSIGN_OR_RETURN(const auto before,
                           composer.drawings.Get(model.name, model.body->drawing));
  MORTISE_ASSIGN_OR_RETURN(const std::set<std::string> by_design, UnheldByDesign(model, *before));
  MORTISE_ASSIGN_OR_RETURN(const auto drawing,
                           TakeWithout(asked.node(), composer.drawings, GivenUpWith(call), &model));
  MORTISE_RETURN_IF_ERROR(WarnOfUnheld(by_design, *drawing, &model));
  return at_work.Done(absl::StrCat("remove ", asked.node()), {drawing});
}

}  // namespace mortise::composer::methods
