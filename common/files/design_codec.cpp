// Field-by-field conversion of evaluated designs.
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/files/axis_codec.h"
#include "common/files/template_codec.h"
#include "common/messages/vector_codec.h"

namespace mortise::parametric {
namespace {

void SetShape(const FacetedShape& shape, v1::FacetedShape* message) {
  const mesh::SurfaceMesh& surface = shape.surface;
  message->mutable_vertices()->Add(surface.vertices.data(),
                                   surface.vertices.data() + surface.vertices.size());
  message->mutable_triangles()->Add(surface.triangles.data(),
                                    surface.triangles.data() + surface.triangles.size());
  message->mutable_triangle_faces()->Add(shape.triangle_face.data(),
                                         shape.triangle_face.data() + shape.triangle_face.size());
  for (const std::vector<std::string>& names : shape.face_names) {
    v1::FaceNames* face = message->add_faces();
    for (const std::string& name : names) face->add_names(name);
  }
}

void SetPart(const EvaluatedPart& part, v1::EvaluatedPart* message) {
  message->set_name(part.name);
  message->set_title(part.title);
  message->set_item(part.item);
  if (!part.faceted) message->set_axis(AxisToProto(part.axis));
  for (const auto& corner : part.outline.colwise()) {
    v1::Vector2* point = message->add_outline();
    point->set_u(corner.x());
    point->set_v(corner.y());
  }
  message->set_from(part.from);
  message->set_to(part.to);
  *message->mutable_minimum() = VectorToProto(part.minimum);
  *message->mutable_maximum() = VectorToProto(part.maximum);
  *message->mutable_size() = VectorToProto(part.size);
  message->set_volume(part.volume);
  message->set_mass(part.mass);
  message->set_process(ProcessToProto(part.process));
  for (const std::string& name : part.face_names) message->add_face_names(name);
  message->set_material(part.material);
  message->set_connecting(part.connecting);
  message->set_length_axis(AxisToProto(part.length_axis));
  message->set_thickness_axis(AxisToProto(part.thickness_axis));
  if (part.faceted) SetShape(*part.faceted, message->mutable_faceted());
}

absl::StatusOr<FacetedShape> ShapeOf(const v1::FacetedShape& message, const std::string& field) {
  const Eigen::Index vertices = message.vertices_size() / 3;
  const Eigen::Index triangles = message.triangles_size() / 3;
  if (message.vertices_size() % 3 != 0 || message.triangles_size() % 3 != 0 ||
      message.triangle_faces_size() != triangles) {
    return InvalidField(field, "needs three numbers a vertex and a triangle, and a face for each");
  }
  FacetedShape shape;
  shape.surface.vertices =
      Eigen::Map<const Eigen::Matrix3Xd>(message.vertices().data(), 3, vertices);
  shape.surface.triangles =
      Eigen::Map<const Eigen::Matrix3Xi>(message.triangles().data(), 3, triangles);
  shape.triangle_face =
      Eigen::Map<const Eigen::VectorXi>(message.triangle_faces().data(), triangles);
  for (const v1::FaceNames& face : message.faces()) {
    shape.face_names.emplace_back(face.names().begin(), face.names().end());
  }
  const auto within = [](const auto& indices, Eigen::Index count) {
    return indices.size() == 0 || (indices.minCoeff() >= 0 && indices.maxCoeff() < count);
  };
  if (!within(shape.surface.triangles, vertices) ||
      !within(shape.triangle_face, message.faces_size())) {
    return InvalidField(field, "refers to a vertex or face that is not there");
  }
  return shape;
}

absl::StatusOr<EvaluatedPart> PartOf(const v1::EvaluatedPart& message, const std::string& field) {
  EvaluatedPart part;
  part.name = message.name();
  part.title = message.title();
  part.item = message.item();
  if (!message.has_faceted()) {
    MORTISE_ASSIGN_OR_RETURN(part.axis,
                             AxisFromProto(message.axis(), absl::StrCat(field, ".axis")));
  }
  part.outline.resize(2, message.outline_size());
  for (int i = 0; i < message.outline_size(); ++i) {
    part.outline.col(i) << message.outline(i).u(), message.outline(i).v();
  }
  part.from = message.from();
  part.to = message.to();
  part.minimum = VectorFromProto(message.minimum());
  part.maximum = VectorFromProto(message.maximum());
  part.size = VectorFromProto(message.size());
  part.volume = message.volume();
  part.mass = message.mass();
  MORTISE_ASSIGN_OR_RETURN(part.process,
                           ProcessFromProto(message.process(), absl::StrCat(field, ".process")));
  part.face_names = {message.face_names().begin(), message.face_names().end()};
  part.material = message.material();
  part.connecting = message.connecting();
  if (message.length_axis() != v1::AXIS_UNSPECIFIED) {
    MORTISE_ASSIGN_OR_RETURN(part.length_axis, AxisFromProto(message.length_axis(),
                                                             absl::StrCat(field, ".length_axis")));
  }
  if (message.thickness_axis() != v1::AXIS_UNSPECIFIED) {
    MORTISE_ASSIGN_OR_RETURN(
        part.thickness_axis,
        AxisFromProto(message.thickness_axis(), absl::StrCat(field, ".thickness_axis")));
  }
  if (message.has_faceted()) {
    MORTISE_ASSIGN_OR_RETURN(part.faceted,
                             ShapeOf(message.faceted(), absl::StrCat(field, ".faceted")));
    return part;
  }
  if (message.outline_size() < 3 || message.face_names_size() != message.outline_size() + 2) {
    return InvalidField(absl::StrCat(field, ".outline"),
                        "needs at least three corners, and face_names two more than those");
  }
  return part;
}

void SetConnector(const EvaluatedConnector& peg, v1::EvaluatedConnector* message) {
  message->set_connection(peg.connection);
  message->set_item(peg.item);
  message->set_part(peg.part);
  message->set_other_part(peg.other_part);
  *message->mutable_position() = VectorToProto(peg.position);
  *message->mutable_direction() = VectorToProto(peg.direction);
  message->set_diameter(peg.diameter);
  message->set_length(peg.length);
  message->set_depth_in_part(peg.depth_in_part);
  message->set_priority(peg.priority);
}

EvaluatedConnector ConnectorOf(const v1::EvaluatedConnector& message) {
  EvaluatedConnector peg;
  peg.connection = message.connection();
  peg.item = message.item();
  peg.part = message.part();
  peg.other_part = message.other_part();
  peg.position = VectorFromProto(message.position());
  peg.direction = VectorFromProto(message.direction());
  peg.diameter = message.diameter();
  peg.length = message.length();
  peg.depth_in_part = message.depth_in_part();
  peg.priority = message.priority();
  return peg;
}

void SetDisplacement(const std::array<std::optional<double>, 3>& displacement,
                     v1::PrescribedDisplacement* message) {
  if (displacement[0]) message->set_x(*displacement[0]);
  if (displacement[1]) message->set_y(*displacement[1]);
  if (displacement[2]) message->set_z(*displacement[2]);
}

std::array<std::optional<double>, 3> DisplacementOf(const v1::PrescribedDisplacement& message) {
  std::array<std::optional<double>, 3> displacement;
  if (message.has_x()) displacement[0] = message.x();
  if (message.has_y()) displacement[1] = message.y();
  if (message.has_z()) displacement[2] = message.z();
  return displacement;
}

void SetCondition(const EvaluatedBoundaryCondition& condition,
                  v1::EvaluatedBoundaryCondition* message) {
  message->set_name(condition.name);
  message->set_kind(static_cast<v1::BoundaryCondition::Kind>(condition.kind));
  message->set_part(condition.part);
  message->set_face(condition.face);
  message->set_load_case(condition.load_case);
  *message->mutable_force() = VectorToProto(condition.force);
  message->set_pressure(condition.pressure);
  message->set_heat_flux(condition.heat_flux);
  message->set_temperature(condition.temperature);
  message->set_coefficient(condition.coefficient);
  if (condition.kind == BoundaryConditionKind::kDisplacement) {
    SetDisplacement(condition.displacement, message->mutable_displacement());
  }
  if (condition.kind == BoundaryConditionKind::kGravity) {
    *message->mutable_acceleration() = VectorToProto(condition.acceleration);
  }
  if (condition.kind == BoundaryConditionKind::kRotation) {
    *message->mutable_axis_point() = VectorToProto(condition.axis_point);
    *message->mutable_angular_velocity() = VectorToProto(condition.angular_velocity);
  }
}

absl::StatusOr<Structure> StructureOf(const v1::Structure& message) {
  Structure structure;
  for (int i = 0; i < message.counts_size(); ++i) {
    const v1::Structure::Count& count = message.counts(i);
    const auto& numbers = count.numbers();
    if (numbers.empty() || numbers.size() > 2 ||
        std::any_of(numbers.begin(), numbers.end(), [](int number) { return number < 1; })) {
      return InvalidField(absl::StrCat("structure.counts[", i, "].numbers"),
                          "must be one or two, each at least 1");
    }
    structure.counts.push_back({count.name(), {numbers.begin(), numbers.end()}});
  }
  for (const v1::Structure::Choice& choice : message.choices()) {
    structure.choices.push_back({choice.parameter(), choice.value()});
  }
  structure.absent_parts = {message.absent_parts().begin(), message.absent_parts().end()};
  structure.absent_conditions = {message.absent_conditions().begin(),
                                 message.absent_conditions().end()};
  structure.absent_features = {message.absent_features().begin(), message.absent_features().end()};
  for (const v1::Structure::PartItem& item : message.items()) {
    structure.items.push_back({item.part(), item.item()});
  }
  return structure;
}

}  // namespace

absl::StatusOr<EvaluatedBoundaryCondition> FromProto(const v1::EvaluatedBoundaryCondition& message,
                                                     const std::string& field) {
  EvaluatedBoundaryCondition condition;
  condition.name = message.name();
  if (!v1::BoundaryCondition::Kind_IsValid(message.kind()) ||
      message.kind() == v1::BoundaryCondition::KIND_UNSPECIFIED) {
    return InvalidField(absl::StrCat(field, ".kind"), "is not a kind of condition");
  }
  condition.kind = static_cast<BoundaryConditionKind>(message.kind());
  condition.part = message.part();
  condition.face = message.face();
  condition.load_case = message.load_case();
  condition.force = VectorFromProto(message.force());
  condition.pressure = message.pressure();
  condition.heat_flux = message.heat_flux();
  condition.temperature = message.temperature();
  condition.coefficient = message.coefficient();
  condition.displacement = DisplacementOf(message.displacement());
  condition.acceleration = VectorFromProto(message.acceleration());
  condition.axis_point = VectorFromProto(message.axis_point());
  condition.angular_velocity = VectorFromProto(message.angular_velocity());
  return condition;
}

v1::Structure ToProto(const Structure& structure) {
  v1::Structure message;
  for (const StructureCount& count : structure.counts) {
    v1::Structure::Count* told = message.add_counts();
    told->set_name(count.name);
    told->mutable_numbers()->Add(count.numbers.begin(), count.numbers.end());
  }
  for (const StructureChoice& choice : structure.choices) {
    v1::Structure::Choice* told = message.add_choices();
    told->set_parameter(choice.parameter);
    told->set_value(choice.value);
  }
  for (const std::string& part : structure.absent_parts) message.add_absent_parts(part);
  for (const std::string& name : structure.absent_conditions) message.add_absent_conditions(name);
  for (const std::string& name : structure.absent_features) message.add_absent_features(name);
  for (const StructureItem& item : structure.items) {
    v1::Structure::PartItem* told = message.add_items();
    told->set_part(item.part);
    told->set_item(item.item);
  }
  message.set_key(KeyOf(structure));
  message.set_description(Describe(structure));
  return message;
}

v1::EvaluatedDesign ToProto(const EvaluatedDesign& design) {
  v1::EvaluatedDesign message;
  message.set_template_(design.template_name);
  message.set_template_revision(design.template_revision);
  message.set_template_digest(design.template_digest);
  for (const NamedValue& value : design.parameters) {
    v1::ParameterValue* parameter = message.add_parameters();
    parameter->set_name(value.name);
    parameter->set_value(value.value);
    parameter->set_choice(value.choice);
  }
  for (const EvaluatedPart& part : design.parts) SetPart(part, message.add_parts());
  for (const EvaluatedConnector& peg : design.connectors) {
    SetConnector(peg, message.add_connectors());
  }
  for (const EvaluatedBoundaryCondition& condition : design.boundary_conditions) {
    SetCondition(condition, message.add_boundary_conditions());
  }
  message.set_mass(design.mass);
  if (design.reference_temperature) {
    message.set_reference_temperature(*design.reference_temperature);
  }
  if (design.structure) *message.mutable_structure() = ToProto(*design.structure);
  return message;
}

absl::StatusOr<EvaluatedDesign> FromProto(const v1::EvaluatedDesign& message) {
  EvaluatedDesign design;
  design.template_name = message.template_();
  design.template_revision = message.template_revision();
  design.template_digest = message.template_digest();
  design.parameters = FromProto(message.parameters());
  for (int i = 0; i < message.parts_size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(EvaluatedPart part,
                             PartOf(message.parts(i), absl::StrCat("parts[", i, "]")));
    design.parts.push_back(std::move(part));
  }
  for (const v1::EvaluatedConnector& peg : message.connectors()) {
    design.connectors.push_back(ConnectorOf(peg));
  }
  for (int i = 0; i < message.boundary_conditions_size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(
        EvaluatedBoundaryCondition condition,
        FromProto(message.boundary_conditions(i), absl::StrCat("boundary_conditions[", i, "]")));
    design.boundary_conditions.push_back(std::move(condition));
  }
  design.mass = message.mass();
  if (message.has_reference_temperature()) {
    design.reference_temperature = message.reference_temperature();
  }
  if (message.has_structure()) {
    MORTISE_ASSIGN_OR_RETURN(design.structure, StructureOf(message.structure()));
  }
  return design;
}

}  // namespace mortise::parametric
