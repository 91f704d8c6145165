#include "common/fem/elements/matrix_assembly.h"

#include <atomic>
#include <limits>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

absl::Status BadElement(const mesh::TetrahedralMesh& mesh, Eigen::Index e) {
  const Eigen::Vector3d place = 1e3 * ElementPositions(mesh, e).leftCols(4).rowwise().mean();
  return InvalidField(
      absl::StrFormat("tetrahedra[%d]", e),
      absl::StrFormat("the element of part '%s' at (%.4g, %.4g, %.4g) mm is inverted or flat",
                      mesh.part_names[mesh.part[e]], place.x(), place.y(), place.z()));
}

void TurnIntoFrames(const mesh::TetrahedralMesh& mesh, const NodeFrames& frames, int e,
                    Eigen::Matrix3d* blocks) {
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  for (int a = 0; a < nodes; ++a) {
    const int row = frames.index[mesh.tetrahedra(a, e)];
    for (int b = a; b < nodes; ++b, ++blocks) {
      const int column = frames.index[mesh.tetrahedra(b, e)];
      if (row >= 0) *blocks = (frames.axes[row].transpose() * *blocks).eval();
      if (column >= 0) *blocks = (*blocks * frames.axes[column]).eval();
    }
  }
}

}  // namespace

absl::Status CheckMesh(const mesh::TetrahedralMesh& mesh) {
  const Eigen::Index rows = mesh.tetrahedra.rows();
  if (mesh.tetrahedra.cols() == 0 || (rows != 4 && rows != 10)) {
    return InvalidField("tetrahedra", "there must be elements, of 4 or 10 nodes");
  }
  if (mesh.tetrahedra.minCoeff() < 0 || mesh.tetrahedra.maxCoeff() >= mesh.nodes.cols()) {
    return InvalidField("tetrahedra", "an element names a node that does not exist");
  }
  if (!mesh.nodes.allFinite()) return InvalidField("nodes", "a coordinate is not finite");
  if (mesh.part.size() != mesh.tetrahedra.cols() || mesh.part.minCoeff() < 0 ||
      mesh.part.maxCoeff() >= static_cast<int>(mesh.part_names.size())) {
    return InvalidField("part", "every element must belong to a part");
  }
  return absl::OkStatus();
}

absl::Status AssembleBlocks(const mesh::TetrahedralMesh& mesh, const NodeFrames& frames,
                            const ElementKernel& kernel, ThreadTeam& team, BlockMatrix& sum) {
  constexpr int kNone = std::numeric_limits<int>::max();
  std::atomic<int> first_bad = kNone;
  sum.AddElements(
      [&](int e, Eigen::Matrix3d* blocks) {
        if (kernel(e, blocks)) {
          if (!frames.empty()) TurnIntoFrames(mesh, frames, e, blocks);
          return;
        }
        int smallest = first_bad;
        while (e < smallest && !first_bad.compare_exchange_weak(smallest, e)) {
        }
      },
      team);
  return first_bad == kNone ? absl::OkStatus() : BadElement(mesh, first_bad);
}

}  // namespace mortise::simulator
