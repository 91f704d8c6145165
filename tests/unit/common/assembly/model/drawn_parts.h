// Parts drawn by the CAD kernel, for tests of how shapes are parametrised.
#pragma once

#include <gtest/gtest.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <Bnd_Box.hxx>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/cad/stretch/solid_shape.h"
#include "tests/unit/common/assembly/model/assemblies.h"
#include "tests/unit/common/cad/stretch/oblong.h"
#include "tests/unit/common/cad/surface/fused_parts.h"

namespace mortise::parametric {

// A part that fills the box around a solid, as exactly as the kernel says.
inline AssemblyPart Drawn(const std::string& name, const TopoDS_Shape& shape) {
  Bnd_Box around;
  BRepBndLib::AddOptimal(shape, around, false, false);
  around.SetGap(0);
  const gp_Pnt low = around.CornerMin(), high = around.CornerMax();
  // As drawings have it, to the nanometre.
  const auto exact = [](double length) { return std::round(1e9 * length) / 1e9; };
  const Eigen::Vector3d minimum(exact(low.X()), exact(low.Y()), exact(low.Z()));
  const Eigen::Vector3d maximum(exact(high.X()), exact(high.Y()), exact(high.Z()));
  AssemblyPart part = ResizablePart(name, minimum, maximum);
  part.item = "items/" + name;
  auto drawn =
      cad::ShapeOfSolid(cad::Named(shape, name), Eigen::Matrix3d::Identity(), minimum, maximum);
  EXPECT_TRUE(drawn.ok()) << drawn.status();
  if (drawn.ok()) part.shape = std::make_shared<const mesh::DrawnShape>(*std::move(drawn));
  return part;
}

inline AssemblyPart Boxed(const std::string& name, const Eigen::Vector3d& minimum,
                          const Eigen::Vector3d& size) {
  AssemblyPart part = ResizablePart(name, minimum, minimum + size);
  part.item = "items/" + name;
  return part;
}

inline TopoDS_Shape RodAlong(const gp_Dir& direction, const gp_Pnt& from, double radius,
                             double length) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(from, direction), radius, length).Solid();
}

inline TopoDS_Shape Less(const TopoDS_Shape& solid, const TopoDS_Shape& tool) {
  return BRepAlgoAPI_Cut(solid, tool).Shape();
}

inline TopoDS_Shape Plate(const std::vector<std::pair<double, double>>& corners, double thickness) {
  BRepBuilderAPI_MakePolygon outline;
  for (const auto& [x, y] : corners) outline.Add(gp_Pnt(x, y, 0));
  outline.Close();
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()).Face(),
                               gp_Vec(0, 0, thickness))
      .Shape();
}

}  // namespace mortise::parametric
