#include "common/cad/surface/part_gaps.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <Precision.hxx>
#include <algorithm>
#include <numeric>

namespace mortise::cad {
namespace {

constexpr double kFacing = 0.3;  // least cosine between a face's normal and the way to the other

// The outward normal of a face next to a point; the null vector where there is none.
gp_Vec NormalNear(const TopoDS_Face& face, const gp_Pnt& place) {
  const GeomAPI_ProjectPointOnSurf foot(place, BRep_Tool::Surface(face));
  if (foot.NbPoints() == 0) return {};
  double u = 0, v = 0;
  foot.LowerDistanceParameters(u, v);
  gp_Pnt point;
  gp_Vec along_u, along_v;
  BRepAdaptor_Surface(face, Standard_False).D1(u, v, point, along_u, along_v);
  gp_Vec normal = along_u.Crossed(along_v);
  if (normal.Magnitude() < Precision::Confusion() * Precision::Confusion()) return {};
  normal.Normalize();
  return face.Orientation() == TopAbs_REVERSED ? -normal : normal;
}

// How two faces look at each other across the narrowest place between them: the cosines between
// the way across and the normals, the second one's turned round.
struct Sight {
  double first = 0;
  double second = 0;
};

Sight SightOf(const TopoDS_Face& first, const TopoDS_Face& second,
              const BRepExtrema_DistShapeShape& distance) {
  Sight best{-1, -1};
  for (int i = 1; i <= distance.NbSolution(); ++i) {
    const gp_Pnt from = distance.PointOnShape1(i), to = distance.PointOnShape2(i);
    gp_Vec across(from, to);
    if (across.Magnitude() < gp::Resolution()) continue;
    across.Normalize();
    const Sight sight{NormalNear(first, from).Dot(across), -NormalNear(second, to).Dot(across)};
    if (std::min(sight.first, sight.second) > std::min(best.first, best.second)) best = sight;
  }
  return best;
}

}  // namespace

std::vector<FaceGap> FindGaps(const SolidFusion& fusion, double reach,
                              const std::vector<double>& misses) {
  struct Outside {
    int face = 0;
    Bnd_Box box;
    double low = 0, high = 0;  // m, along x
  };
  std::vector<Outside> outside;
  const std::vector<FusedFace>& faces = fusion.faces();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i].description.front_part >= 0) continue;
    Outside entry{static_cast<int>(i), {}};
    BRepBndLib::Add(faces[i].face, entry.box, Standard_False);
    if (entry.box.IsVoid()) continue;
    double y = 0, z = 0, far_y = 0, far_z = 0;
    entry.box.Get(entry.low, y, z, entry.high, far_y, far_z);
    outside.push_back(entry);
  }
  std::sort(outside.begin(), outside.end(),
            [](const Outside& a, const Outside& b) { return a.low < b.low; });
  const double most = misses.empty() ? 0 : *std::max_element(misses.begin(), misses.end());
  std::vector<FaceGap> gaps;
  for (std::size_t i = 0; i < outside.size(); ++i) {
    const auto a = static_cast<std::size_t>(outside[i].face);
    for (std::size_t j = i + 1;
         j < outside.size() && outside[j].low <= outside[i].high + reach + misses[a] + most; ++j) {
      const auto b = static_cast<std::size_t>(outside[j].face);
      const int part = faces[a].description.back_part, other = faces[b].description.back_part;
      const double near = reach + misses[a] + misses[b];
      if (part == other || outside[i].box.Distance(outside[j].box) > near ||
          fusion.Touch(outside[i].face, outside[j].face)) {
        continue;
      }
      const BRepExtrema_DistShapeShape distance(faces[a].face, faces[b].face);
      if (!distance.IsDone() || distance.Value() > near) continue;
      FaceGap gap{outside[i].face, outside[j].face, distance.Value(), true};
      if (fusion.Meet(part, other)) {
        const Sight sight = SightOf(faces[a].face, faces[b].face, distance);
        gap.is_between = std::min(sight.first, sight.second) >= kFacing;
        if (std::max(sight.first, sight.second) < kFacing ||
            std::min(sight.first, sight.second) < -kFacing) {
          continue;
        }
      }
      gaps.push_back(gap);
    }
  }
  return gaps;
}

}  // namespace mortise::cad
