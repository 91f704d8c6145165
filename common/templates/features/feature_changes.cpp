// Applies the kernel's local operations.
#include "common/templates/features/feature_changes.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepOffsetAPI_DraftAngle.hxx>
#include <BRepOffsetAPI_MakeThickSolid.hxx>
#include <TopTools_ListOfShape.hxx>
#include <gp_Pln.hxx>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/templates/features/blending.h"

namespace mortise::cad {
namespace {

constexpr double kOffsetTolerance = 1e-3;  // mm

FaceName Made(const std::string& feature) { return {feature, kNoInstance, {}}; }

}  // namespace

absl::Status ApplyFillet(const Fillet& fillet, const std::string& feature, const Numbers& numbers,
                         ModelState& state) {
  MORTISE_ASSIGN_OR_RETURN(const FoundEdges found, FindEdges(state, fillet.edges, "fillet.edges"));
  NamedBody& body = state.bodies[found.body];
  MORTISE_ASSIGN_OR_RETURN(const auto blend, BlendEdges(BlendKind::kFillet, body.shape, found,
                                                        feature, numbers(fillet.radius)));
  Follow(*blend, blend->Shape(), Made(feature), body);
  return absl::OkStatus();
}

absl::Status ApplyChamfer(const Chamfer& chamfer, const std::string& feature,
                          const Numbers& numbers, ModelState& state) {
  MORTISE_ASSIGN_OR_RETURN(const FoundEdges found,
                           FindEdges(state, chamfer.edges, "chamfer.edges"));
  NamedBody& body = state.bodies[found.body];
  MORTISE_ASSIGN_OR_RETURN(const auto blend, BlendEdges(BlendKind::kChamfer, body.shape, found,
                                                        feature, numbers(chamfer.distance)));
  Follow(*blend, blend->Shape(), Made(feature), body);
  return absl::OkStatus();
}

absl::StatusOr<FaceFrame> FrameOfFace(const ModelState& state, const std::string& reference,
                                      const std::string& field) {
  auto found = FindFaces(state, {reference}, field);
  // The field is one reference, not a list of them.
  if (!found.ok()) {
    const std::string message(found.status().message());
    const std::size_t colon = message.find(": ");
    return InvalidField(field, colon == std::string::npos ? message : message.substr(colon + 2));
  }
  FaceFrame result;
  result.body = found->body;
  for (std::size_t i = 0; i < found->faces.size(); ++i) {
    const TopoDS_Face& face = found->faces[i];
    const BRepAdaptor_Surface surface(face);
    if (surface.GetType() != GeomAbs_Plane) {
      return InvalidField(field, absl::StrCat("face '", reference, "' is not plane"));
    }
    const gp_Pln plane = surface.Plane();
    gp_Dir normal = plane.Axis().Direction();
    if (!plane.Direct()) normal.Reverse();
    if (face.Orientation() == TopAbs_REVERSED) normal.Reverse();
    if (i == 0) {
      result.frame = gp_Ax3(plane.Location(), normal);
    } else if (!normal.IsEqual(result.frame.Direction(), 1e-6) ||
               std::abs(gp_Vec(result.frame.Location(), plane.Location()).Dot(gp_Vec(normal))) >
                   1e-3) {
      return InvalidField(field,
                          absl::StrCat("'", reference, "' are faces in more than one plane"));
    }
  }
  return result;
}

absl::Status ApplyDraft(const Draft& draft, const std::string& feature, const Numbers& numbers,
                        ModelState& state) {
  MORTISE_ASSIGN_OR_RETURN(const FoundFaces found, FindFaces(state, draft.faces, "draft.faces"));
  MORTISE_ASSIGN_OR_RETURN(const FaceFrame neutral,
                           FrameOfFace(state, draft.neutral, "draft.neutral"));
  if (neutral.body != found.body) {
    return InvalidField("draft.neutral", "is on another body than the faces");
  }
  NamedBody& body = state.bodies[found.body];
  BRepOffsetAPI_DraftAngle maker(body.shape);
  const gp_Dir inwards = neutral.frame.Direction().Reversed();
  const gp_Pln plane(neutral.frame);
  for (std::size_t i = 0; i < found.faces.size(); ++i) {
    maker.Add(found.faces[i], inwards, numbers(draft.angle), plane);
    if (!maker.AddDone()) {
      return InvalidField("draft.faces",
                          "a face cannot be leaned: only plane faces, cylinders and "
                          "cones that cross the neutral plane can");
    }
  }
  maker.Build();
  if (!maker.IsDone()) {
    return InvalidField("draft.angle", "the faces cannot be leaned so far");
  }
  Follow(maker, maker.Shape(), Made(feature), body);
  return absl::OkStatus();
}

absl::Status ApplyShell(const Shell& shell, const std::string& feature, const Numbers& numbers,
                        ModelState& state) {
  MORTISE_ASSIGN_OR_RETURN(const FoundFaces found,
                           FindFaces(state, shell.open_faces, "shell.open_faces"));
  NamedBody& body = state.bodies[found.body];
  TopTools_ListOfShape open;
  for (const TopoDS_Face& face : found.faces) open.Append(face);
  BRepOffsetAPI_MakeThickSolid maker;
  maker.MakeThickSolidByJoin(body.shape, open, -numbers(shell.thickness) * kModelScale,
                             kOffsetTolerance, BRepOffset_Skin, Standard_False, Standard_False,
                             GeomAbs_Intersection);
  maker.Build();
  if (!maker.IsDone()) {
    return InvalidField("shell.thickness",
                        absl::StrCat("walls of ", numbers(shell.thickness), " m cannot be made"));
  }
  Follow(maker, maker.Shape(), Made(feature), body);
  return absl::OkStatus();
}

}  // namespace mortise::cad
