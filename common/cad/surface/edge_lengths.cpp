#include "common/cad/surface/edge_lengths.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepLProp_SLProps.hxx>
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace mortise::cad {
namespace {

constexpr double kTurn = 0.5;         // rad, between triangles
constexpr double kMaxTurn = 1;        // rad
constexpr double kSmall = 0.25;       // of the size of elements: needed by roundness alone
constexpr double kLeftOut = 0.05;     // of a face's area: the tip of a cone has no radius
constexpr double kResolution = 1e-9;  // m, below which a derivative is none
constexpr double kFlat = 1e-6;        // 1/m

double LeastRadius(const TopoDS_Face& face) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const BRepAdaptor_Surface surface(face, Standard_False);
  if (surface.GetType() == GeomAbs_Plane) return kInfinite;
  TopLoc_Location location;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
  if (mesh.IsNull() || !mesh->HasUVNodes()) return kInfinite;
  std::vector<std::pair<double, double>> curvatures;  // 1/m, with the area, m²
  double whole = 0;
  for (int t = 1; t <= mesh->NbTriangles(); ++t) {
    std::array<int, 3> nodes{};
    mesh->Triangle(t).Get(nodes[0], nodes[1], nodes[2]);
    gp_XY middle(0, 0);
    for (const int node : nodes) middle += mesh->UVNode(node).XY() / 3;
    const gp_Vec first(mesh->Node(nodes[0]), mesh->Node(nodes[1]));
    const double area =
        first.Crossed(gp_Vec(mesh->Node(nodes[0]), mesh->Node(nodes[2]))).Magnitude();
    BRepLProp_SLProps here(surface, middle.X(), middle.Y(), 2, kResolution);
    if (!here.IsCurvatureDefined()) continue;
    curvatures.emplace_back(std::max(std::abs(here.MaxCurvature()), std::abs(here.MinCurvature())),
                            area);
    whole += area;
  }
  std::sort(curvatures.begin(), curvatures.end(), std::greater<>());
  double passed = 0;
  for (const auto& [curvature, area] : curvatures) {
    passed += area;
    if (passed > kLeftOut * whole) return curvature > kFlat ? 1 / curvature : kInfinite;
  }
  return kInfinite;
}

}  // namespace

std::vector<double> LeastRadii(const std::vector<TopoDS_Face>& faces) {
  std::vector<double> radii;
  for (const TopoDS_Face& face : faces) radii.push_back(LeastRadius(face));
  return radii;
}

double EdgeLength(double radius, double element_size) {
  const double small = kSmall * element_size;
  if (radius * kTurn >= small) return std::min(radius * kTurn, element_size);
  return std::min(radius * kMaxTurn, small);
}

}  // namespace mortise::cad
