// Converts structs to messages.
#include "common/files/condition_codec.h"
#include "common/files/template_codec.h"
#include "common/templates/features/codec/cad_template_codec.h"

namespace mortise::cad {
namespace {

void Fill(const Formula2& from, v1::SketchPoint& to) {
  to.set_x(from.x);
  to.set_y(from.y);
}

void Fill(const Formula3& from, v1::SpacePoint& to) {
  to.set_x(from.x);
  to.set_y(from.y);
  to.set_z(from.z);
}

v1::Feature::Operation ToProto(Operation operation) {
  return static_cast<v1::Feature::Operation>(operation);
}

// Writes a profile's shape.
class ShapeWriter {
 public:
  explicit ShapeWriter(v1::SketchProfile& profile) : profile_(profile) {}

  void operator()(const SketchPath& path) {
    v1::SketchPath& message = *profile_.mutable_path();
    Fill(path.start, *message.mutable_start());
    message.set_open(path.open);
    for (const SketchSegment& segment : path.segments) {
      v1::SketchSegment& entry = *message.add_segments();
      entry.set_name(segment.name);
      Fill(segment.to, *entry.mutable_to());
      if (segment.through) Fill(*segment.through, *entry.mutable_through());
      entry.set_round(segment.round);
    }
  }
  void operator()(const SketchCircle& circle) {
    Fill(circle.center, *profile_.mutable_circle()->mutable_center());
    profile_.mutable_circle()->set_radius(circle.radius);
  }
  void operator()(const SketchRectangle& rectangle) {
    v1::SketchRectangle& message = *profile_.mutable_rectangle();
    Fill(rectangle.center, *message.mutable_center());
    message.set_width(rectangle.width);
    message.set_height(rectangle.height);
    message.set_round(rectangle.round);
  }
  void operator()(const SketchPolygon& polygon) {
    v1::SketchPolygon& message = *profile_.mutable_polygon();
    Fill(polygon.center, *message.mutable_center());
    message.set_radius(polygon.radius);
    message.set_sides(polygon.sides);
    message.set_angle(polygon.angle);
  }

 private:
  v1::SketchProfile& profile_;
};

// Writes a feature's kind.
class KindWriter {
 public:
  explicit KindWriter(v1::Feature& feature) : feature_(feature) {}

  void operator()(const Sketch& sketch) {
    v1::Sketch& message = *feature_.mutable_sketch();
    v1::SketchPlane& plane = *message.mutable_plane();
    Fill(sketch.plane.origin, *plane.mutable_origin());
    if (sketch.plane.normal) Fill(*sketch.plane.normal, *plane.mutable_normal());
    if (sketch.plane.x_axis) Fill(*sketch.plane.x_axis, *plane.mutable_x_axis());
    plane.set_face(sketch.plane.face);
    for (const SketchProfile& profile : sketch.profiles) {
      v1::SketchProfile& entry = *message.add_profiles();
      entry.set_name(profile.name);
      entry.set_hole_of(profile.hole_of);
      std::visit(ShapeWriter(entry), profile.shape);
    }
  }
  void operator()(const Extrude& extrude) {
    v1::Extrude& message = *feature_.mutable_extrude();
    message.set_sketch(extrude.sketch);
    message.set_from(extrude.from);
    message.set_to(extrude.to);
    message.set_operation(ToProto(extrude.operation));
    message.set_body(extrude.body);
  }
  void operator()(const Revolve& revolve) {
    v1::Revolve& message = *feature_.mutable_revolve();
    message.set_sketch(revolve.sketch);
    Fill(revolve.axis_point, *message.mutable_axis_point());
    Fill(revolve.axis_direction, *message.mutable_axis_direction());
    message.set_angle(revolve.angle);
    message.set_operation(ToProto(revolve.operation));
    message.set_body(revolve.body);
  }
  void operator()(const Sweep& sweep) {
    v1::Sweep& message = *feature_.mutable_sweep();
    message.set_sketch(sweep.sketch);
    message.set_path(sweep.path);
    message.set_operation(ToProto(sweep.operation));
    message.set_body(sweep.body);
  }
  void operator()(const Boolean& boolean) {
    v1::BooleanFeature& message = *feature_.mutable_boolean();
    message.set_operation(ToProto(boolean.operation));
    message.set_body(boolean.body);
    *message.mutable_tools() = {boolean.tools.begin(), boolean.tools.end()};
  }
  void operator()(const Fillet& fillet) {
    v1::Fillet& message = *feature_.mutable_fillet();
    *message.mutable_edges() = {fillet.edges.begin(), fillet.edges.end()};
    message.set_radius(fillet.radius);
  }
  void operator()(const Chamfer& chamfer) {
    v1::Chamfer& message = *feature_.mutable_chamfer();
    *message.mutable_edges() = {chamfer.edges.begin(), chamfer.edges.end()};
    message.set_distance(chamfer.distance);
  }
  void operator()(const Draft& draft) {
    v1::Draft& message = *feature_.mutable_draft();
    *message.mutable_faces() = {draft.faces.begin(), draft.faces.end()};
    message.set_neutral(draft.neutral);
    message.set_angle(draft.angle);
  }
  void operator()(const Shell& shell) {
    v1::Shell& message = *feature_.mutable_shell();
    *message.mutable_open_faces() = {shell.open_faces.begin(), shell.open_faces.end()};
    message.set_thickness(shell.thickness);
  }
  void operator()(const Hole& hole) {
    v1::DrilledHole& message = *feature_.mutable_hole();
    message.set_face(hole.face);
    Fill(hole.position, *message.mutable_position());
    message.set_diameter(hole.diameter);
    message.set_depth(hole.depth);
    message.set_counterbore_diameter(hole.counterbore_diameter);
    message.set_counterbore_depth(hole.counterbore_depth);
    message.set_countersink_diameter(hole.countersink_diameter);
    message.set_countersink_angle(hole.countersink_angle);
  }
  void operator()(const LinearPattern& pattern) {
    v1::LinearPattern& message = *feature_.mutable_linear_pattern();
    message.set_feature(pattern.feature);
    Fill(pattern.step, *message.mutable_step());
    message.set_count(pattern.count);
    Fill(pattern.second_step, *message.mutable_second_step());
    message.set_second_count(pattern.second_count);
  }
  void operator()(const CircularPattern& pattern) {
    v1::CircularPattern& message = *feature_.mutable_circular_pattern();
    message.set_feature(pattern.feature);
    Fill(pattern.axis_point, *message.mutable_axis_point());
    if (pattern.axis_direction) Fill(*pattern.axis_direction, *message.mutable_axis_direction());
    message.set_count(pattern.count);
    message.set_angle(pattern.angle);
  }
  void operator()(const Condition& condition) { parametric::WriteCondition(condition, feature_); }

 private:
  v1::Feature& feature_;
};

}  // namespace

v1::CadTemplate ToProto(const CadTemplate& definition) {
  v1::CadTemplate message;
  message.set_name(definition.name);
  message.set_title(definition.title);
  message.set_description(definition.description);
  message.set_material(definition.material);
  for (const parametric::Parameter& parameter : definition.parameters) {
    *message.add_parameters() = parametric::ToProto(parameter);
  }
  for (const Definition& entry : definition.definitions) {
    v1::CadDefinition& added = *message.add_definitions();
    added.set_name(entry.name);
    added.set_value(entry.value);
  }
  for (const Feature& feature : definition.features) {
    v1::Feature& added = *message.add_features();
    added.set_name(feature.name);
    added.set_present(feature.present);
    std::visit(KindWriter(added), feature.kind);
  }
  message.set_reference_temperature(definition.reference_temperature);
  return message;
}

}  // namespace mortise::cad
