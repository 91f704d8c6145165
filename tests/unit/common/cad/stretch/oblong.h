// Solids with straight sides and round ends, as slots are milled.
#pragma once

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <GC_MakeArcOfCircle.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>

namespace mortise::cad {

// Upright, with straight sides and round ends about two points.
inline TopoDS_Shape Oblong(const gp_Pnt& from, const gp_Pnt& to, double radius, double height) {
  gp_Vec aside = gp_Vec(from, to).Crossed(gp_Vec(0, 0, 1)).Normalized() * radius;
  const gp_Vec beyond = gp_Vec(from, to).Normalized() * radius;
  const gp_Pnt a = from.Translated(aside), b = to.Translated(aside);
  const gp_Pnt c = to.Translated(-aside), d = from.Translated(-aside);
  const auto arc = [](const gp_Pnt& begin, const gp_Pnt& over, const gp_Pnt& end) {
    return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(begin, over, end).Value()).Edge();
  };
  BRepBuilderAPI_MakeWire outline(
      BRepBuilderAPI_MakeEdge(a, b).Edge(), arc(b, to.Translated(beyond), c),
      BRepBuilderAPI_MakeEdge(c, d).Edge(), arc(d, from.Translated(-beyond), a));
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Vec(0, 0, height))
      .Shape();
}

}  // namespace mortise::cad
