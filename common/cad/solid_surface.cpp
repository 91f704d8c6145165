// Triangulates a solid with the kernel's mesher and joins the faces at their edges.
#include "common/cad/solid_surface.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/triangle_joiner.h"
#include "common/mesh/surface_check.h"

namespace mortise::cad {
namespace {

double DeflectionFor(const Solid& solid, const SurfaceOptions& options) {
  Bnd_Box box;
  BRepBndLib::Add(solid.kernel().shape, box);
  const double diagonal = box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
  return std::max(options.deflection, options.relative_deflection * diagonal);
}

absl::StatusOr<mesh::AssemblySurface> Triangulate(const Solid& solid,
                                                  const SurfaceOptions& options) {
  // The kernel keeps triangles in the shape, which others may be using: work on a copy.
  BRepBuilderAPI_Copy copy(solid.kernel().shape, Standard_False, Standard_False);
  BRepMesh_IncrementalMesh mesher(copy.Shape(), DeflectionFor(solid, options), Standard_False,
                                  options.angle, Standard_False);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(copy.Shape(), TopAbs_FACE, faces);
  TriangleJoiner joiner;
  mesh::AssemblySurface surface;
  for (std::size_t i = 0; i < solid.kernel().faces.size(); ++i) {
    // As it is turned in the solid; ModifiedShape does not tell that.
    const int index = faces.FindIndex(copy.ModifiedShape(solid.kernel().faces[i]));
    MORTISE_RETURN_IF_ERROR(
        joiner.Append(TopoDS::Face(faces(index)), static_cast<int>(i)).status());
    surface.faces.push_back({-1, 0, {{0, solid.face_names()[i]}}});
  }
  joiner.MoveTo(surface);
  if (!mesh::IsBalanced(surface.vertices, surface.triangles)) {
    return KernelFailure("triangulating the solid", "the triangles leave a gap");
  }
  surface.part_interior.resize(3, 0);
  surface.part_names = {solid.name()};
  return surface;
}

}  // namespace

absl::StatusOr<mesh::AssemblySurface> SurfaceOf(const Solid& solid, const SurfaceOptions& options) {
  if (!(options.deflection >= 1e-7 && options.deflection <= 1e3)) {
    return InvalidField("deflection", "is not a length");
  }
  if (!(options.relative_deflection >= 0 && options.relative_deflection < 1)) {
    return InvalidField("relative_deflection", "must be at least 0 and less than 1");
  }
  if (!(options.angle >= 1e-3 && options.angle <= 3)) return InvalidField("angle", "is no angle");
  try {
    return Triangulate(solid, options);
  } catch (const Standard_Failure& failure) {
    return KernelFailure("triangulating the solid", failure.GetMessageString());
  }
}

double SurfaceArea(const Solid& solid) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(solid.kernel().shape, properties);
  return properties.Mass();
}

}  // namespace mortise::cad
