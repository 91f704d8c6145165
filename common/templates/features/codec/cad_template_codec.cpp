// Converts messages to structs.
#include "common/templates/features/codec/cad_template_codec.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/design/template_validation.h"
#include "common/files/condition_codec.h"
#include "common/files/template_codec.h"
#include "common/messages/proto_text.h"

namespace mortise::cad {
namespace {

using google::protobuf::RepeatedPtrField;

std::vector<std::string> List(const RepeatedPtrField<std::string>& texts) {
  return {texts.begin(), texts.end()};
}

Formula2 Pair(const v1::SketchPoint& point) { return {point.x(), point.y()}; }

Formula3 Triple(const v1::SpacePoint& point) { return {point.x(), point.y(), point.z()}; }

// Reads the features of one message; `findings` are what structs cannot hold.
class FeatureReader {
 public:
  explicit FeatureReader(std::vector<FieldViolation>& findings) : findings_(findings) {}

  Feature Read(const v1::Feature& message, const std::string& place) {
    place_ = place;
    Feature feature;
    feature.name = message.name();
    feature.present = message.present();
    switch (message.kind_case()) {
      case v1::Feature::kSketch:
        feature.kind = ReadSketch(message.sketch());
        break;
      case v1::Feature::kExtrude:
        feature.kind = ReadExtrude(message.extrude());
        break;
      case v1::Feature::kRevolve:
        feature.kind = ReadRevolve(message.revolve());
        break;
      case v1::Feature::kSweep:
        feature.kind = Sweep{message.sweep().sketch(), message.sweep().path(),
                             ReadOperation(message.sweep().operation()), message.sweep().body()};
        break;
      case v1::Feature::kBoolean:
        feature.kind = Boolean{ReadOperation(message.boolean().operation()),
                               message.boolean().body(), List(message.boolean().tools())};
        break;
      case v1::Feature::kFillet:
        feature.kind = Fillet{List(message.fillet().edges()), message.fillet().radius()};
        break;
      case v1::Feature::kChamfer:
        feature.kind = Chamfer{List(message.chamfer().edges()), message.chamfer().distance()};
        break;
      case v1::Feature::kDraft:
        feature.kind = Draft{List(message.draft().faces()), message.draft().neutral(),
                             message.draft().angle()};
        break;
      case v1::Feature::kShell:
        feature.kind = Shell{List(message.shell().open_faces()), message.shell().thickness()};
        break;
      case v1::Feature::kHole:
        feature.kind = ReadHole(message.hole());
        break;
      case v1::Feature::kLinearPattern:
        feature.kind = ReadRow(message.linear_pattern());
        break;
      case v1::Feature::kCircularPattern:
        feature.kind = ReadRing(message.circular_pattern());
        break;
      case v1::Feature::kFixed:
      case v1::Feature::kForce:
      case v1::Feature::kPressure:
      case v1::Feature::kHeat:
      case v1::Feature::kSymmetric:
      case v1::Feature::kDisplacement:
      case v1::Feature::kGravity:
      case v1::Feature::kRotation:
        feature.kind = *parametric::ReadCondition(message, place_, findings_);
        break;
      case v1::Feature::KIND_NOT_SET:
        findings_.push_back({place_, "does not say what kind of feature it is"});
        break;
    }
    return feature;
  }

 private:
  Extrude ReadExtrude(const v1::Extrude& message) {
    return {message.sketch(), message.from(), message.to(), ReadOperation(message.operation()),
            message.body()};
  }

  Revolve ReadRevolve(const v1::Revolve& message) {
    return {message.sketch(), Pair(message.axis_point()),         Pair(message.axis_direction()),
            message.angle(),  ReadOperation(message.operation()), message.body()};
  }

  Operation ReadOperation(v1::Feature::Operation operation) {
    switch (operation) {
      case v1::Feature::OPERATION_UNSPECIFIED:
      case v1::Feature::NEW_BODY:
        return Operation::kNewBody;
      case v1::Feature::UNITE:
        return Operation::kUnite;
      case v1::Feature::CUT:
        return Operation::kCut;
      case v1::Feature::INTERSECT:
        return Operation::kIntersect;
      default:
        findings_.push_back({place_, "has an operation that is not known"});
        return Operation::kNewBody;
    }
  }

  Sketch ReadSketch(const v1::Sketch& message) {
    Sketch sketch;
    sketch.plane.origin = Triple(message.plane().origin());
    if (message.plane().has_normal()) sketch.plane.normal = Triple(message.plane().normal());
    if (message.plane().has_x_axis()) sketch.plane.x_axis = Triple(message.plane().x_axis());
    sketch.plane.face = message.plane().face();
    for (int i = 0; i < message.profiles_size(); ++i) {
      const v1::SketchProfile& profile = message.profiles(i);
      sketch.profiles.push_back({profile.name(), profile.hole_of(), {}});
      if (profile.shape_case() == v1::SketchProfile::SHAPE_NOT_SET) {
        findings_.push_back({absl::StrCat(place_, ".sketch.profiles[", i, "]"), "has no shape"});
      } else {
        sketch.profiles.back().shape = ReadShape(profile);
      }
    }
    return sketch;
  }

  static decltype(SketchProfile::shape) ReadShape(const v1::SketchProfile& profile) {
    if (profile.has_circle()) {
      return SketchCircle{Pair(profile.circle().center()), profile.circle().radius()};
    }
    if (profile.has_rectangle()) {
      const v1::SketchRectangle& rectangle = profile.rectangle();
      return SketchRectangle{Pair(rectangle.center()), rectangle.width(), rectangle.height(),
                             rectangle.round()};
    }
    if (profile.has_polygon()) {
      const v1::SketchPolygon& polygon = profile.polygon();
      return SketchPolygon{Pair(polygon.center()), polygon.radius(), polygon.sides(),
                           polygon.angle()};
    }
    SketchPath path{Pair(profile.path().start()), {}, profile.path().open()};
    for (const v1::SketchSegment& message : profile.path().segments()) {
      SketchSegment segment{message.name(), Pair(message.to()), {}, message.round()};
      if (message.has_through()) segment.through = Pair(message.through());
      path.segments.push_back(std::move(segment));
    }
    return path;
  }

  static Hole ReadHole(const v1::DrilledHole& message) {
    return {message.face(),
            Triple(message.position()),
            message.diameter(),
            message.depth(),
            message.counterbore_diameter(),
            message.counterbore_depth(),
            message.countersink_diameter(),
            message.countersink_angle()};
  }

  static LinearPattern ReadRow(const v1::LinearPattern& message) {
    return {message.feature(), Triple(message.step()), message.count(),
            Triple(message.second_step()), message.second_count()};
  }

  static CircularPattern ReadRing(const v1::CircularPattern& message) {
    CircularPattern pattern{
        message.feature(), Triple(message.axis_point()), {}, message.count(), message.angle()};
    if (message.has_axis_direction()) pattern.axis_direction = Triple(message.axis_direction());
    return pattern;
  }

  std::vector<FieldViolation>& findings_;
  std::string place_;
};

}  // namespace

absl::StatusOr<CadTemplate> FromProto(const v1::CadTemplate& message) {
  CadTemplate definition{message.name(),
                         message.title(),
                         message.description(),
                         message.material(),
                         {},
                         {},
                         {},
                         message.reference_temperature()};
  for (const v1::Parameter& parameter : message.parameters()) {
    definition.parameters.push_back(parametric::FromProto(parameter));
  }
  for (const v1::CadDefinition& entry : message.definitions()) {
    definition.definitions.push_back({entry.name(), entry.value()});
  }
  std::vector<FieldViolation> findings;
  FeatureReader reader(findings);
  for (int i = 0; i < message.features_size(); ++i) {
    definition.features.push_back(
        reader.Read(message.features(i), absl::StrCat("features[", i, "]")));
  }
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  return definition;
}

absl::StatusOr<CadTemplate> ParseCadTemplateText(std::string_view text, const std::string& origin) {
  v1::CadTemplate message;
  MORTISE_RETURN_IF_ERROR(parametric::ParseProtoText(text, origin, message));
  return FromProto(message);
}

}  // namespace mortise::cad
