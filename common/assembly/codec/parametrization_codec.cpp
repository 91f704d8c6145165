#include "common/assembly/codec/parametrization_codec.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/assembly/codec/connection_codec.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"
#include "common/files/axis_codec.h"
#include "common/files/template_codec.h"
#include "common/messages/vector_codec.h"

namespace mortise::parametric {
namespace {

// Groups are named in messages, the root by nothing.
std::string GroupName(const Assembly& assembly, int group) {
  return group <= 0 ? "" : assembly.groups[static_cast<std::size_t>(group)].name;
}

absl::StatusOr<MeasureKind> KindFromProto(v1::Measure::Kind kind, const std::string& field) {
  switch (kind) {
    case v1::Measure::KIND_UNSPECIFIED:
    case v1::Measure::SIZE:
      return MeasureKind::kSize;
    case v1::Measure::CENTER:
      return MeasureKind::kCenter;
    case v1::Measure::MINIMUM:
      return MeasureKind::kMinimum;
    case v1::Measure::MAXIMUM:
      return MeasureKind::kMaximum;
    default:
      return InvalidField(field, "must be SIZE, CENTER, MINIMUM or MAXIMUM");
  }
}

v1::Measure::Kind KindToProto(MeasureKind kind) {
  switch (kind) {
    case MeasureKind::kSize:
      return v1::Measure::SIZE;
    case MeasureKind::kCenter:
      return v1::Measure::CENTER;
    case MeasureKind::kMinimum:
      return v1::Measure::MINIMUM;
    case MeasureKind::kMaximum:
      return v1::Measure::MAXIMUM;
  }
  return v1::Measure::KIND_UNSPECIFIED;
}

v1::GeometricRelationship::Kind KindToProto(RelationshipKind kind) {
  switch (kind) {
    case RelationshipKind::kCoplanar:
      return v1::GeometricRelationship::COPLANAR;
    case RelationshipKind::kConcentric:
      return v1::GeometricRelationship::CONCENTRIC;
    case RelationshipKind::kSymmetric:
      return v1::GeometricRelationship::SYMMETRIC;
    case RelationshipKind::kOrder:
      return v1::GeometricRelationship::ORDER;
    case RelationshipKind::kSize:
      return v1::GeometricRelationship::SIZE;
    case RelationshipKind::kRepeat:
      return v1::GeometricRelationship::REPEAT;
    case RelationshipKind::kProportion:
      return v1::GeometricRelationship::PROPORTION;
  }
  return v1::GeometricRelationship::KIND_UNSPECIFIED;
}

void SetProto(const MeasureRange& range, v1::MeasureRange* message) {
  *message->mutable_measure() = ToProto(range.measure);
  message->set_drawn(range.drawn);
  message->set_minimum(range.minimum);
  message->set_maximum(range.maximum);
}

void SetProto(const Assembly& assembly, const Element& element, v1::ParametricElement* message) {
  message->set_name(element.name);
  message->set_item(element.item);
  message->set_group(GroupName(assembly, element.group));
  message->set_connecting(element.connecting);
  for (const int part : element.parts) {
    message->add_parts(assembly.parts[static_cast<std::size_t>(part)].name);
  }
  if (element.pattern) {
    for (const PatternDirection& direction : element.pattern->directions) {
      if (direction.count < 2) continue;
      v1::PatternRow* row = message->add_rows();
      row->set_count(direction.count);
      *row->mutable_spacing() = VectorToProto(direction.spacing);
    }
  }
  *message->mutable_minimum() = VectorToProto(element.box.minimum);
  *message->mutable_maximum() = VectorToProto(element.box.maximum);
}

absl::Status AddNodes(const ParametricAssembly& parametric, v1::Parametrization& message) {
  const Assembly& assembly = parametric.assembly();
  for (int group = 0; group < static_cast<int>(assembly.groups.size()); ++group) {
    v1::ParametricNode* node = message.add_nodes();
    node->set_group(GroupName(assembly, group));
    node->set_parent(GroupName(assembly, assembly.groups[static_cast<std::size_t>(group)].parent));
    int elements = 0;
    for (const Element& element : parametric.elements()) {
      elements += IsWithin(assembly, element.group, group) ? 1 : 0;
    }
    node->set_elements(elements);
    node->set_relationships(
        static_cast<int>(RelationshipsWithin(assembly, parametric.relationships(), group).size()));
    MORTISE_ASSIGN_OR_RETURN(const int degrees, parametric.DegreesOfFreedom(group));
    node->set_degrees_of_freedom(degrees);
  }
  return absl::OkStatus();
}

void AddLevels(const PlacedPart& part, Axis axis, v1::PlacedPart& message) {
  for (const mesh::LevelPlace& level : part.stretch.levels[static_cast<std::size_t>(axis)]) {
    v1::PlacedLevel* placed = message.add_levels();
    placed->set_axis(AxisToProto(axis));
    placed->set_fraction(level.fraction);
    placed->set_position(part.box.center()[static_cast<int>(axis)] + level.place);
  }
}

// The assembly of a bundle, or the sub-tree below a group of it, by itself.
absl::StatusOr<Assembly> DrawnAssemblyOf(const v1::AssemblyBundle& bundle,
                                         const std::string& group) {
  std::vector<Item> items;
  for (const v1::Item& message : bundle.items()) {
    MORTISE_ASSIGN_OR_RETURN(Item item, FromProto(message));
    items.push_back(std::move(item));
  }
  MORTISE_ASSIGN_OR_RETURN(const ShapesByName shapes, FromProto(bundle.shapes()));
  MORTISE_ASSIGN_OR_RETURN(Assembly assembly, FromProto(bundle.assembly(), items, shapes));
  if (!group.empty()) return SubTreeOf(assembly, group);
  return assembly;
}

}  // namespace

absl::StatusOr<Measure> FromProto(const v1::Measure& message, const std::string& field) {
  Measure measure;
  measure.element = message.element();
  if (message.axis() != v1::AXIS_UNSPECIFIED) {
    MORTISE_ASSIGN_OR_RETURN(measure.axis,
                             AxisFromProto(message.axis(), absl::StrCat(field, ".axis")));
  }
  MORTISE_ASSIGN_OR_RETURN(measure.kind,
                           KindFromProto(message.kind(), absl::StrCat(field, ".kind")));
  return measure;
}

v1::Measure ToProto(const Measure& measure) {
  v1::Measure message;
  message.set_element(measure.element);
  message.set_axis(AxisToProto(measure.axis));
  message.set_kind(KindToProto(measure.kind));
  return message;
}

absl::StatusOr<std::vector<MeasureDemand>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::MeasureDemand>& messages) {
  std::vector<MeasureDemand> demands;
  for (int i = 0; i < messages.size(); ++i) {
    MeasureDemand demand;
    MORTISE_ASSIGN_OR_RETURN(
        demand.measure, FromProto(messages[i].measure(), absl::StrCat("demands[", i, "].measure")));
    demand.value = messages[i].value();
    demands.push_back(std::move(demand));
  }
  return demands;
}

absl::StatusOr<std::shared_ptr<const ParametricAssembly>> Parametrize(
    const v1::AssemblyBundle& bundle, const std::function<bool()>& is_given_up,
    const std::string& group) {
  return ParametrizeKnowing({}, bundle, is_given_up, group, LoosePolicy::kRefuse);
}

absl::StatusOr<std::shared_ptr<const ParametricAssembly>> ParametrizeWith(
    const SearchOptions& search, const v1::AssemblyBundle& bundle,
    const std::function<bool()>& is_given_up, const std::string& group) {
  MORTISE_ASSIGN_OR_RETURN(Assembly assembly, DrawnAssemblyOf(bundle, group));
  MORTISE_ASSIGN_OR_RETURN(ParametricAssembly parametrized,
                           ParametricAssembly::Create(std::move(assembly), is_given_up, {},
                                                      LoosePolicy::kRefuse, search));
  return std::make_shared<const ParametricAssembly>(std::move(parametrized));
}

absl::StatusOr<std::shared_ptr<const ParametricAssembly>> ParametrizeKnowing(
    const std::vector<const ParametricAssembly*>& known, const v1::AssemblyBundle& bundle,
    const std::function<bool()>& is_given_up, const std::string& group, LoosePolicy loose) {
  MORTISE_ASSIGN_OR_RETURN(Assembly assembly, DrawnAssemblyOf(bundle, group));
  MORTISE_ASSIGN_OR_RETURN(
      ParametricAssembly parametrized,
      ParametricAssembly::Create(std::move(assembly), is_given_up, known, loose));
  return std::make_shared<const ParametricAssembly>(std::move(parametrized));
}

absl::StatusOr<v1::Parametrization> ToProto(const ParametricAssembly& parametric) {
  const Assembly& assembly = parametric.assembly();
  v1::Parametrization message;
  message.set_tolerance(parametric.tolerance());
  MORTISE_RETURN_IF_ERROR(AddNodes(parametric, message));
  for (const Element& element : parametric.elements()) {
    SetProto(assembly, element, message.add_elements());
  }
  for (const auto& [first, second] : parametric.contacts()) {
    v1::ElementContact* contact = message.add_contacts();
    contact->set_first(parametric.elements()[static_cast<std::size_t>(first)].name);
    contact->set_second(parametric.elements()[static_cast<std::size_t>(second)].name);
  }
  for (const Relationship& relationship : parametric.relationships()) {
    v1::GeometricRelationship* described = message.add_relationships();
    described->set_kind(KindToProto(relationship.kind));
    described->set_equality(relationship.equality);
    described->set_group(GroupName(assembly, relationship.group));
    described->set_description(relationship.description);
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<MeasureRange> sizes, parametric.AdjustableSizes());
  for (const MeasureRange& range : sizes) SetProto(range, message.add_sizes());
  message.mutable_q()->Add(parametric.drawn().begin(), parametric.drawn().end());
  message.set_degrees_of_freedom(parametric.feasible_set().degrees_of_freedom());
  for (const Pose& pose : PosesOf(assembly)) {
    if (!pose.name.empty()) message.add_rest_poses(pose.name);
  }
  for (const ElementConnection& connection : parametric.connections()) {
    *message.add_connections() = ToProto(connection);
  }
  return message;
}

absl::StatusOr<v1::AdjustedAssembly> EvaluatedToProto(const ParametricAssembly& assembly,
                                                      const Eigen::VectorXd& q) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<ContactFault> faults, assembly.FaultsAt(q));
  v1::AdjustedAssembly message;
  message.mutable_q()->Add(q.begin(), q.end());
  for (const PlacedPart& part : assembly.PartsAt(q)) {
    const Element& element = assembly.elements()[static_cast<std::size_t>(part.element)];
    v1::PlacedPart* placed = message.add_parts();
    placed->set_name(part.name);
    placed->set_element(element.name);
    placed->set_item(element.item);
    if (const auto& shape = assembly.ShapeOf(part); shape != nullptr) {
      placed->set_shape(shape->name);
    }
    for (const Axis axis : kAxes) AddLevels(part, axis, *placed);
    *placed->mutable_minimum() = VectorToProto(part.box.minimum);
    *placed->mutable_maximum() = VectorToProto(part.box.maximum);
  }
  for (const ContactFault& fault : faults) message.add_faults(Describe(fault));
  return message;
}

}  // namespace mortise::parametric
