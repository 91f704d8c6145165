#include "common/cad/step_measure.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Trsf.hxx>

#include "common/cad/solid_kernel.h"
#include "common/cad/step_document.h"

namespace mortise::cad {
namespace {

// Share of the box's volume that a box may miss by.
constexpr double kBoxTolerance = 1e-6;
// Boxes of curved faces are too large by the kernel's tolerance, 1e-7 of whatever unit the solid is
// in: 0.1 µm at each side in metres. That would stretch each part that is to have its exact size.
constexpr double kEnlargement = 1e4;

bool IsPolyhedron(const TopoDS_Shape& solid) {
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    if (BRepAdaptor_Surface(TopoDS::Face(face.Current()), Standard_False).GetType() !=
        GeomAbs_Plane) {
      return false;
    }
  }
  for (TopExp_Explorer edge(solid, TopAbs_EDGE); edge.More(); edge.Next()) {
    if (BRepAdaptor_Curve(TopoDS::Edge(edge.Current())).GetType() != GeomAbs_Line) return false;
  }
  return true;
}

TopoDS_Shape Enlarged(const TopoDS_Shape& solid) {
  gp_Trsf scale;
  scale.SetScale(gp_Pnt(0, 0, 0), kEnlargement);
  return BRepBuilderAPI_Transform(solid, scale, Standard_True).Shape();
}

Eigen::Matrix3Xd VerticesOf(const TopoDS_Shape& solid) {
  TopTools_IndexedMapOfShape found;
  TopExp::MapShapes(solid, TopAbs_VERTEX, found);
  Eigen::Matrix3Xd vertices(3, found.Extent());
  for (int i = 0; i < found.Extent(); ++i) {
    const gp_Pnt point = BRep_Tool::Pnt(TopoDS::Vertex(found(i + 1)));
    vertices.col(i) = Eigen::Vector3d(point.X(), point.Y(), point.Z());
  }
  return vertices;
}

}  // namespace

SolidMeasurer::SolidMeasurer(const TopoDS_Shape& solid)
    : solid_(solid), is_polyhedron_(IsPolyhedron(solid)) {
  volume_ = std::abs(AccurateVolume(solid));
  if (is_polyhedron_) vertices_ = VerticesOf(solid);
  if (vertices_.cols() == 0) is_polyhedron_ = false;
}

const SolidMeasurer::Turned& SolidMeasurer::BoxOf(const Eigen::Matrix3d& rotation) {
  for (const Turned& turned : turned_) {
    if (turned.rotation == rotation) return turned;
  }
  Turned turned{rotation, {}, {}};
  if (is_polyhedron_) {
    const Eigen::Matrix3Xd placed = rotation * vertices_;
    turned.minimum = placed.rowwise().minCoeff();
    turned.maximum = placed.rowwise().maxCoeff();
  } else {
    Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
    turn.linear() = rotation;
    Bnd_Box box;
    BRepBndLib::AddOptimal(Enlarged(solid_).Moved(ToLocation(turn)), box, Standard_False,
                           Standard_False);
    box.SetGap(0);
    const gp_Pnt low = box.CornerMin(), high = box.CornerMax();
    turned.minimum = Eigen::Vector3d(low.X(), low.Y(), low.Z()) / kEnlargement;
    turned.maximum = Eigen::Vector3d(high.X(), high.Y(), high.Z()) / kEnlargement;
  }
  turned_.push_back(turned);
  return turned_.back();
}

void SolidMeasurer::Measure(const Eigen::Isometry3d& placement, StepPart& part) {
  const Turned& turned = BoxOf(placement.linear());
  part.volume = volume_;
  part.minimum = turned.minimum + placement.translation();
  part.maximum = turned.maximum + placement.translation();
  const double filled = (turned.maximum - turned.minimum).prod();
  part.is_box = std::abs(volume_ - filled) <= kBoxTolerance * filled;
}

}  // namespace mortise::cad
