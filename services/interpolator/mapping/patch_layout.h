// Divides two surfaces into corresponding patches, each a disk (thesis §6.6.2, common patch layout;
// Kraevoy and Sheffer, Cross-parameterization and compatible remeshing of 3D models, 2004).
//
// Nodes are the control points that both surfaces have, and the first paths those that both have.
// Paths that would lie in another cyclic order around a point are left out. Further paths are then
// added in pairs, always the pair with the least sum of lengths,
//  1. between pieces of the boundary of a patch, until there is one: the graph is connected, and
//     every patch of genus 0 a disk;
//  2. across large patches, where the way along the patch's boundary is much longer.
// Added paths run through a patch from a corner to a corner, so that they meet nothing, lie in the
// same cyclic order at both ends, and close off the same points: paths of the first kind separate
// nothing, those of the second a disk without points in it.
//
// All paths are edges of finer surfaces of the same shape, whose first vertices are those given,
// and have corresponding vertices: as many, at the same shares of their lengths.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"
#include "services/interpolator/mapping/marked_surface.h"

namespace mortise::interpolator {

struct LayoutOptions {
  // Patches of more than this share of the surface's area are divided,
  double large_patch = 0.02;
  // where a path is shorter than this share of the way along the boundary between its ends.
  double shortcut = 0.45;
};

// One surface, divided.
struct LaidSurface {
  struct Patch {
    std::vector<int> triangles;  // of `surface`
    // The same triangles as a disk with vertices of its own, and its boundary, counter-clockwise
    // from the start of the first path of the patch's walk.
    std::vector<int> vertices;  // of `surface`, for each vertex of the disk
    Eigen::Matrix3Xi disk;      // 3 × triangles
    std::vector<int> boundary;  // vertices of the disk
  };
  mesh::SurfaceMesh surface;
  std::vector<int> origin;              // of each triangle: the one given that it is a piece of
  std::vector<std::vector<int>> paths;  // vertices of each path
  std::vector<Patch> patches;
};

struct PatchLayout {
  struct Path {
    int from = -1, to = -1;  // points
    std::string name;        // of the edge it was given as; empty of those added
  };
  std::vector<std::string> points;
  std::vector<Path> paths;
  // The paths around each patch, which is on their left: 2p for path p, 2p + 1 for it backwards.
  std::vector<std::vector<int>> walks;
  LaidSurface source, target;
};

// Fails with INVALID_ARGUMENT naming "source" or "target" (CheckMarkedSurface);
// FAILED_PRECONDITION, reasons TOPOLOGY_DIFFERS and TOO_FEW_POINTS (FindCorrespondence);
// TOPOLOGY_DIFFERS also where the paths that both have enclose different points or handles;
// PATCH_NOT_SIMPLE, if a patch has a handle that no path given leads around.
absl::StatusOr<PatchLayout> BuildPatchLayout(const MarkedSurface& source,
                                             const MarkedSurface& target,
                                             const LayoutOptions& options = {});

}  // namespace mortise::interpolator
