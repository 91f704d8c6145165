// Solids that are images of a block of cells, as tetrahedra and as surfaces with control points and
// paths, for tests and benches of mappings: the same solid in other cells is another triangulation
// of it, and what corresponds has the same coordinates in the block.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "services/interpolator/mapping/mesh_mapper.h"

namespace mortise::interpolator {

// Where a point of the block, each coordinate in [0, 1], goes; right-handed.
using BlockImage = std::function<Eigen::Vector3d(const Eigen::Vector3d& block)>;

struct BlockShape {
  BlockImage image;
  // Along the first coordinate: where vertices of the CAD model are. From 0 to 1.
  std::vector<double> knots = {0, 1};
  bool is_ring = false;  // whether the first coordinate comes round
  // At second coordinate 0 and 1: whether edges run along the third at knots.
  std::array<bool, 2> has_lines = {true, true};
};

struct BlockCells {
  int along = 4;  // between knots
  int across = 4;
  int high = 4;
  bool is_mirrored = false;  // the other diagonals
  double unrest = 0;         // of a cell: how far nodes are moved off the grid within the faces
};

// A mesh with control points and paths on its surface, by nodes that are corners of elements.
struct MarkedMesh {
  mesh::TetrahedralMesh mesh;
  std::vector<ControlPoint> points;  // `vertex` is a node
  std::vector<ControlPath> paths;    // nodes
};

struct BlockMesh {
  MarkedMesh marked_mesh;
  Eigen::Matrix3Xd block;  // 3 × nodes
  MarkedSurface marked;    // its surface
  std::vector<int> node;   // of each vertex of the surface
  double cell_size = 0;    // m, the longest edge
};

BlockMesh MakeBlockMesh(const BlockShape& shape, const BlockCells& cells);

// The mesh with its control variables by their places, as models have them.
ModelMesh ModelOf(const BlockMesh& block);

// A box from the origin.
BlockShape BoxShape(const Eigen::Vector3d& size);

// A box bent about an axis along y by `turn`, rad: an arch of mean radius `radius`.
BlockShape ArchShape(double radius, double turn, double width, double thickness);

// A rectangular plate with a round hole about its middle; corners at knots 0, ¼, ½, ¾.
BlockShape PlateShape(double length, double width, double thickness, double hole);

// A solid cylinder about z, whose circles have four points each.
BlockShape CylinderShape(double radius, double height);

// Two legs at a right angle with rounded bends between them: `fillet` within.
BlockShape BracketShape(double leg, double thickness, double fillet, double depth);

}  // namespace mortise::interpolator
