// Checks names and references of features in one pass from first to last.
#include "common/templates/features/feature_checks.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "common/base/names/offered_names.h"
#include "common/design/solid_head_checks.h"
#include "common/templates/features/feature_reference.h"
#include "common/templates/features/feature_roles.h"

namespace mortise::cad {
namespace {

constexpr std::size_t kMaxProfiles = 200;
constexpr std::size_t kMaxSegments = 500;
constexpr std::size_t kMaxReferences = 200;

class FeatureChecker {
 public:
  explicit FeatureChecker(const CadTemplate& definition) : definition_(definition) {}

  std::vector<FieldViolation> Check() {
    parametric::CheckSolidTexts(definition_.name, definition_.title, definition_.description,
                                definition_.material, findings_);
    parametric::CheckSolidParameters(definition_.parameters, number_names_, findings_);
    CheckDefinitions();
    Count("features", definition_.features.size(), 1, kMaxFeatures);
    bool makes_body = false;
    for (std::size_t i = 0; i < std::min(definition_.features.size(), kMaxFeatures); ++i) {
      const Feature& feature = definition_.features[i];
      place_ = absl::StrCat("features[", i, "]");
      CheckName(place_ + ".name", feature.name, feature_names_);
      place_ += ".";
      feature_ = &feature;
      if (!feature.present.empty()) CheckCanBeAbsent(feature);
      std::visit(*this, feature.kind);
      makes_body = makes_body || !bodies_.empty();
      earlier_.emplace(feature.name, &feature);
    }
    if (!makes_body) Report("features", "make no body");
    parametric::CheckConditionsTogether("features", uses_, definition_.reference_temperature,
                                        findings_);
    return std::move(findings_);
  }

  void operator()(const Sketch& sketch) {
    if (!sketch.plane.face.empty()) {
      Face("sketch.plane.face", sketch.plane.face);
      if (sketch.plane.normal) Here("sketch.plane.normal", "is given by the face already");
    }
    Count(place_ + "sketch.profiles", sketch.profiles.size(), 1, kMaxProfiles);
    std::set<std::string> names;
    std::set<std::string> outer;
    for (const SketchProfile& profile : sketch.profiles) {
      if (profile.hole_of.empty()) outer.insert(profile.name);
    }
    for (std::size_t i = 0; i < std::min(sketch.profiles.size(), kMaxProfiles); ++i) {
      const SketchProfile& profile = sketch.profiles[i];
      const std::string field = absl::StrCat("sketch.profiles[", i, "]");
      CheckName(place_ + field + ".name", profile.name, names);
      if (profile.name == "start" || profile.name == "end") {
        Here(field + ".name", "'start' and 'end' are the caps of an extrusion");
      }
      if (!profile.hole_of.empty() && !outer.contains(profile.hole_of)) {
        Here(field + ".hole_of", absl::StrCat("there is no profile '", profile.hole_of,
                                              "' of material in this sketch"));
      }
      if (const auto* path = std::get_if<SketchPath>(&profile.shape)) CheckPath(*path, field);
    }
    if (HasOpenPath(sketch) && sketch.profiles.size() > 1) {
      Here("sketch.profiles", "an open path must be the only profile of its sketch");
    }
  }

  void operator()(const Extrude& extrude) {
    Regions("extrude.sketch", extrude.sketch);
    Body(extrude.operation, "extrude.body", extrude.body);
  }
  void operator()(const Revolve& revolve) {
    Regions("revolve.sketch", revolve.sketch);
    if (revolve.axis_direction.x.empty() && revolve.axis_direction.y.empty()) {
      Here("revolve.axis_direction", "is missing");
    }
    Body(revolve.operation, "revolve.body", revolve.body);
  }
  void operator()(const Sweep& sweep) {
    Regions("sweep.sketch", sweep.sketch);
    if (const Sketch* path = SketchOf("sweep.path", sweep.path)) {
      if (!HasOpenPath(*path)) Here("sweep.path", "is a sketch without an open path");
    }
    Body(sweep.operation, "sweep.body", sweep.body);
  }
  void operator()(const Boolean& boolean) {
    if (boolean.operation == Operation::kNewBody) {
      Here("boolean.operation", "must be UNITE, CUT or INTERSECT");
    }
    ExistingBody("boolean.body", boolean.body);
    Count(place_ + "boolean.tools", boolean.tools.size(), 1, kMaxReferences);
    std::set<std::string> seen;
    for (std::size_t i = 0; i < boolean.tools.size(); ++i) {
      const std::string field = absl::StrCat("boolean.tools[", i, "]");
      if (boolean.tools[i].empty()) {
        Here(field, "is empty");
      } else if (!seen.insert(boolean.tools[i]).second) {
        Here(field, absl::StrCat("'", boolean.tools[i], "' occurs twice"));
      } else {
        ExistingBody(field, boolean.tools[i]);
      }
    }
    for (const std::string& tool : seen) bodies_.erase(tool);
  }
  void operator()(const Fillet& fillet) { Edges("fillet.edges", fillet.edges); }
  void operator()(const Chamfer& chamfer) { Edges("chamfer.edges", chamfer.edges); }
  void operator()(const Draft& draft) {
    Faces("draft.faces", draft.faces);
    Face("draft.neutral", draft.neutral);
  }
  void operator()(const Shell& shell) { Faces("shell.open_faces", shell.open_faces); }
  void operator()(const Hole& hole) {
    Face("hole.face", hole.face);
    const bool counterbore = !hole.counterbore_diameter.empty();
    if (counterbore != !hole.counterbore_depth.empty()) {
      Here("hole.counterbore_depth", "and counterbore_diameter belong together");
    }
    if (counterbore && !hole.countersink_diameter.empty()) {
      Here("hole.countersink_diameter", "does not go with a counterbore");
    }
    if (hole.countersink_diameter.empty() && !hole.countersink_angle.empty()) {
      Here("hole.countersink_angle", "has no countersink_diameter");
    }
  }
  void operator()(const LinearPattern& pattern) {
    Source("linear_pattern.feature", pattern.feature);
    const Formula3& second = pattern.second_step;
    const bool has_step = !second.x.empty() || !second.y.empty() || !second.z.empty();
    if (has_step != !pattern.second_count.empty()) {
      Here("linear_pattern.second_count", "and second_step belong together");
    }
  }
  void operator()(const CircularPattern& pattern) {
    Source("circular_pattern.feature", pattern.feature);
  }
  void operator()(const Condition& condition) {
    std::string field = place_;
    field.pop_back();
    parametric::CheckCondition(field, condition.kind, condition.components, condition.load_case,
                               findings_);
    uses_.push_back({condition.kind, condition.load_case});
    if (parametric::ActsOnFace(condition.kind)) {
      Faces(parametric::FacesField(condition.kind), condition.faces);
    }
  }

 private:
  void Report(const std::string& field, const std::string& message) {
    findings_.push_back({field, message});
  }
  // Within the feature at hand.
  void Here(const std::string& field, const std::string& message) {
    Report(place_ + field, message);
  }

  void Count(const std::string& field, std::size_t count, std::size_t least, std::size_t most) {
    parametric::CheckCount(field, count, least, most, findings_);
  }

  void CheckName(const std::string& field, const std::string& name, std::set<std::string>& seen) {
    parametric::CheckUniqueName(field, name, seen, findings_);
  }

  void CheckDefinitions() {
    Count("definitions", definition_.definitions.size(), 0, kMaxDefinitions);
    for (std::size_t i = 0; i < definition_.definitions.size(); ++i) {
      parametric::CheckNumberName(absl::StrCat("definitions[", i, "].name"),
                                  definition_.definitions[i].name, number_names_, findings_);
    }
  }

  void CheckPath(const SketchPath& path, const std::string& field) {
    Count(place_ + field + ".path.segments", path.segments.size(), 1, kMaxSegments);
    std::set<std::string> names;
    for (std::size_t i = 0; i < std::min(path.segments.size(), kMaxSegments); ++i) {
      const std::string place = absl::StrCat(place_, field, ".path.segments[", i, "].name");
      CheckName(place, path.segments[i].name, names);
      if (!path.segments[i].round.empty()) {
        CheckName(place, path.segments[i].name + "_round", names);
      }
    }
  }

  static bool HasOpenPath(const Sketch& sketch) {
    return std::any_of(sketch.profiles.begin(), sketch.profiles.end(), [](const auto& profile) {
      const auto* path = std::get_if<SketchPath>(&profile.shape);
      return path != nullptr && path->open;
    });
  }

  // The feature of this name; null, and a finding, if there is none before this one.
  const Feature* Earlier(const std::string& field, const std::string& name) {
    const auto found = earlier_.find(name);
    if (found != earlier_.end()) return found->second;
    const bool is_later = std::any_of(definition_.features.begin(), definition_.features.end(),
                                      [&](const Feature& feature) { return feature.name == name; });
    Here(field, is_later ? absl::StrCat("'", name, "' is not before this feature")
                         : absl::StrCat("there is no feature '", name, "'",
                                        NamesOffered(name, definition_.features, &Feature::name)));
    return nullptr;
  }

  const Sketch* SketchOf(const std::string& field, const std::string& name) {
    const Feature* feature = Earlier(field, name);
    if (feature == nullptr) return nullptr;
    const auto* sketch = std::get_if<Sketch>(&feature->kind);
    if (sketch == nullptr) Here(field, absl::StrCat("'", name, "' is not a sketch"));
    return sketch;
  }

  void Regions(const std::string& field, const std::string& name) {
    const Sketch* sketch = SketchOf(field, name);
    if (sketch != nullptr && HasOpenPath(*sketch)) {
      Here(field, absl::StrCat("'", name, "' is an open path, which bounds nothing"));
    }
  }

  void Body(Operation operation, const std::string& field, const std::string& body) {
    if (operation != Operation::kNewBody) {
      ExistingBody(field, body);
      return;
    }
    if (!body.empty()) Here(field, "is given, but the feature makes a new body");
    bodies_.insert(feature_->name);
  }

  void ExistingBody(const std::string& field, const std::string& body) {
    if (body.empty() ? bodies_.empty() : !bodies_.contains(body)) {
      Here(field, body.empty() ? "there is no body yet"
                               : absl::StrCat("there is no body '", body, "' here"));
    }
  }

  // What is to be there for others cannot be left out.
  void CheckCanBeAbsent(const Feature& feature) {
    const auto makes_body = [](const auto* solid) {
      return solid != nullptr && solid->operation == Operation::kNewBody;
    };
    if (std::holds_alternative<Sketch>(feature.kind)) {
      Here("present", "does not go with a sketch, which makes nothing by itself");
    } else if (std::holds_alternative<Boolean>(feature.kind)) {
      Here("present", "does not go with a feature that uses bodies up");
    } else if (makes_body(std::get_if<Extrude>(&feature.kind)) ||
               makes_body(std::get_if<Revolve>(&feature.kind)) ||
               makes_body(std::get_if<Sweep>(&feature.kind))) {
      Here("present", "does not go with a feature that makes a new body");
    }
  }

  void Source(const std::string& field, const std::string& name) {
    const Feature* feature = Earlier(field, name);
    if (feature == nullptr) return;
    if (!feature->present.empty()) {
      Here(field, absl::StrCat("'", name, "' may be absent, and so cannot be repeated"));
    }
    if (!MakesSolid(*feature)) {
      Here(field, "must be an extrude, revolve, sweep or hole");
    } else if (Intersects(*feature)) {
      Here(field, "is an INTERSECT, which cannot be repeated");
    }
  }

  void Faces(const std::string& field, const std::vector<std::string>& references) {
    Count(place_ + field, references.size(), 1, kMaxReferences);
    for (std::size_t i = 0; i < std::min(references.size(), kMaxReferences); ++i) {
      Face(absl::StrCat(field, "[", i, "]"), references[i]);
    }
  }

  void Face(const std::string& field, const std::string& text) {
    const auto reference = ParseFaceReference(text);
    if (reference.ok()) {
      Meaning(field, *reference);
    } else {
      Here(field, std::string(reference.status().message()));
    }
  }

  void Edges(const std::string& field, const std::vector<std::string>& references) {
    Count(place_ + field, references.size(), 1, kMaxReferences);
    for (std::size_t i = 0; i < std::min(references.size(), kMaxReferences); ++i) {
      const std::string place = absl::StrCat(field, "[", i, "]");
      const auto reference = ParseEdgeReference(references[i]);
      if (!reference.ok()) {
        Here(place, std::string(reference.status().message()));
        continue;
      }
      Meaning(place, reference->face);
      if (reference->other) Meaning(place, *reference->other);
    }
  }

  // Whether a reference can mean a face at all.
  void Meaning(const std::string& field, const FaceName& reference) {
    const Feature* feature = Earlier(field, reference.feature);
    if (feature == nullptr) return;
    const std::string* source = nullptr;
    if (const auto* row = std::get_if<LinearPattern>(&feature->kind)) source = &row->feature;
    if (const auto* ring = std::get_if<CircularPattern>(&feature->kind)) source = &ring->feature;
    if (source == nullptr && reference.instance != kNoInstance) {
      Here(field, absl::StrCat("'", reference.feature, "' is not a pattern"));
      return;
    }
    if (source != nullptr) {
      const auto repeated = earlier_.find(*source);
      if (repeated == earlier_.end()) return;  // a finding at the pattern
      feature = repeated->second;
    }
    if (!MakesFace(*feature, reference.role, earlier_)) {
      Here(field, absl::StrCat("'", feature->name, "' makes no face '", reference.role, "'"));
    }
  }

  const CadTemplate& definition_;
  std::vector<FieldViolation> findings_;
  std::string place_;                 // "features[3]."
  const Feature* feature_ = nullptr;  // the one at hand
  std::set<std::string> number_names_, feature_names_;
  FeaturesByName earlier_;
  std::set<std::string> bodies_;  // that exist at the feature at hand
  std::vector<parametric::ConditionUse> uses_;
};

}  // namespace

std::vector<FieldViolation> CheckFeatures(const CadTemplate& definition) {
  return FeatureChecker(definition).Check();
}

}  // namespace mortise::cad
