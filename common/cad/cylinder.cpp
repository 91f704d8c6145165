// Builds cylinders with Open CASCADE.
#include "common/cad/cylinder.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <Eigen/Geometry>
#include <Standard_Failure.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Elips.hxx>
#include <memory>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

constexpr double kLeast = 1e-6;   // m; ten times the kernel's tolerance
constexpr double kRound = 1e-12;  // m, by which the radii of a circle may differ

absl::Status Check(const CylinderShape& shape) {
  if (shape.name.empty()) return InvalidField("name", "is empty");
  if (!shape.center.allFinite()) return InvalidField("center", "is not finite");
  if (!(std::abs(shape.u.norm() - 1) < 1e-9 && std::abs(shape.v.norm() - 1) < 1e-9 &&
        std::abs(shape.u.dot(shape.v)) < 1e-9)) {
    return InvalidField("u", "u and v are not unit vectors at a right angle");
  }
  const auto is_length = [](double length) { return std::isfinite(length) && length > kLeast; };
  if (!is_length(shape.radius_u)) return InvalidField("radius_u", "is not greater than 0");
  if (!is_length(shape.radius_v)) return InvalidField("radius_v", "is not greater than 0");
  if (!is_length(shape.height)) return InvalidField("height", "is not greater than 0");
  return absl::OkStatus();
}

TopoDS_Edge Outline(const CylinderShape& shape) {
  const Eigen::Vector3d w = shape.u.cross(shape.v);
  // The kernel's ellipse has its larger radius first.
  const Eigen::Vector3d& longer = shape.radius_u >= shape.radius_v ? shape.u : shape.v;
  const gp_Ax2 axes(gp_Pnt(shape.center.x(), shape.center.y(), shape.center.z()),
                    gp_Dir(w.x(), w.y(), w.z()), gp_Dir(longer.x(), longer.y(), longer.z()));
  const double larger = std::max(shape.radius_u, shape.radius_v);
  const double smaller = std::min(shape.radius_u, shape.radius_v);
  if (larger - smaller < kRound) return BRepBuilderAPI_MakeEdge(gp_Circ(axes, larger)).Edge();
  return BRepBuilderAPI_MakeEdge(gp_Elips(axes, larger, smaller)).Edge();
}

}  // namespace

absl::StatusOr<Solid> MakeCylinder(const CylinderShape& shape) {
  MORTISE_RETURN_IF_ERROR(Check(shape));
  try {
    const TopoDS_Edge outline = Outline(shape);
    const TopoDS_Face base =
        BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(outline).Wire(), Standard_True).Face();
    const Eigen::Vector3d along = shape.height * shape.u.cross(shape.v);
    BRepPrimAPI_MakePrism prism(base, gp_Vec(along.x(), along.y(), along.z()));
    auto kernel = std::make_shared<Solid::Kernel>();
    kernel->name = shape.name;
    kernel->shape = prism.Shape();
    kernel->face_names = {"side", "base", "cap"};
    kernel->faces = {TopoDS::Face(prism.Generated(outline).First()),
                     TopoDS::Face(prism.FirstShape()), TopoDS::Face(prism.LastShape())};
    return Solid(std::move(kernel));
  } catch (const Standard_Failure& failure) {
    return KernelFailure("making a cylinder",
                         absl::StrCat("'", shape.name, "': ", failure.GetMessageString()));
  }
}

}  // namespace mortise::cad
