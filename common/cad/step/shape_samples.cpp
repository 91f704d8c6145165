#include "common/cad/step/shape_samples.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepExtrema_ExtPC.hxx>
#include <BRepExtrema_ExtPF.hxx>
#include <BRep_Tool.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <gp_Pnt2d.hxx>
#include <iterator>

namespace mortise::cad {
namespace {

// Of a stretch. What is regular has zeros, ends and middles at halves, quarters and thirds, at
// which also curves that differ may meet.
constexpr double kShares[] = {0.1423, 0.4157, 0.7891};
constexpr std::size_t kShareCount = std::size(kShares);
constexpr int kMaxPieces = 32;  // of a stretch of a face of which no point is found

// The values at the shares of each of the pieces that each stretch is cut into.
std::vector<double> ValuesIn(const TColStd_Array1OfReal& stretches, int pieces) {
  std::vector<double> values;
  for (int i = stretches.Lower(); i < stretches.Upper(); ++i) {
    const double piece = (stretches(i + 1) - stretches(i)) / pieces;
    for (int k = 0; k < pieces; ++k) {
      for (const double share : kShares) values.push_back(stretches(i) + (k + share) * piece);
    }
  }
  return values;
}

std::vector<gp_Pnt> PointsInside(const TopoDS_Face& face, const BRepAdaptor_Surface& surface,
                                 const std::vector<double>& along_u,
                                 const std::vector<double>& along_v) {
  std::vector<gp_Pnt> points;
  BRepClass_FaceClassifier classifier;
  for (const double u : along_u) {
    for (const double v : along_v) {
      classifier.Perform(face, gp_Pnt2d(u, v), BRep_Tool::Tolerance(face));
      if (classifier.State() == TopAbs_IN) points.push_back(surface.Value(u, v));
    }
  }
  return points;
}

// Whether a foot of the perpendiculars that were last dropped is so near.
template <class PerpendicularFeet>
bool HasFootWithin(double tolerance, const PerpendicularFeet& feet) {
  if (!feet.IsDone()) return false;
  for (int i = 1; i <= feet.NbExt(); ++i) {
    if (feet.SquareDistance(i) <= tolerance * tolerance) return true;
  }
  return false;
}

}  // namespace

std::optional<std::vector<gp_Pnt>> PointsWithin(const TopoDS_Edge& edge, std::size_t most) {
  std::vector<gp_Pnt> points;
  const BRepAdaptor_Curve curve(edge);
  if (curve.GetType() == GeomAbs_Line) return points;
  const int count = curve.NbIntervals(GeomAbs_CN);
  if (static_cast<std::size_t>(count) * kShareCount > most) return std::nullopt;
  TColStd_Array1OfReal stretches(1, count + 1);
  curve.Intervals(stretches, GeomAbs_CN);
  for (const double at : ValuesIn(stretches, 1)) points.push_back(curve.Value(at));
  return points;
}

std::optional<std::vector<gp_Pnt>> PointsWithin(const TopoDS_Face& face, std::size_t most) {
  const BRepAdaptor_Surface surface(face);
  if (surface.GetType() == GeomAbs_Plane) return std::vector<gp_Pnt>();
  const int count_u = surface.NbUIntervals(GeomAbs_CN), count_v = surface.NbVIntervals(GeomAbs_CN);
  if (static_cast<std::size_t>(count_u) * static_cast<std::size_t>(count_v) * kShareCount *
          kShareCount >
      most) {
    return std::nullopt;
  }
  TColStd_Array1OfReal u(1, count_u + 1), v(1, count_v + 1);
  surface.UIntervals(u, GeomAbs_CN);
  surface.VIntervals(v, GeomAbs_CN);
  // Of a narrow face most of the rectangle round it is outside.
  for (int pieces = 1; pieces <= kMaxPieces; pieces *= 2) {
    std::vector<gp_Pnt> points =
        PointsInside(face, surface, ValuesIn(u, pieces), ValuesIn(v, pieces));
    if (!points.empty()) return points;
  }
  return std::nullopt;
}

bool LieOn(const std::vector<gp_Pnt>& points, const TopoDS_Edge& edge, double tolerance) {
  if (points.empty()) return true;
  BRepExtrema_ExtPC feet;
  feet.Initialize(edge);
  return std::all_of(points.begin(), points.end(), [&](const gp_Pnt& point) {
    feet.Perform(BRepBuilderAPI_MakeVertex(point).Vertex());
    return HasFootWithin(tolerance, feet);
  });
}

bool LieOn(const std::vector<gp_Pnt>& points, const TopoDS_Face& face, double tolerance) {
  if (points.empty()) return true;
  BRepExtrema_ExtPF feet;
  feet.Initialize(face, Extrema_ExtFlag_MIN);
  return std::all_of(points.begin(), points.end(), [&](const gp_Pnt& point) {
    feet.Perform(BRepBuilderAPI_MakeVertex(point).Vertex(), face);
    return HasFootWithin(tolerance, feet);
  });
}

}  // namespace mortise::cad
