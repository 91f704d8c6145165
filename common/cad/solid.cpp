// Builds prisms with Open CASCADE and keeps track of which face is which.
#include "common/cad/solid.h"

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <Eigen/Geometry>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Pln.hxx>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/occt_vectors.h"
#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

constexpr double kMinEdge = 1e-6;  // m; ten times the kernel's tolerance

gp_Vec ToVector(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

absl::Status CheckPart(const mesh::PartShape& part) {
  const Eigen::Index corners = part.outline.cols();
  if (part.name.empty()) return InvalidField("name", "is empty");
  if (corners < 3) return InvalidField("outline", "has fewer than three corners");
  if (!part.outline.allFinite() || !part.origin.allFinite()) {
    return InvalidField("outline", "is not finite");
  }
  if (!(part.height > kMinEdge)) return InvalidField("height", "is not greater than 0");
  if (!(std::abs(part.u.norm() - 1) < 1e-9 && std::abs(part.v.norm() - 1) < 1e-9 &&
        std::abs(part.u.dot(part.v)) < 1e-9)) {
    return InvalidField("u", "u and v are not unit vectors at a right angle");
  }
  if (part.face_names.size() != static_cast<std::size_t>(corners) + 2) {
    return InvalidField("face_names",
                        absl::StrCat("has ", part.face_names.size(), " names, not ", corners + 2));
  }
  for (Eigen::Index i = 0; i < corners; ++i) {
    if ((part.outline.col((i + 1) % corners) - part.outline.col(i)).norm() < kMinEdge) {
      return InvalidField("outline", absl::StrCat("edge ", i, " has no length"));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Solid> BuildPrism(const mesh::PartShape& part) {
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = part.name;
  kernel->face_names = part.face_names;
  const Eigen::Vector3d w = part.u.cross(part.v);
  BRepBuilderAPI_MakePolygon polygon;
  for (const auto& corner : part.outline.colwise()) {
    polygon.Add(ToPoint(part.origin + corner.x() * part.u + corner.y() * part.v));
  }
  polygon.Close();
  const gp_Pln plane(ToPoint(part.origin), gp_Dir(ToVector(w)));
  BRepBuilderAPI_MakeFace base(plane, polygon.Wire());
  if (!base.IsDone()) return InvalidField("outline", "bounds no face");
  BRepPrimAPI_MakePrism prism(base.Face(), ToVector(w * part.height));
  kernel->shape = prism.Shape();
  if (kernel->shape.IsNull() || kernel->shape.ShapeType() != TopAbs_SOLID ||
      !BRepCheck_Analyzer(kernel->shape).IsValid()) {
    return InvalidField("outline", absl::StrCat("'", part.name, "' is not a valid solid"));
  }
  for (TopExp_Explorer edge(polygon.Wire(), TopAbs_EDGE); edge.More(); edge.Next()) {
    kernel->faces.push_back(TopoDS::Face(prism.Generated(edge.Current()).First()));
  }
  kernel->faces.push_back(TopoDS::Face(prism.FirstShape()));
  kernel->faces.push_back(TopoDS::Face(prism.LastShape()));
  return Solid(std::move(kernel));
}

GProp_GProps VolumeProperties(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties;
}

}  // namespace

absl::Status KernelFailure(const std::string& operation, const std::string& message) {
  return WithDetail(absl::InternalError(absl::StrCat(operation, " failed: ", message)),
                    {"CAD_FAILED", operation});
}

Solid::Solid(std::shared_ptr<const Kernel> kernel) : kernel_(std::move(kernel)) {}

absl::StatusOr<Solid> Solid::FromPart(const mesh::PartShape& part) {
  MORTISE_RETURN_IF_ERROR(CheckPart(part));
  try {
    return BuildPrism(part);
  } catch (const Standard_Failure& failure) {
    return InvalidField(
        "outline", absl::StrCat("'", part.name, "' cannot be built: ", failure.GetMessageString()));
  }
}

const std::string& Solid::name() const { return kernel_->name; }

const std::vector<std::string>& Solid::face_names() const { return kernel_->face_names; }

double Solid::Volume() const { return AccurateVolume(kernel_->shape); }

Eigen::Vector3d Solid::CentreOfMass() const {
  const gp_Pnt centre = VolumeProperties(kernel_->shape).CentreOfMass();
  return {centre.X(), centre.Y(), centre.Z()};
}

Solid WithFaceNames(const Solid& solid, std::vector<std::string> face_names) {
  auto named = std::make_shared<Solid::Kernel>(solid.kernel());
  named->face_names = std::move(face_names);
  return Solid(std::move(named));
}

}  // namespace mortise::cad
