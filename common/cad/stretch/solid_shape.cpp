#include "common/cad/stretch/solid_shape.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BinTools.hxx>
#include <Eigen/Geometry>
#include <GProp_GProps.hxx>
#include <ShapeCustom.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/faceted_solid.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/solid_surface.h"
#include "common/cad/stretch/solid_stretch.h"

namespace mortise::cad {
namespace {

constexpr double kDeflection = 5e-4;     // of the diagonal
constexpr double kAngle = 0.5;           // rad, between neighbouring triangles
constexpr double kMinDeflection = 2e-5;  // m
constexpr double kSameSize = 1e-9;       // m; boxes of curved faces are no more exact
constexpr double kSameVolume = 1e-6;     // relative
const Eigen::Vector3d kTrial(1.25, 1, 1.5);

TopoDS_Shape MovedBy(const TopoDS_Shape& shape, const Eigen::Matrix3d& turn,
                     const Eigen::Vector3d& translation) {
  gp_Trsf motion;
  motion.SetValues(turn(0, 0), turn(0, 1), turn(0, 2), translation[0], turn(1, 0), turn(1, 1),
                   turn(1, 2), translation[1], turn(2, 0), turn(2, 1), turn(2, 2), translation[2]);
  return BRepBuilderAPI_Transform(shape, motion, Standard_True).Shape();
}

bool IsFlat(const TopoDS_Shape& solid) {
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    if (BRepAdaptor_Surface(TopoDS::Face(face.Current()), Standard_False).GetType() !=
        GeomAbs_Plane) {
      return false;
    }
  }
  return true;
}

Solid Named(const TopoDS_Shape& shape, const std::string& name) {
  auto kernel = std::make_shared<Solid::Kernel>();
  kernel->name = name;
  kernel->shape = shape;
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) {
    kernel->faces.push_back(TopoDS::Face(faces(i)));
    kernel->face_names.push_back(absl::StrCat("face", i));
  }
  return Solid(std::move(kernel));
}

std::string BytesOf(const TopoDS_Shape& shape) {
  std::ostringstream stream;
  BinTools::Write(shape, stream, Standard_False, Standard_False, BinTools_FormatVersion_CURRENT);
  return stream.str();
}

TopoDS_Shape ShapeFrom(const std::string& bytes) {
  std::istringstream stream(bytes);
  TopoDS_Shape shape;
  BinTools::Read(shape, stream);
  return shape;
}

bool HasPlainSurfaces(const TopoDS_Shape& solid) {
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    const GeomAbs_SurfaceType type =
        BRepAdaptor_Surface(TopoDS::Face(face.Current()), Standard_False).GetType();
    if (type > GeomAbs_Torus && type != GeomAbs_SurfaceOfExtrusion) return false;
  }
  return true;
}

bool HasOffsetSurfaces(const TopoDS_Shape& solid) {
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    if (BRepAdaptor_Surface(TopoDS::Face(face.Current()), Standard_False).GetType() ==
        GeomAbs_OffsetSurface) {
      return true;
    }
  }
  return false;
}

TopoDS_Shape Scaled(const TopoDS_Shape& shape, double factor) {
  gp_Trsf scale;
  scale.SetScale(gp_Pnt(), factor);
  return BRepBuilderAPI_Transform(shape, scale, Standard_True).Shape();
}

// Offset surfaces, which have no exact form once they are stretched, as splines; the solid itself
// if that changes it. In millimetres, for which the kernel's tolerances are made.
TopoDS_Shape WithoutOffsetSurfaces(const TopoDS_Shape& solid, double volume) {
  if (!HasOffsetSurfaces(solid)) return solid;
  const TopoDS_Shape splines =
      Scaled(ShapeCustom::ConvertToBSpline(Scaled(solid, 1000), Standard_False, Standard_False,
                                           Standard_True, Standard_False),
             1e-3);
  const bool is_same = BRepCheck_Analyzer(splines).IsValid() &&
                       std::abs(AccurateVolume(splines) - volume) <= kSameVolume * volume;
  return is_same ? splines : solid;
}

// What is kept with a shape: of plain surfaces as the kernel's own integration has it, where that
// is right. So were the shapes measured that are stored, and drawings of them still give them.
double KeptVolume(const TopoDS_Shape& solid, double volume) {
  if (!HasPlainSurfaces(solid)) return volume;
  GProp_GProps properties;
  BRepGProp::VolumeProperties(solid, properties);
  const double plain = std::abs(properties.Mass());
  return std::abs(plain - volume) <= kSameVolume * volume ? plain : volume;
}

absl::StatusOr<mesh::DrawnShape> DrawShapeOf(const Solid& solid, const Eigen::Matrix3d& rotation,
                                             const Eigen::Vector3d& minimum,
                                             const Eigen::Vector3d& maximum) {
  TopoDS_Shape shape = MovedBy(solid.kernel().shape, rotation, -minimum);
  const double volume = AccurateVolume(shape);
  if (volume < 0) shape.Reverse();
  shape = WithoutOffsetSurfaces(shape, std::abs(volume));
  if (!BRepCheck_Analyzer(shape).IsValid()) {
    return InvalidField("shape", "is no valid solid: faces that do not meet, or cross each other");
  }
  const Solid turned = Named(shape, solid.name());
  SurfaceOptions options;
  options.relative_deflection = 0;
  options.angle = kAngle;
  options.deflection = std::max(kMinDeflection, kDeflection * (maximum - minimum).norm());
  absl::StatusOr<mesh::AssemblySurface> surface = SurfaceOf(turned, options);
  if (!surface.ok()) return InvalidField("shape", std::string(surface.status().message()));
  MORTISE_ASSIGN_OR_RETURN(
      mesh::DrawnShape drawn,
      mesh::MakeDrawnShape({surface->vertices, surface->triangles}, surface->triangle_face,
                           turned.face_names(), Eigen::Vector3d::Zero(), maximum - minimum));
  drawn.volume = KeptVolume(shape, std::abs(volume));
  drawn.deflection = IsFlat(shape) ? 0 : options.deflection;
  drawn.brep = BytesOf(shape);
  // A solid that the kernel keeps but cannot stretch would be a surprise later.
  MORTISE_RETURN_IF_ERROR(
      SolidOfShape(drawn, kTrial.cwiseProduct(drawn.size), solid.name()).status());
  return drawn;
}

absl::StatusOr<Solid> Faceted(const mesh::DrawnShape& shape, const mesh::BoxStretch& stretch,
                              const std::string& name) {
  mesh::SurfaceMesh surface = mesh::SurfaceIn(shape, stretch);
  surface.vertices.colwise() += stretch.size / 2;
  std::vector<std::string> names;
  for (const std::vector<std::string>& all : shape.face_names) names.push_back(all.front());
  return FacetedSolid(surface, shape.triangle_face, names, name);
}

// As drawn, with the lower corner of its box at the origin.
TopoDS_Shape AsDrawn(const mesh::DrawnShape& shape) {
  const TopoDS_Shape solid = ShapeFrom(shape.brep);
  if (shape.turn.isIdentity(0)) return solid;
  // The box as it was before it was turned reached from the origin to this corner.
  const Eigen::Vector3d corner = shape.turn * (shape.turn.transpose() * shape.size).cwiseAbs();
  return MovedBy(solid, shape.turn, -corner.cwiseMin(0));
}

bool IsAsDrawn(const mesh::DrawnShape& shape, const mesh::BoxStretch& stretch) {
  if ((stretch.size - shape.size).cwiseAbs().maxCoeff() > kSameSize) return false;
  for (int axis = 0; axis < 3; ++axis) {
    for (const mesh::LevelPlace& level : stretch.levels[static_cast<std::size_t>(axis)]) {
      if (std::abs(level.place - level.fraction * shape.size[axis]) > kSameSize) return false;
    }
  }
  return true;
}

absl::StatusOr<Solid> InBox(const mesh::DrawnShape& shape, const mesh::BoxStretch& stretch,
                            const std::string& name) {
  const TopoDS_Shape drawn = AsDrawn(shape);
  if (IsAsDrawn(shape, stretch)) return Named(drawn, name);
  const StretchMap map(shape.size, stretch);
  const double volume = mesh::VolumeIn(shape, stretch);
  const TopoDS_Shape stretched = StretchSolid(drawn, map, volume);
  if (stretched.IsNull()) return InvalidField("shape", WhyNotStretched(drawn, map));
  auto kernel = std::make_shared<Solid::Kernel>(Named(stretched, name).kernel());
  kernel->stretched_from = {drawn, map, volume};
  return Solid(std::move(kernel));
}

}  // namespace

absl::StatusOr<mesh::DrawnShape> ShapeOfSolid(const Solid& solid, const Eigen::Matrix3d& rotation,
                                              const Eigen::Vector3d& minimum,
                                              const Eigen::Vector3d& maximum) {
  try {
    return DrawShapeOf(solid, rotation, minimum, maximum);
  } catch (const Standard_Failure& failure) {
    return InvalidField("shape",
                        absl::StrCat("the kernel cannot take it: ", failure.GetMessageString()));
  }
}

absl::StatusOr<Solid> SolidOfShape(const mesh::DrawnShape& shape, const mesh::BoxStretch& stretch,
                                   const std::string& name) {
  if (!shape.is_solid) {
    return InvalidField("shape", "is only a surface, as its mesh is not the boundary of one solid");
  }
  if (shape.brep.empty()) return Faceted(shape, stretch, name);
  try {
    return InBox(shape, stretch, name);
  } catch (const Standard_Failure& failure) {
    return InvalidField("shape", absl::StrCat("cannot be made: ", failure.GetMessageString()));
  }
}

absl::StatusOr<mesh::DrawnShape> ShapeDrawnTurned(const mesh::DrawnShape& shape) {
  mesh::DrawnShape drawn = shape;
  drawn.name.clear();
  drawn.turn.setIdentity();
  if (shape.brep.empty() || shape.turn.isIdentity(0)) return drawn;
  try {
    drawn.brep = BytesOf(AsDrawn(shape));
    return drawn;
  } catch (const Standard_Failure& failure) {
    return InvalidField("shape", absl::StrCat("cannot be turned: ", failure.GetMessageString()));
  }
}

Solid MovedSolid(const Solid& solid, const Eigen::Vector3d& translation) {
  gp_Trsf motion;
  motion.SetTranslation(gp_Vec(translation.x(), translation.y(), translation.z()));
  const TopLoc_Location there(motion);
  auto moved = std::make_shared<Solid::Kernel>(solid.kernel());
  moved->shape = moved->shape.Moved(there);
  moved->stretched_from.reset();
  for (TopoDS_Face& face : moved->faces) face = TopoDS::Face(face.Moved(there));
  return Solid(std::move(moved));
}

}  // namespace mortise::cad
