#include "common/fem/linear/multigrid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/fem/linear/aggregation.h"
#include "common/fem/linear/block_rows.h"
#include "common/fem/linear/multigrid_level.h"
#include "common/mesh/element_faces.h"

namespace mortise::simulator {
namespace {

// `block` without the rows and columns of prescribed displacements.
Eigen::Matrix3d Masked(const Eigen::Matrix3d& block, const Eigen::Array3Xi& fixed, int i, int j) {
  Eigen::Matrix3d masked = block;
  for (int a = 0; a < 3; ++a) {
    if (fixed(a, i)) masked.row(a).setZero();
    if (fixed(a, j)) masked.col(a).setZero();
  }
  return masked;
}

// Calls visit(j, block) for all blocks of row i, by ascending j.
template <class Visit>
void VisitRow(const BlockMatrix& matrix, int i, const Visit& visit) {
  const BlockPattern& pattern = *matrix.pattern();
  for (int k = pattern.starts()[i]; k < pattern.starts()[i + 1]; ++k) {
    visit(pattern.rows()[k], Eigen::Matrix3d(matrix.blocks()[k].transpose()));
  }
  for (int k = pattern.row_starts()[i]; k < pattern.row_starts()[i + 1]; ++k) {
    visit(pattern.row_columns()[k], matrix.blocks()[pattern.row_slots()[k]]);
  }
}

// Both triangles by rows; prescribed displacements are coupled to nothing.
template <class T>
BlockRows<T, 3, 3> FullRows(const BlockMatrix& matrix, const Eigen::Array3Xi& fixed,
                            ThreadTeam& team) {
  const BlockPattern& pattern = *matrix.pattern();
  BlockRows<T, 3, 3> rows;
  rows.starts.resize(pattern.nodes() + 1);
  for (int i = 0; i < pattern.nodes(); ++i) {
    rows.starts[i + 1] = rows.starts[i] + pattern.starts()[i + 1] - pattern.starts()[i] +
                         pattern.row_starts()[i + 1] - pattern.row_starts()[i];
  }
  rows.columns.resize(rows.starts.back());
  rows.blocks.resize(rows.starts.back());
  team.ForRanges(pattern.nodes(), [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      int place = rows.starts[i];
      VisitRow(matrix, i, [&](int j, const Eigen::Matrix3d& block) {
        Eigen::Matrix3d masked = Masked(block, fixed, i, j);
        if (i == j) masked.diagonal() = block.diagonal();
        rows.columns[place] = j;
        rows.blocks[place++] = masked.template cast<T>();
      });
    }
  });
  return rows;
}

// `vector` of node v in space as components along the node's frame, and back.
Eigen::Vector3d ToFrame(const NodeFrames& frames, int v, const Eigen::Vector3d& vector) {
  if (frames.empty() || frames.index[v] < 0) return vector;
  return frames.axes[frames.index[v]].transpose() * vector;
}
Eigen::Vector3d ToSpace(const NodeFrames& frames, int v, const Eigen::Vector3d& vector) {
  if (frames.empty() || frames.index[v] < 0) return vector;
  return frames.axes[frames.index[v]] * vector;
}

// The block of nodes i and j of a matrix, from their frames to those of nodes c and d.
Eigen::Matrix3d Turned(const NodeFrames& frames, const Eigen::Matrix3d& block, int i, int j, int c,
                       int d) {
  if (frames.empty()) return block;
  const auto axes = [&](int v) {
    return frames.index[v] < 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                               : frames.axes[frames.index[v]];
  };
  return axes(c).transpose() * axes(i) * block * axes(j).transpose() * axes(d);
}

// The corners of quadratic elements, numbered by themselves, and what depends on them.
struct CornerMesh {
  std::vector<std::array<int, 2>> parents;  // of each node: corners; both the same at a corner
  std::vector<int> node;                    // of each corner
  std::vector<int> child_starts, children;  // nodes that move with each corner, itself included
  Eigen::Array3Xi fixed;                    // 3 × corners

  double Weight(int child) const { return parents[child][0] == parents[child][1] ? 1 : 0.5; }
};

CornerMesh FindCorners(const mesh::TetrahedralMesh& mesh, const Eigen::Array3Xi& fixed) {
  CornerMesh corners;
  const int nodes = static_cast<int>(mesh.nodes.cols());
  std::vector<int> number(nodes, -1);
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    for (int a = 0; a < 4; ++a) number[mesh.tetrahedra(a, e)] = 0;
  }
  corners.parents.assign(nodes, {-1, -1});
  for (int v = 0; v < nodes; ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(corners.node.size());
    corners.parents[v] = {number[v], number[v]};
    corners.node.push_back(v);
  }
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = mesh::kTetrahedronEdges[k];
      corners.parents[mesh.tetrahedra(4 + k, e)] = {number[mesh.tetrahedra(a, e)],
                                                    number[mesh.tetrahedra(b, e)]};
    }
  }
  const int count = static_cast<int>(corners.node.size());
  corners.fixed.resize(3, count);
  for (int c = 0; c < count; ++c) corners.fixed.col(c) = fixed.col(corners.node[c]);
  corners.child_starts.assign(count + 1, 0);
  const auto visit = [&](const auto& see) {
    for (int v = 0; v < nodes; ++v) {
      const auto [a, b] = corners.parents[v];
      if (a >= 0) see(v, a);
      if (b >= 0 && b != a) see(v, b);
    }
  };
  visit([&](int, int parent) { ++corners.child_starts[parent + 1]; });
  for (int c = 0; c < count; ++c) corners.child_starts[c + 1] += corners.child_starts[c];
  corners.children.resize(corners.child_starts.back());
  std::vector<int> next(corners.child_starts.begin(), corners.child_starts.end() - 1);
  visit([&](int child, int parent) { corners.children[next[parent]++] = child; });
  return corners;
}

// PᵀKP: the stiffness of linear elements on the corners.
BlockRows<double, 3, 3> CornerStiffness(const BlockMatrix& matrix, const Eigen::Array3Xi& fixed,
                                        const NodeFrames& frames, const CornerMesh& corners,
                                        ThreadTeam& team) {
  constexpr int kRange = 256;
  const int count = static_cast<int>(corners.node.size());
  std::vector<BlockRows<double, 3, 3>> parts((count + kRange - 1) / kRange);
  team.Run(static_cast<int>(parts.size()), [&](int range) {
    BlockRows<double, 3, 3>& part = parts[range];
    std::vector<int> place(count, -1), found;
    std::vector<Eigen::Matrix3d> sums;
    for (int c = range * kRange; c < std::min(count, (range + 1) * kRange); ++c) {
      found.clear();
      sums.clear();
      for (int n = corners.child_starts[c]; n < corners.child_starts[c + 1]; ++n) {
        const int i = corners.children[n];
        const double weight = corners.Weight(i);
        VisitRow(matrix, i, [&](int j, const Eigen::Matrix3d& block) {
          const Eigen::Matrix3d share = weight * corners.Weight(j) * Masked(block, fixed, i, j);
          for (int side = 0; side < (corners.Weight(j) == 1 ? 1 : 2); ++side) {
            const int d = corners.parents[j][side];
            if (place[d] < 0) {
              place[d] = static_cast<int>(found.size());
              found.push_back(d);
              sums.push_back(Eigen::Matrix3d::Zero());
            }
            sums[place[d]] += Turned(frames, share, i, j, corners.node[c], corners.node[d]);
          }
        });
      }
      std::sort(found.begin(), found.end());
      for (const int d : found) {
        part.columns.push_back(d);
        part.blocks.push_back(Masked(sums[place[d]], corners.fixed, c, d));
        if (c == d) {
          // Any stiffness will do for displacements that stay zero.
          const double usual = matrix.blocks()[matrix.starts()[corners.node[c] + 1] - 1].trace();
          for (int a = 0; a < 3; ++a) {
            if (corners.fixed(a, c)) part.blocks.back()(a, a) = usual;
          }
        }
        place[d] = -1;
      }
      part.starts.push_back(static_cast<int>(part.columns.size()));
    }
  });
  return Joined(parts);
}

class CornerTransfer : public Transfer {
 public:
  CornerTransfer(const CornerMesh& corners, const Eigen::Array3Xi& fixed, const NodeFrames& frames,
                 ThreadTeam& team)
      : corners_(corners), fixed_(fixed), frames_(frames), team_(team) {}

  void Prolong(const Eigen::VectorXd& coarse, Eigen::VectorXd& x) const override {
    team_.ForRanges(static_cast<int>(corners_.parents.size()), [&](int begin, int end) {
      for (int v = begin; v < end; ++v) {
        const auto [a, b] = corners_.parents[v];
        if (a < 0) continue;
        const Eigen::Vector3d mean =
            ToFrame(frames_, v,
                    0.5 * (ToSpace(frames_, corners_.node[a], coarse.segment<3>(3 * a)) +
                           ToSpace(frames_, corners_.node[b], coarse.segment<3>(3 * b))));
        for (int k = 0; k < 3; ++k) {
          if (!fixed_(k, v)) x[3 * v + k] += mean[k];
        }
      }
    });
  }

  void Restrict(const Eigen::VectorXd& b, Eigen::VectorXd& coarse) const override {
    coarse.resize(corners_.fixed.size());
    team_.ForRanges(static_cast<int>(corners_.node.size()), [&](int begin, int end) {
      for (int c = begin; c < end; ++c) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int n = corners_.child_starts[c]; n < corners_.child_starts[c + 1]; ++n) {
          const int child = corners_.children[n];
          sum += corners_.Weight(child) * ToSpace(frames_, child, b.segment<3>(3 * child));
        }
        sum = ToFrame(frames_, corners_.node[c], sum);
        coarse.segment<3>(3 * c) = (corners_.fixed.col(c) != 0).select(0.0, sum.array());
      }
    });
  }

  double Bytes() const override {
    return 4.0 * (2 * corners_.parents.size() + corners_.children.size());
  }

 private:
  const CornerMesh& corners_;
  const Eigen::Array3Xi& fixed_;
  const NodeFrames& frames_;
  ThreadTeam& team_;
};

// Whether the mesh is of quadratic elements that are mostly far longer than high, as a sheet has
// them in one layer. Linear elements on the same corners hardly bend then: stepping down to them
// hinders more than it helps.
bool IsOfStretchedElements(const mesh::TetrahedralMesh& mesh) {
  constexpr double kStretched = 20;  // longest edge over least height
  constexpr double kShare = 0.1;     // of elements; a mesher leaves a few of these anywhere
  if (!mesh.IsQuadratic()) return false;
  Eigen::Index stretched = 0;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    std::array<Eigen::Vector3d, 4> corner;
    for (int k = 0; k < 4; ++k) corner[k] = mesh.nodes.col(mesh.tetrahedra(k, e));
    double longest = 0, widest = 0;  // edge; twice the area of a face
    for (const auto& [a, b] : mesh::kTetrahedronEdges) {
      longest = std::max(longest, (corner[b] - corner[a]).norm());
    }
    for (const auto& [a, b, c] : mesh::kTetrahedronFaces) {
      widest = std::max(widest, (corner[b] - corner[a]).cross(corner[c] - corner[a]).norm());
    }
    const double volume =  // times six
        (corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(corner[3] - corner[0]);
    stretched += longest * widest > kStretched * std::abs(volume);
  }
  return static_cast<double>(stretched) > kShare * static_cast<double>(mesh.tetrahedra.cols());
}

// Moves along and turns about the axes, scaled to the size of the body, of nodes `node`; zero where
// fixed.
RigidModes<3> MakeRigidModes(const Eigen::Matrix3Xd& positions, const Eigen::Array3Xi& fixed,
                             const NodeFrames& frames, const std::vector<int>& node) {
  const Eigen::Vector3d low = positions.rowwise().minCoeff(), high = positions.rowwise().maxCoeff();
  const double size = std::max(0.5 * (high - low).norm(), 1e-300);
  RigidModes<3> modes(node.size());
  for (std::size_t n = 0; n < node.size(); ++n) {
    const int v = node[n];
    const Eigen::Vector3d p = (positions.col(v) - 0.5 * (low + high)) / size;
    modes[n] << 1, 0, 0, 0, p.z(), -p.y(),  //
        0, 1, 0, -p.z(), 0, p.x(),          //
        0, 0, 1, p.y(), -p.x(), 0;
    for (int c = 0; c < 6; ++c) modes[n].col(c) = ToFrame(frames, v, modes[n].col(c));
    for (int k = 0; k < 3; ++k) {
      if (fixed(k, v)) modes[n].row(k).setZero();
    }
  }
  return modes;
}

}  // namespace

struct Multigrid::Topology {
  Eigen::Array3Xi fixed;
  NodeFrames frames;
  bool quadratic = false;
  CornerMesh corners;      // of quadratic elements
  std::vector<int> nodes;  // of linear ones: all
};

struct Multigrid::Hierarchy {
  std::unique_ptr<Corrector> finest;
};

Multigrid::Multigrid(const mesh::TetrahedralMesh& mesh, const Eigen::Array3Xi& fixed,
                     const NodeFrames& frames, const MultigridOptions& options, ThreadTeam& team)
    : topology_(std::make_unique<Topology>()),
      hierarchy_(std::make_unique<Hierarchy>()),
      options_(options),
      team_(team) {
  topology_->fixed = fixed;
  topology_->frames = frames;
  topology_->quadratic = mesh.IsQuadratic() && options.corners && !IsOfStretchedElements(mesh);
  if (topology_->quadratic) {
    topology_->corners = FindCorners(mesh, fixed);
  } else {
    topology_->nodes.resize(mesh.nodes.cols());
    std::iota(topology_->nodes.begin(), topology_->nodes.end(), 0);
  }
}

Multigrid::~Multigrid() = default;

absl::Status Multigrid::Prepare(const BlockMatrix& stiffness, const Eigen::Matrix3Xd& positions) {
  hierarchy_->finest = nullptr;
  const Eigen::Array3Xi& fixed = topology_->fixed;
  const NodeFrames& frames = topology_->frames;
  std::unique_ptr<Corrector> levels;
  if (topology_->quadratic) {
    const CornerMesh& corners = topology_->corners;
    levels = BuildAggregationLevels(CornerStiffness(stiffness, fixed, frames, corners, team_),
                                    MakeRigidModes(positions, fixed, frames, corners.node),
                                    options_, team_);
    if (levels != nullptr) {
      levels = std::make_unique<SmoothedLevel<float, 3>>(
          FullRows<float>(stiffness, fixed, team_),
          std::make_unique<CornerTransfer>(corners, fixed, frames, team_), std::move(levels),
          options_.quadratic_steps, options_.smoothed_part, team_);
    }
  } else {
    levels = BuildAggregationLevels(FullRows<double>(stiffness, fixed, team_),
                                    MakeRigidModes(positions, fixed, frames, topology_->nodes),
                                    options_, team_);
  }
  if (levels == nullptr) {
    return PreconditionFailed("SINGULAR",
                              "the stiffness is not positive definite: something is free to move, "
                              "or stiffnesses differ beyond what numbers can hold",
                              "supports");
  }
  hierarchy_->finest = std::move(levels);
  return absl::OkStatus();
}

void Multigrid::Correct(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  hierarchy_->finest->Correct(b, x);
}

double Multigrid::Bytes() const { return hierarchy_->finest->Bytes(); }
int Multigrid::Levels() const { return hierarchy_->finest->Levels(); }

double Multigrid::EstimateBytes(const mesh::TetrahedralMesh& mesh, const BlockPattern& pattern) {
  const double blocks = pattern.rows().size() + pattern.row_slots().size();
  const double nodes = pattern.nodes();
  if (mesh.IsQuadratic() && !IsOfStretchedElements(mesh)) {
    // Corners are an eighth of the nodes and their rows half as long; building takes as much again.
    return blocks * (sizeof(float) * 9 + sizeof(int)) + nodes * 300 + 0.3 * blocks * 76;
  }
  return 3 * blocks * 76 + nodes * 300;
}

}  // namespace mortise::simulator
