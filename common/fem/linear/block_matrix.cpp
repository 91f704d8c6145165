#include "common/fem/linear/block_matrix.h"

#include <algorithm>

#include "common/fem/linear/block_rows.h"

namespace mortise::simulator {
namespace {

// Element matrices kept at a time while assembling: few enough to stay in a cache.
constexpr int kBatch = 1024;

}  // namespace

BlockMatrix::BlockMatrix(std::shared_ptr<const BlockPattern> pattern)
    : pattern_(std::move(pattern)), blocks_(pattern_->rows().size(), Eigen::Matrix3d::Zero()) {}

BlockMatrix::BlockMatrix(const mesh::TetrahedralMesh& mesh)
    : BlockMatrix(
          std::make_shared<BlockPattern>(static_cast<int>(mesh.nodes.cols()), mesh.tetrahedra)) {}

void BlockMatrix::Add(int i, int j, const Eigen::Matrix3d& block) {
  blocks_[pattern_->Find(i, j)] += block;
}

void BlockMatrix::AddElements(const std::function<void(int, Eigen::Matrix3d*)>& integrate,
                              ThreadTeam& team) {
  const int pairs = pattern_->pairs(), elements = pattern_->elements();
  const int slots = static_cast<int>(blocks_.size());
  std::vector<Eigen::Matrix3d> batch(std::size_t(pairs) * std::min(kBatch, elements));
  for (int first = 0; first < elements; first += kBatch) {
    const int count = std::min(kBatch, elements - first);
    constexpr int kPortion = 32;
    team.Run((count + kPortion - 1) / kPortion, [&](int portion) {
      for (int k = portion * kPortion; k < std::min(count, (portion + 1) * kPortion); ++k) {
        Eigen::Matrix3d* blocks = &batch[std::size_t(pairs) * k];
        std::fill(blocks, blocks + pairs, Eigen::Matrix3d::Zero());
        integrate(first + k, blocks);
      }
    });
    // Each member of the team adds up its own share of the slots.
    team.Run(team.size(), [&](int member) {
      const int begin = static_cast<int>(std::int64_t(slots) * member / team.size());
      const int end = static_cast<int>(std::int64_t(slots) * (member + 1) / team.size());
      for (int k = 0; k < count; ++k) {
        const int* places = pattern_->ElementSlots(first + k);
        const Eigen::Matrix3d* blocks = &batch[std::size_t(pairs) * k];
        for (int p = 0; p < pairs; ++p) {
          const int slot = places[p] >> 1;
          if (slot < begin || slot >= end) continue;
          if (places[p] & 1) {
            blocks_[slot] += blocks[p].transpose();
          } else {
            blocks_[slot] += blocks[p];
          }
        }
      }
    });
  }
}

void BlockMatrix::Multiply(const double* x, double* y, ThreadTeam& team) const {
  team.ForRanges(nodes(), [&](int begin, int end) {
    MultiplySymmetric(*pattern_, blocks_.front().data(), x, y, begin, end);
  });
}

void BlockMatrix::Multiply(const Eigen::Matrix3Xd& x, Eigen::Matrix3Xd& y, ThreadTeam& team) const {
  y.resize(3, nodes());
  Multiply(x.data(), y.data(), team);
}

Eigen::Matrix3Xd BlockMatrix::Multiply(const Eigen::Matrix3Xd& x) const {
  ThreadTeam alone(1);
  Eigen::Matrix3Xd y;
  Multiply(x, y, alone);
  return y;
}

}  // namespace mortise::simulator
