// Walks over the features, keeping sketches by name, bodies with their names, and the solids that
// patterns repeat.
#include "common/templates/features/feature_regeneration.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <Bnd_Box.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <map>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"
#include "common/templates/features/deferred_combination.h"
#include "common/templates/features/feature_changes.h"
#include "common/templates/features/feature_solids.h"
#include "common/templates/features/named_body.h"
#include "common/templates/features/pattern_placements.h"
#include "common/templates/features/sketch_faces.h"

namespace mortise::cad {
namespace {

using parametric::BoundaryConditionKind;
using parametric::FaceCondition;

// What a pattern repeats.
struct Repeatable {
  Operation operation = Operation::kCut;
  std::string body;
  std::vector<NamedBody> solids;
};

// Whether making the feature looks at bodies as they are. Sketches and holes look at the plane of a
// face at most (FrameOn).
bool ReadsBodies(const Feature& feature) {
  const bool only_adds = std::holds_alternative<Sketch>(feature.kind) ||
                         std::holds_alternative<Hole>(feature.kind) ||
                         std::holds_alternative<Extrude>(feature.kind) ||
                         std::holds_alternative<Revolve>(feature.kind) ||
                         std::holds_alternative<Sweep>(feature.kind) ||
                         std::holds_alternative<LinearPattern>(feature.kind) ||
                         std::holds_alternative<CircularPattern>(feature.kind);
  return !only_adds;
}

// Diagonal of the box around a shape, mm.
double Reach(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  return std::sqrt(box.SquareExtent());
}

// The status of one of several findings is a status of all.
absl::Status StatusOf(const std::vector<FieldViolation>& findings, const std::string& under) {
  std::vector<FieldViolation> placed;
  for (const auto& finding : findings) {
    placed.push_back({absl::StrCat(under, ".", finding.field), finding.message});
  }
  return parametric::ToStatus(placed);
}

class Regeneration {
 public:
  Regeneration(const CadTemplate& definition, const Numbers& numbers)
      : definition_(definition), numbers_(numbers) {}

  absl::Status Make(const Feature& feature) {
    feature_ = &feature;
    if (ReadsBodies(feature)) MORTISE_RETURN_IF_ERROR(Flush());
    return std::visit(*this, feature.kind);
  }

  // Does what has been put off.
  absl::Status Flush() {
    if (!deferred_) return absl::OkStatus();
    const DeferredCombination deferred = *std::move(deferred_);
    deferred_.reset();
    return deferred.Apply(state_);
  }

  absl::Status CheckBodies() const {
    for (const NamedBody& body : state_.bodies) {
      if (!BRepCheck_Analyzer(body.shape).IsValid()) {
        return absl::InvalidArgumentError(
            absl::StrCat("makes body '", body.name, "' an invalid solid"));
      }
    }
    return absl::OkStatus();
  }

  absl::StatusOr<RegeneratedModel> Finish() const;

  absl::Status operator()(const Sketch& sketch);
  absl::Status operator()(const Extrude& extrude) {
    MORTISE_ASSIGN_OR_RETURN(
        auto solids, MakeExtrusion(extrude, name(), sketches_.at(extrude.sketch), numbers_));
    return Use(extrude.operation, extrude.body, "extrude.body", std::move(solids));
  }
  absl::Status operator()(const Revolve& revolve) {
    MORTISE_ASSIGN_OR_RETURN(
        auto solids, MakeRevolution(revolve, name(), sketches_.at(revolve.sketch), numbers_));
    return Use(revolve.operation, revolve.body, "revolve.body", std::move(solids));
  }
  absl::Status operator()(const Sweep& sweep) {
    MORTISE_ASSIGN_OR_RETURN(auto solids, MakeSweep(sweep, name(), sketches_.at(sweep.sketch),
                                                    sketches_.at(sweep.path)));
    return Use(sweep.operation, sweep.body, "sweep.body", std::move(solids));
  }
  absl::Status operator()(const Boolean& boolean);
  absl::Status operator()(const Fillet& fillet) {
    return ApplyFillet(fillet, name(), numbers_, state_);
  }
  absl::Status operator()(const Chamfer& chamfer) {
    return ApplyChamfer(chamfer, name(), numbers_, state_);
  }
  absl::Status operator()(const Draft& draft) {
    return ApplyDraft(draft, name(), numbers_, state_);
  }
  absl::Status operator()(const Shell& shell) {
    return ApplyShell(shell, name(), numbers_, state_);
  }
  absl::Status operator()(const Hole& hole);
  absl::Status operator()(const LinearPattern& pattern) {
    MORTISE_ASSIGN_OR_RETURN(const auto placements, PlacementsOf(pattern, numbers_));
    return Repeat(pattern.feature, placements);
  }
  absl::Status operator()(const CircularPattern& pattern) {
    MORTISE_ASSIGN_OR_RETURN(const auto placements, PlacementsOf(pattern, numbers_));
    return Repeat(pattern.feature, placements);
  }
  absl::Status operator()(const Condition& definition) {
    std::vector<std::optional<double>> values;
    for (const Formula& component : definition.components) {
      std::optional<double>& value = values.emplace_back();
      if (!component.empty()) value = numbers_(component);
    }
    FaceCondition condition;
    static_cast<parametric::ConditionNumbers&>(condition) =
        parametric::NumbersOf(definition.kind, values);
    condition.name = name();
    condition.kind = definition.kind;
    condition.load_case = definition.load_case;
    return AddCondition(std::move(condition), definition.faces);
  }

 private:
  const std::string& name() const { return feature_->name; }

  // The body of this name, the first if empty.
  absl::StatusOr<std::size_t> FindBody(const std::string& body, const std::string& field) const {
    for (std::size_t i = 0; i < state_.bodies.size(); ++i) {
      if (body.empty() || state_.bodies[i].name == body) return i;
    }
    return InvalidField(field, body.empty() ? "there is no body yet"
                                            : absl::StrCat("there is no body '", body, "' here"));
  }

  // The plane of a face, without doing what has been put off if it can be told before.
  absl::StatusOr<FaceFrame> FrameOn(const std::string& face, const std::string& field) {
    if (deferred_) {
      if (const auto before = deferred_->FrameBefore(face, state_)) return *before;
      MORTISE_RETURN_IF_ERROR(Flush());
    }
    return FrameOfFace(state_, face, field);
  }

  // Adds, cuts or intersects; remembers the solids for patterns.
  absl::Status Use(Operation operation, const std::string& body, const std::string& field,
                   std::vector<NamedBody> solids) {
    repeatable_[name()] = {operation, operation == Operation::kNewBody ? name() : body, solids};
    if (operation != Operation::kNewBody) return UseOn(operation, body, field, solids);
    NamedBody made = std::move(solids.front());
    solids.erase(solids.begin());
    if (!solids.empty()) {
      MORTISE_RETURN_IF_ERROR(Combine(Operation::kUnite, solids, name(), made));
    }
    state_.bodies.push_back(std::move(made));
    return absl::OkStatus();
  }

  // Puts the combination off until somebody asks for the body.
  absl::Status UseOn(Operation operation, const std::string& body, const std::string& field,
                     const std::vector<NamedBody>& solids) {
    MORTISE_ASSIGN_OR_RETURN(const std::size_t index, FindBody(body, field));
    if (!deferred_ || !deferred_->Accepts(operation, index)) {
      MORTISE_RETURN_IF_ERROR(Flush());
      deferred_.emplace(operation, index);
    }
    deferred_->Add(name(), solids);
    return absl::OkStatus();
  }

  // Copies of `source` at `placements` do what it did.
  absl::Status Repeat(const std::string& source, const std::vector<gp_Trsf>& placements) {
    const Repeatable& repeatable = repeatable_.at(source);
    state_.patterns[name()] = {source, static_cast<int>(placements.size()) + 1};
    if (placements.empty()) return absl::OkStatus();
    copies_ += placements.size() * repeatable.solids.size();
    if (copies_ > static_cast<std::size_t>(kMaxInstances)) {
      return absl::InvalidArgumentError(
          absl::StrCat("patterns make more than ", kMaxInstances, " copies of solids together"));
    }
    std::vector<NamedBody> copies;
    for (std::size_t i = 0; i < placements.size(); ++i) {
      for (const NamedBody& solid : repeatable.solids) {
        copies.push_back(CopyOf(solid, placements[i], name(), static_cast<int>(i) + 1));
      }
    }
    const Operation operation =
        repeatable.operation == Operation::kNewBody ? Operation::kUnite : repeatable.operation;
    return UseOn(operation, repeatable.body, "", copies);
  }

  absl::Status AddCondition(FaceCondition condition, const std::vector<std::string>& faces) {
    if (!parametric::ActsOnFace(condition.kind)) {
      conditions_.push_back(std::move(condition));
      return absl::OkStatus();
    }
    MORTISE_ASSIGN_OR_RETURN(const FoundFaces found,
                             FindFaces(state_, faces, parametric::FacesField(condition.kind)));
    // Faces of a condition follow later features as all names do.
    state_.bodies[found.body].names.push_back({{name(), kNoInstance, {}}, found.faces, {}});
    conditions_.push_back(std::move(condition));
    return absl::OkStatus();
  }

  bool IsCondition(const FaceName& name) const {
    return std::any_of(conditions_.begin(), conditions_.end(), [&](const FaceCondition& condition) {
      return condition.name == name.feature;
    });
  }

  absl::Status PlaceOf(const std::string& feature, const std::string& message) const {
    for (std::size_t i = 0; i < definition_.features.size(); ++i) {
      if (definition_.features[i].name == feature) {
        return InvalidField(absl::StrCat("features[", i, "]"), message);
      }
    }
    return InvalidField("features", message);
  }

  const CadTemplate& definition_;
  const Numbers& numbers_;
  const Feature* feature_ = nullptr;
  std::map<std::string, BuiltSketch> sketches_;
  std::map<std::string, Repeatable> repeatable_;
  ModelState state_;
  std::optional<DeferredCombination> deferred_;
  std::size_t copies_ = 0;  // of solids, by patterns
  std::vector<FaceCondition> conditions_;
};

absl::Status Regeneration::operator()(const Sketch& sketch) {
  gp_Ax3 face_frame;
  if (!sketch.plane.face.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const FaceFrame face, FrameOn(sketch.plane.face, "sketch.plane.face"));
    face_frame = face.frame;
  }
  MORTISE_ASSIGN_OR_RETURN(
      const gp_Ax3 frame,
      FrameOf(sketch.plane, numbers_, sketch.plane.face.empty() ? nullptr : &face_frame));
  std::vector<FieldViolation> findings;
  std::vector<CurveLoop> loops = ResolveSketch(sketch, numbers_, findings);
  MORTISE_RETURN_IF_ERROR(StatusOf(findings, "sketch"));
  MORTISE_ASSIGN_OR_RETURN(BuiltSketch built, BuildSketch(std::move(loops), frame));
  sketches_.emplace(name(), std::move(built));
  return absl::OkStatus();
}

absl::Status Regeneration::operator()(const Boolean& boolean) {
  MORTISE_ASSIGN_OR_RETURN(const std::size_t target, FindBody(boolean.body, "boolean.body"));
  const std::string target_name = state_.bodies[target].name;
  std::vector<NamedBody> tools;
  for (std::size_t i = 0; i < boolean.tools.size(); ++i) {
    const std::string field = absl::StrCat("boolean.tools[", i, "]");
    MORTISE_ASSIGN_OR_RETURN(const std::size_t index, FindBody(boolean.tools[i], field));
    if (boolean.tools[i] == target_name) return InvalidField(field, "is the body itself");
    tools.push_back(state_.bodies[index]);
    state_.bodies.erase(state_.bodies.begin() + static_cast<std::ptrdiff_t>(index));
  }
  MORTISE_ASSIGN_OR_RETURN(const std::size_t body, FindBody(target_name, "boolean.body"));
  return Combine(boolean.operation, tools, name(), state_.bodies[body]);
}

absl::Status Regeneration::operator()(const Hole& hole) {
  MORTISE_ASSIGN_OR_RETURN(const FaceFrame face, FrameOn(hole.face, "hole.face"));
  const gp_Vec up(face.frame.Direction());
  gp_Pnt position = KernelPoint(numbers_(hole.position));
  position.Translate(up * -gp_Vec(face.frame.Location(), position).Dot(up));
  const NamedBody& body = state_.bodies[face.body];
  MORTISE_ASSIGN_OR_RETURN(NamedBody drill,
                           MakeDrill(hole, name(), gp_Ax3(position, face.frame.Direction()),
                                     Reach(body.shape), numbers_));
  return Use(Operation::kCut, body.name, "hole.face", {std::move(drill)});
}

absl::StatusOr<RegeneratedModel> Regeneration::Finish() const {
  if (state_.bodies.empty()) return InvalidField("features", "make no body");
  if (state_.bodies.size() > 1) {
    return PlaceOf(state_.bodies[1].name, absl::StrCat("body '", state_.bodies[1].name,
                                                       "' is left over: a template is one solid"));
  }
  const NamedBody& body = state_.bodies.front();
  if (body.shape.ShapeType() != TopAbs_SOLID) {
    int solids = 0;
    for (TopExp_Explorer solid(body.shape, TopAbs_SOLID); solid.More(); solid.Next()) ++solids;
    return InvalidField("features",
                        absl::StrCat("body '", body.name, "' falls into ", solids, " solids"));
  }
  gp_Trsf to_metres;
  to_metres.SetScale(gp_Pnt(), 1 / kModelScale);
  BRepBuilderAPI_Transform scaled(body.shape, to_metres, Standard_True);
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = definition_.title.empty() ? definition_.name : definition_.title;
  kernel->shape = scaled.Shape();
  if (!BRepCheck_Analyzer(kernel->shape).IsValid()) {
    return InvalidField("features", "make an invalid solid");
  }
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(body.shape, TopAbs_FACE, faces);
  std::vector<std::vector<FaceName>> origins(static_cast<std::size_t>(faces.Extent()));
  std::vector<FaceCondition> conditions = conditions_;
  for (const NamedFaces& named : body.names) {
    for (const TopoDS_Face& face : named.faces) {
      const int index = faces.FindIndex(face) - 1;
      if (!IsCondition(named.name)) {
        origins[static_cast<std::size_t>(index)].push_back(named.name);
        continue;
      }
      for (FaceCondition& condition : conditions) {
        if (condition.name == named.name.feature) condition.faces.push_back(index);
      }
    }
  }
  for (const FaceCondition& condition : conditions) {
    if (condition.faces.empty() && parametric::ActsOnFace(condition.kind)) {
      return PlaceOf(condition.name,
                     absl::StrCat("later features removed all faces of '", condition.name, "'"));
    }
  }
  TopTools_IndexedMapOfShape scaled_faces;  // as they are turned in the solid
  TopExp::MapShapes(kernel->shape, TopAbs_FACE, scaled_faces);
  for (int i = 1; i <= faces.Extent(); ++i) {
    const int index = scaled_faces.FindIndex(scaled.ModifiedShape(faces(i)));
    kernel->faces.push_back(TopoDS::Face(scaled_faces(index)));
    std::vector<FaceName>& names = origins[static_cast<std::size_t>(i) - 1];
    if (names.empty()) names.push_back({body.name, kNoInstance, {}});  // the kernel did not tell
    kernel->face_names.push_back(ToString(names.front()));
  }
  std::optional<double> reference;
  if (!definition_.reference_temperature.empty()) {
    reference = numbers_(definition_.reference_temperature);
  }
  return RegeneratedModel{Solid(std::move(kernel)), std::move(origins), std::move(conditions),
                          reference};
}

}  // namespace

absl::StatusOr<RegeneratedModel> RegenerateFeatures(const CadTemplate& definition,
                                                    const Numbers& numbers, bool one_by_one) {
  Regeneration regeneration(definition, numbers);
  for (std::size_t i = 0; i < definition.features.size(); ++i) {
    if (!numbers.IsPresent(i)) continue;
    const std::string place = absl::StrCat("features[", i, "]");
    try {
      absl::Status status = regeneration.Make(definition.features[i]);
      if (status.ok() && one_by_one) status = regeneration.Flush();
      if (status.ok() && one_by_one) status = regeneration.CheckBodies();
      if (status.ok()) continue;
      if (absl::IsInternal(status)) return status;  // no fault of the feature
      if (!DetailOf(status).field.empty()) return UnderField(place, status);
      return InvalidField(place, absl::StrCat("'", definition.features[i].name,
                                              "': ", std::string(status.message())));
    } catch (const Standard_Failure& failure) {
      return InvalidField(
          place, absl::StrCat("'", definition.features[i].name,
                              "' cannot be made, the kernel says: ", failure.GetMessageString()));
    }
  }
  try {
    MORTISE_RETURN_IF_ERROR(regeneration.Flush());
    return regeneration.Finish();
  } catch (const Standard_Failure& failure) {
    return KernelFailure("finishing the solid", failure.GetMessageString());
  }
}

}  // namespace mortise::cad
