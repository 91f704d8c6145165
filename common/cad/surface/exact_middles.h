// Finds where the middles of a surface's triangle sides are on the faces they were drawn for.
// Private to this folder: it brings Open CASCADE.
#pragma once

#include <BRepAdaptor_Surface.hxx>
#include <Eigen/Core>
#include <TopoDS_Face.hxx>
#include <gp_XY.hxx>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/mesh/surface_mesh.h"

namespace mortise::cad {

// Finds for each side of a triangle the point nearest to its middle that is on all faces that have
// the side: on a face, or where faces meet. Where these run into each other without a corner, it is
// on both, but not always on the edge between them.
class ExactMiddles {
 public:
  // Notes the triangles of a face. `points` has the index of the surface's vertex for each node of
  // its triangulation, from 1.
  void Add(const TopoDS_Face& face, const std::vector<int>& points);

  // Returns the places of a surface whose faces were added in order and whose vertices are on them;
  // nothing for a surface without curved faces. The middle of a side for which no point is found is
  // halfway between its ends.
  std::optional<mesh::ExactPlaces> Find(const mesh::AssemblySurface& surface) const;

 private:
  using Side = std::pair<int, int>;  // vertices, the lower first

  static Side SideOf(const mesh::AssemblySurface& surface, Eigen::Index triangle, int side);
  bool IsPlane(int face) const;
  Eigen::Vector3d MiddleOf(const Side& side, const Eigen::Matrix3Xd& vertices) const;
  std::map<Side, Eigen::Vector3d> MiddlesOffHalfway(const mesh::AssemblySurface& surface) const;

  std::vector<BRepAdaptor_Surface> surfaces_;  // of each face
  // For each side, and each face that has it, the parameters of the face about where the side's
  // middle is.
  std::map<Side, std::map<int, gp_XY>> places_;
};

}  // namespace mortise::cad
