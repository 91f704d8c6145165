#include "common/fem/linear/aggregation.h"

#include <cmath>
#include <utility>

namespace mortise::simulator {
namespace {

using Block6 = Eigen::Matrix<double, 6, 6>;

// Couplings grow weaker from level to level by about this much.
constexpr double kWeakening = 0.25;

// Coarsest levels of at most as many unknowns get a dense factor.
constexpr int kDenseUnknowns = 900;

// A motion that keeps less than this of its size beside the others is one that the aggregate does
// not have, such as the rotation of collinear nodes about their line.
constexpr double kIndependent = 1e-7;

// The diagonal block of row i.
template <int B>
const Eigen::Matrix<double, B, B>& Diagonal(const BlockRows<double, B, B>& a, int i) {
  const auto begin = a.columns.begin() + a.starts[i], end = a.columns.begin() + a.starts[i + 1];
  return a.blocks[std::lower_bound(begin, end, i) - a.columns.begin()];
}

// The strong couplings of each node, as a compressed list, with their strength.
struct Couplings {
  std::vector<int> starts{0}, nodes;
  std::vector<double> strength;
};

template <int B>
Couplings FindCouplings(const BlockRows<double, B, B>& a, double least) {
  Eigen::VectorXd size(a.rows());
  for (int i = 0; i < a.rows(); ++i) size[i] = Diagonal(a, i).norm();
  Couplings couplings;
  for (int i = 0; i < a.rows(); ++i) {
    for (int k = a.starts[i]; k < a.starts[i + 1]; ++k) {
      const int j = a.columns[k];
      const double strength = a.blocks[k].squaredNorm() / (size[i] * size[j]);
      if (j == i || !(strength > least * least)) continue;
      couplings.nodes.push_back(j);
      couplings.strength.push_back(strength);
    }
    couplings.starts.push_back(static_cast<int>(couplings.nodes.size()));
  }
  return couplings;
}

// The basis of each aggregate: its rigid motions made orthonormal (`prolongation`, one block for
// each node), and what the rigid motions are in that basis (`modes`).
template <int B>
struct Basis {
  BlockRows<double, B, 6> prolongation;
  RigidModes<6> modes;
};

// B = Q R by Gram and Schmidt, twice for accuracy; dependent columns of Q are zero.
void Orthonormalise(Eigen::Matrix<double, Eigen::Dynamic, 6>& q, Block6& r) {
  r.setZero();
  for (int c = 0; c < 6; ++c) {
    const double size = q.col(c).norm();
    for (int round = 0; round < 2; ++round) {
      for (int b = 0; b < c; ++b) {
        const double share = q.col(b).dot(q.col(c));
        q.col(c) -= share * q.col(b);
        r(b, c) += share;
      }
    }
    const double rest = q.col(c).norm();
    if (rest > kIndependent * size) {
      q.col(c) /= rest;
      r(c, c) = rest;
    } else {
      q.col(c).setZero();
    }
  }
}

template <int B>
Basis<B> MakeBasis(const Aggregates& aggregates, const RigidModes<B>& modes) {
  const int nodes = static_cast<int>(aggregates.of.size());
  std::vector<int> first(aggregates.count + 1, 0), members;
  for (const int aggregate : aggregates.of) {
    if (aggregate >= 0) ++first[aggregate + 1];
  }
  for (int a = 0; a < aggregates.count; ++a) first[a + 1] += first[a];
  members.resize(first.back());
  std::vector<int> next(first.begin(), first.end() - 1);
  Basis<B> basis;
  basis.prolongation.blocks.resize(members.size());
  std::vector<int> place(nodes, -1);
  for (int i = 0; i < nodes; ++i) {
    const int aggregate = aggregates.of[i];
    if (aggregate >= 0) {
      members[next[aggregate]++] = i;
      place[i] = static_cast<int>(basis.prolongation.columns.size());
      basis.prolongation.columns.push_back(aggregate);
    }
    basis.prolongation.starts.push_back(static_cast<int>(basis.prolongation.columns.size()));
  }
  basis.modes.resize(aggregates.count);
  for (int a = 0; a < aggregates.count; ++a) {
    const int count = first[a + 1] - first[a];
    Eigen::Matrix<double, Eigen::Dynamic, 6> local(B * count, 6);
    for (int k = 0; k < count; ++k) {
      local.template middleRows<B>(B * k) = modes[members[first[a] + k]];
    }
    Orthonormalise(local, basis.modes[a]);
    for (int k = 0; k < count; ++k) {
      basis.prolongation.blocks[place[members[first[a] + k]]] = local.template middleRows<B>(B * k);
    }
  }
  return basis;
}

// P = (I − ω D⁻¹ A) P₀.
template <int B>
BlockRows<double, B, 6> SmoothBasis(const BlockRows<double, B, B>& matrix,
                                    const BlockRows<double, B, 6>& basis, int aggregates,
                                    ThreadTeam& team) {
  const auto inverse = InvertDiagonal(matrix);
  // The safety in the largest eigenvalue makes this 4/3 over it.
  const double weight = 1.4 / LargestEigenvalue(matrix, inverse, team);
  BlockRows<double, B, 6> result = Product<B, B, 6>(matrix, basis, aggregates, team);
  for (int i = 0; i < result.rows(); ++i) {
    const int own = basis.starts[i] < basis.starts[i + 1] ? basis.columns[basis.starts[i]] : -1;
    for (int k = result.starts[i]; k < result.starts[i + 1]; ++k) {
      result.blocks[k] = -weight * (inverse[i] * result.blocks[k]).eval();
      if (result.columns[k] == own) result.blocks[k] += basis.blocks[basis.starts[i]];
    }
  }
  return result;
}

template <int B>
class AggregateTransfer : public Transfer {
 public:
  AggregateTransfer(BlockRows<double, B, 6> prolongation, BlockRows<double, 6, B> restriction,
                    ThreadTeam& team)
      : prolongation_(std::move(prolongation)), restriction_(std::move(restriction)), team_(team) {}

  void Prolong(const Eigen::VectorXd& coarse, Eigen::VectorXd& x) const override {
    team_.ForRanges(prolongation_.rows(), [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        for (int k = prolongation_.starts[i]; k < prolongation_.starts[i + 1]; ++k) {
          x.template segment<B>(B * i) +=
              prolongation_.blocks[k] * coarse.segment<6>(6 * prolongation_.columns[k]);
        }
      }
    });
  }

  void Restrict(const Eigen::VectorXd& b, Eigen::VectorXd& coarse) const override {
    coarse.resize(Eigen::Index(6) * restriction_.rows());
    team_.ForRanges(restriction_.rows(), [&](int begin, int end) {
      MultiplyRows(restriction_, b.data(), coarse.data(), begin, end);
    });
  }

  double Bytes() const override { return prolongation_.Bytes() + restriction_.Bytes(); }

 private:
  BlockRows<double, B, 6> prolongation_;
  BlockRows<double, 6, B> restriction_;
  ThreadTeam& team_;
};

template <int B>
Eigen::MatrixXd Dense(const BlockRows<double, B, B>& a) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(B * a.rows(), B * a.rows());
  for (int i = 0; i < a.rows(); ++i) {
    for (int k = a.starts[i]; k < a.starts[i + 1]; ++k) {
      dense.template block<B, B>(B * i, B * a.columns[k]) = a.blocks[k];
    }
  }
  // Unknowns that stand for no motion have no stiffness, and no load.
  const double largest = a.rows() > 0 ? dense.diagonal().maxCoeff() : 0;
  for (Eigen::Index k = 0; k < dense.rows(); ++k) {
    if (dense(k, k) == 0) dense(k, k) = largest;
  }
  return dense;
}

template <int B>
std::unique_ptr<Corrector> BuildLevels(BlockRows<double, B, B> matrix, const RigidModes<B>& modes,
                                       const MultigridOptions& options, ThreadTeam& team) {
  if (B * matrix.rows() <= kDenseUnknowns) {
    auto level = std::make_unique<DenseLevel>(Dense(matrix));
    if (!level->positive_definite()) return nullptr;
    return level;
  }
  const Aggregates aggregates = FindAggregates(matrix, options.strength);
  MultigridOptions below = options;
  below.strength *= kWeakening;
  Basis<B> basis = MakeBasis(aggregates, modes);
  BlockRows<double, B, 6> prolongation =
      SmoothBasis(matrix, basis.prolongation, aggregates.count, team);
  BlockRows<double, 6, B> restriction = Transpose(prolongation, aggregates.count);
  BlockRows<double, 6, 6> coarse_matrix =
      Product<6, B, 6>(restriction, Product<B, B, 6>(matrix, prolongation, aggregates.count, team),
                       aggregates.count, team);
  std::unique_ptr<Corrector> coarse =
      BuildLevels<6>(std::move(coarse_matrix), basis.modes, below, team);
  if (coarse == nullptr) return nullptr;
  return std::make_unique<SmoothedLevel<double, B>>(
      std::move(matrix),
      std::make_unique<AggregateTransfer<B>>(std::move(prolongation), std::move(restriction), team),
      std::move(coarse), options.linear_steps, options.smoothed_part, team);
}

}  // namespace

template <int B>
Aggregates FindAggregates(const BlockRows<double, B, B>& matrix, double strength) {
  const Couplings couplings = FindCouplings(matrix, strength);
  Aggregates aggregates;
  std::vector<int>& of = aggregates.of;
  of.assign(matrix.rows(), -1);
  const auto gather = [&](int i) {
    of[i] = aggregates.count;
    for (int k = couplings.starts[i]; k < couplings.starts[i + 1]; ++k) {
      if (of[couplings.nodes[k]] < 0) of[couplings.nodes[k]] = aggregates.count;
    }
    ++aggregates.count;
  };
  // Nodes whose neighbours are all free make aggregates with them.
  for (int i = 0; i < matrix.rows(); ++i) {
    bool free = couplings.starts[i] < couplings.starts[i + 1] && of[i] < 0;
    for (int k = couplings.starts[i]; free && k < couplings.starts[i + 1]; ++k) {
      free = of[couplings.nodes[k]] < 0;
    }
    if (free) gather(i);
  }
  // The others join the aggregate they are most strongly coupled to.
  const std::vector<int> first = of;
  for (int i = 0; i < matrix.rows(); ++i) {
    double strongest = 0;
    for (int k = couplings.starts[i]; first[i] < 0 && k < couplings.starts[i + 1]; ++k) {
      if (first[couplings.nodes[k]] < 0 || couplings.strength[k] <= strongest) continue;
      strongest = couplings.strength[k];
      of[i] = first[couplings.nodes[k]];
    }
  }
  for (int i = 0; i < matrix.rows(); ++i) {
    if (of[i] < 0 && couplings.starts[i] < couplings.starts[i + 1]) gather(i);
  }
  return aggregates;
}

template Aggregates FindAggregates(const BlockRows<double, 3, 3>&, double);
template Aggregates FindAggregates(const BlockRows<double, 6, 6>&, double);

std::unique_ptr<Corrector> BuildAggregationLevels(BlockRows<double, 3, 3> matrix,
                                                  const RigidModes<3>& modes,
                                                  const MultigridOptions& options,
                                                  ThreadTeam& team) {
  return BuildLevels<3>(std::move(matrix), modes, options, team);
}

}  // namespace mortise::simulator
