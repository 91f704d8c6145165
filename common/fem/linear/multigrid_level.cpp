#include "common/fem/linear/multigrid_level.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "common/fem/linear/tridiagonal.h"

namespace mortise::simulator {
namespace {

// Lanczos' method sees the largest eigenvalue from below.
constexpr int kLanczosSteps = 12;
constexpr double kSafety = 1.1;

// A number in -1 … 1 that looks random and is the same everywhere.
double Scatter(std::uint32_t k) {
  k = (k ^ 61) ^ (k >> 16);
  k *= 9;
  k ^= k >> 4;
  k *= 0x27d4eb2d;
  k ^= k >> 15;
  return k / 2147483648.0 - 1;
}

// Inverts a symmetric positive matrix of `size` rows in place, by sweeping its pivots. Rows whose
// pivot vanishes beside `floor` become zero.
void InvertInPlace(double* a, int size, double floor) {
  std::vector<bool> swept(size, false);
  for (int k = 0; k < size; ++k) {
    const double pivot = a[k * size + k];
    if (!(pivot > floor)) continue;
    swept[k] = true;
    for (int i = 0; i < size; ++i) {
      for (int j = 0; i != k && j < size; ++j) {
        if (j != k) a[j * size + i] -= a[k * size + i] * a[j * size + k] / pivot;
      }
    }
    for (int i = 0; i < size; ++i) {
      if (i == k) continue;
      a[k * size + i] /= pivot;
      a[i * size + k] /= pivot;
    }
    a[k * size + k] = -1 / pivot;
  }
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      a[j * size + i] = swept[i] && swept[j] ? -a[j * size + i] : 0;
    }
  }
}

template <int B>
Eigen::VectorXd MultiplyBlocks(const std::vector<Eigen::Matrix<double, B, B>>& blocks,
                               const Eigen::VectorXd& x) {
  Eigen::VectorXd y(x.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    y.template segment<B>(B * i) = blocks[i] * x.template segment<B>(B * i);
  }
  return y;
}

}  // namespace

template <class T, int B>
std::vector<Eigen::Matrix<double, B, B>> InvertDiagonal(const BlockRows<T, B, B>& a) {
  using Block = Eigen::Matrix<double, B, B>;
  std::vector<Block> inverse(a.rows(), Block::Zero());
  for (int i = 0; i < a.rows(); ++i) {
    const auto begin = a.columns.begin() + a.starts[i], end = a.columns.begin() + a.starts[i + 1];
    inverse[i] =
        a.blocks[std::lower_bound(begin, end, i) - a.columns.begin()].template cast<double>();
    InvertInPlace(inverse[i].data(), B, 1e-12 * inverse[i].diagonal().maxCoeff());
  }
  return inverse;
}

template <class T, int B>
double LargestEigenvalue(const BlockRows<T, B, B>& a,
                         const std::vector<Eigen::Matrix<double, B, B>>& inverse_diagonal,
                         ThreadTeam& team) {
  // Conjugate gradients on A x = b preconditioned by D: their coefficients are those of Lanczos'
  // tridiagonal matrix.
  const Eigen::Index size = Eigen::Index(B) * a.rows();
  Eigen::VectorXd r(size), q(size);
  for (Eigen::Index k = 0; k < size; ++k) r[k] = Scatter(static_cast<std::uint32_t>(k));
  Eigen::VectorXd z = MultiplyBlocks<B>(inverse_diagonal, r), p = z;
  double rho = r.dot(z), last_alpha = 0, last_beta = 0;
  std::vector<double> diagonal, side;
  for (int step = 0; step < kLanczosSteps && rho > 0; ++step) {
    team.ForRanges(a.rows(),
                   [&](int begin, int end) { MultiplyRows(a, p.data(), q.data(), begin, end); });
    const double curvature = p.dot(q);
    if (!(curvature > 0)) break;
    const double alpha = rho / curvature;
    diagonal.push_back(1 / alpha + (step > 0 ? last_beta / last_alpha : 0));
    r -= alpha * q;
    z = MultiplyBlocks<B>(inverse_diagonal, r);
    const double next = r.dot(z);
    if (!(next > 1e-20 * rho)) break;
    const double beta = next / rho;
    side.push_back(std::sqrt(beta) / alpha);
    p = z + beta * p;
    rho = next;
    last_alpha = alpha;
    last_beta = beta;
  }
  if (diagonal.empty()) return 1;
  side.resize(diagonal.size() - 1);
  return kSafety * FindSpectrum(diagonal, side).most;
}

template <class T, int B>
SmoothedLevel<T, B>::SmoothedLevel(BlockRows<T, B, B> matrix, std::unique_ptr<Transfer> transfer,
                                   std::unique_ptr<Corrector> coarse, int steps,
                                   double smoothed_part, ThreadTeam& team)
    : matrix_(std::move(matrix)),
      inverse_diagonal_(InvertDiagonal(matrix_)),
      transfer_(std::move(transfer)),
      coarse_(std::move(coarse)),
      steps_(steps),
      smoothed_part_(smoothed_part),
      team_(team),
      largest_(LargestEigenvalue(matrix_, inverse_diagonal_, team)) {
  const Eigen::Index size = Eigen::Index(B) * matrix_.rows();
  direction_ = moved_ = residual_ = Eigen::VectorXd::Zero(size);
}

template <class T, int B>
double SmoothedLevel<T, B>::Bytes() const {
  const double vectors = 8.0 * (3 * direction_.size() + 2 * coarse_load_.size());
  return matrix_.Bytes() + sizeof(inverse_diagonal_[0]) * double(matrix_.rows()) + vectors +
         transfer_->Bytes() + coarse_->Bytes();
}

template <class T, int B>
void SmoothedLevel<T, B>::Smooth(const Eigen::VectorXd& b, Eigen::VectorXd& x, bool from_zero) {
  const double upper = largest_, lower = smoothed_part_ * largest_;
  const double centre = 0.5 * (upper + lower), radius = 0.5 * (upper - lower);
  double rho = radius / centre;
  for (int step = 0; step < steps_; ++step) {
    double of_direction = 0, of_residual = 1 / centre;
    if (step > 0) {
      const double next = 1 / (2 * centre / radius - rho);
      of_direction = next * rho;
      of_residual = 2 * next / radius;
      rho = next;
    }
    const bool zero = from_zero && step == 0;
    team_.ForRanges(matrix_.rows(), [&](int begin, int end) {
      if (!zero) MultiplyRows(matrix_, x.data(), residual_.data(), begin, end);
      for (int i = begin; i < end; ++i) {
        Eigen::Matrix<double, B, 1> rest = b.template segment<B>(B * i);
        if (!zero) rest -= residual_.template segment<B>(B * i);
        Eigen::Matrix<double, B, 1> way = of_residual * (inverse_diagonal_[i] * rest);
        if (step > 0) way += of_direction * direction_.template segment<B>(B * i);
        direction_.template segment<B>(B * i) = way;
        if (zero) {
          moved_.template segment<B>(B * i) = way;
        } else {
          moved_.template segment<B>(B * i) = x.template segment<B>(B * i) + way;
        }
      }
    });
    x.swap(moved_);
  }
}

template <class T, int B>
void SmoothedLevel<T, B>::Correct(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  x.resize(b.size());
  Smooth(b, x, true);
  team_.ForRanges(matrix_.rows(), [&](int begin, int end) {
    MultiplyRows(matrix_, x.data(), residual_.data(), begin, end);
    const Eigen::Index first = Eigen::Index(B) * begin, count = Eigen::Index(B) * (end - begin);
    residual_.segment(first, count) = b.segment(first, count) - residual_.segment(first, count);
  });
  transfer_->Restrict(residual_, coarse_load_);
  coarse_->Correct(coarse_load_, coarse_correction_);
  transfer_->Prolong(coarse_correction_, x);
  Smooth(b, x, false);
}

DenseLevel::DenseLevel(Eigen::MatrixXd matrix) : factor_(std::move(matrix)) {
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(factor_);
  positive_definite_ = in_place.info() == Eigen::Success;
}

void DenseLevel::Correct(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  x = b;
  factor_.triangularView<Eigen::Lower>().solveInPlace(x);
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
}

template class SmoothedLevel<float, 3>;
template class SmoothedLevel<double, 3>;
template class SmoothedLevel<double, 6>;

template double LargestEigenvalue(const BlockRows<double, 3, 3>&,
                                  const std::vector<Eigen::Matrix3d>&, ThreadTeam&);
template double LargestEigenvalue(const BlockRows<double, 6, 6>&,
                                  const std::vector<Eigen::Matrix<double, 6, 6>>&, ThreadTeam&);
template std::vector<Eigen::Matrix3d> InvertDiagonal(const BlockRows<double, 3, 3>&);
template std::vector<Eigen::Matrix<double, 6, 6>> InvertDiagonal(const BlockRows<double, 6, 6>&);

}  // namespace mortise::simulator
