// Shoots rays within each factor of the polyhedron.
#include "common/assembly/polyhedra/polyhedron_shadow.h"

#include <Eigen/SVD>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "common/assembly/polyhedra/linear_programme.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/assembly/polyhedra/polyhedron_factors.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDependent = 1e-9;    // of the largest singular value of forms
constexpr double kNegligible = 1e-12;  // of a unit row: rounding
constexpr double kSame = 1e-7;         // between unit rows, and of a ray that reaches its corner
constexpr int kRaysPerForm = 8;
constexpr int kCornersInside = 64;  // in a row: then there are enough faces
constexpr std::size_t kMaxFaces = 4000;
constexpr int kMaxShots = 20'000;  // at corners; rounding may leave one outside for ever

absl::Status Unbounded() {
  return PreconditionFailed("POLYHEDRON_UNBOUNDED", "a form can be as large as one likes");
}

// The shadow of one factor in coordinates of its own: x = along · c + across · w, so that c alone
// says what the forms are.
class RayShooting {
 public:
  RayShooting(const Polyhedron& factor, const MatrixXd& along, const MatrixXd& across)
      : factor_(factor), along_(along), across_(across), random_(1) {}

  absl::StatusOr<PolyhedronShadow> Run() {
    MORTISE_RETURN_IF_ERROR(FindEnds());
    for (Index ray = 0; ray < kRaysPerForm * along_.cols(); ++ray) {
      MORTISE_RETURN_IF_ERROR(Shoot(RandomDirection()).status());
    }
    int inside = 0;
    for (int shots = 0; inside < kCornersInside && faces_.size() < kMaxFaces; ++shots) {
      if (shots == kMaxShots) break;
      MORTISE_ASSIGN_OR_RETURN(const VectorXd corner, RandomCorner());
      MORTISE_ASSIGN_OR_RETURN(const double reach, Shoot(corner - middle_));
      inside = reach >= 1 - kSame ? inside + 1 : 0;
    }
    return Faces();
  }

 private:
  struct Face {
    VectorXd normal;  // of c
    double bound = 0;
  };

  VectorXd RandomDirection() {
    VectorXd direction(along_.cols());
    for (double& component : direction) component = normal_(random_);
    return direction.normalized();
  }

  // The ends along each coordinate and some random directions: they bound the shadow, and lie
  // around its middle.
  absl::Status FindEnds() {
    MORTISE_ASSIGN_OR_RETURN(LinearProgramme programme,
                             LinearProgramme::Create(factor_.inequalities, factor_.bounds));
    std::vector<VectorXd> directions;
    for (Index i = 0; i < along_.cols(); ++i) {
      directions.push_back(VectorXd::Unit(along_.cols(), i));
      directions.push_back(-directions.back());
      directions.push_back(RandomDirection());
      directions.push_back(-directions.back());
    }
    VectorXd sum = VectorXd::Zero(along_.rows());
    for (const VectorXd& direction : directions) {
      MORTISE_ASSIGN_OR_RETURN(const auto end, programme.Furthest(along_ * direction));
      if (!end) return Unbounded();
      sum += *end;
      Add({direction, direction.dot(along_.transpose() * *end)});
    }
    const VectorXd point = sum / static_cast<double>(directions.size());
    middle_ = along_.transpose() * point;
    room_ = (factor_.bounds - factor_.inequalities * point).cwiseMax(0);
    return absl::OkStatus();
  }

  // How far the shadow goes from its middle, as a multiple of the direction; adds the face there.
  absl::StatusOr<double> Shoot(const VectorXd& direction) {
    if (direction.norm() <= kNegligible) return 1;
    const double length = direction.norm();
    const VectorXd unit = direction / length;
    MatrixXd rows(factor_.inequalities.rows(), 1 + across_.cols());
    rows << factor_.inequalities * (along_ * unit), factor_.inequalities * across_;
    rows = (rows.array().abs() <= kNegligible).select(0, rows);
    std::vector<Index> kept;
    for (Index i = 0; i < rows.rows(); ++i) {
      if (!rows.row(i).isZero(0)) kept.push_back(i);
    }
    MORTISE_ASSIGN_OR_RETURN(LinearProgramme programme,
                             LinearProgramme::Create(rows(kept, Eigen::all), room_(kept)));
    MORTISE_ASSIGN_OR_RETURN(const auto end,
                             programme.FurthestCorner(VectorXd::Unit(rows.cols(), 0)));
    if (!end) return Unbounded();
    const VectorXd normal = along_.transpose() *
                            (factor_.inequalities(kept, Eigen::all).transpose() * end->multipliers);
    const double size = normal.norm();
    const double reach = end->point[0];
    if (size > kDependent) Add({normal / size, (normal.dot(middle_ + reach * unit)) / size});
    return reach / length;
  }

  void Add(Face face) {
    for (Face& known : faces_) {
      if ((known.normal - face.normal).norm() > kSame) continue;
      known.bound = std::min(known.bound, face.bound);
      return;
    }
    faces_.push_back(std::move(face));
  }

  // A corner of what the faces leave, in a random direction.
  absl::StatusOr<VectorXd> RandomCorner() {
    const PolyhedronShadow faces = Faces();
    MORTISE_ASSIGN_OR_RETURN(LinearProgramme programme,
                             LinearProgramme::Create(faces.inequalities, faces.bounds));
    MORTISE_ASSIGN_OR_RETURN(const auto corner, programme.Furthest(RandomDirection()));
    if (!corner) return Unbounded();
    return *corner;
  }

  PolyhedronShadow Faces() const {
    PolyhedronShadow shadow{MatrixXd(static_cast<Index>(faces_.size()), along_.cols()),
                            VectorXd(static_cast<Index>(faces_.size()))};
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      shadow.inequalities.row(static_cast<Index>(i)) = faces_[i].normal.transpose();
      shadow.bounds[static_cast<Index>(i)] = faces_[i].bound;
    }
    return shadow;
  }

  const Polyhedron& factor_;
  const MatrixXd& along_;   // variables × r, orthonormal
  const MatrixXd& across_;  // variables × (variables - r), orthonormal
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  VectorXd middle_;  // c
  VectorXd room_;    // of each inequality at the middle
  std::vector<Face> faces_;
};

// The shadow of a factor, whose equalities are the forms.
absl::StatusOr<PolyhedronShadow> ShadowOfFactor(const Polyhedron& factor) {
  const MatrixXd& forms = factor.equalities;
  const Eigen::JacobiSVD<MatrixXd> svd(forms.transpose(),
                                       Eigen::ComputeFullU | Eigen::ComputeFullV);
  const VectorXd& sizes = svd.singularValues();
  Index rank = 0;
  while (rank < sizes.size() && sizes[rank] > kDependent * sizes[0]) ++rank;
  const MatrixXd along = svd.matrixU().leftCols(rank);
  const MatrixXd across = svd.matrixU().rightCols(svd.matrixU().cols() - rank);
  MORTISE_ASSIGN_OR_RETURN(const PolyhedronShadow own, RayShooting(factor, along, across).Run());
  // c = back · y, and y stays in the span of what c makes.
  const MatrixXd back =
      sizes.head(rank).cwiseInverse().asDiagonal() * svd.matrixV().leftCols(rank).transpose();
  const MatrixXd fixed = svd.matrixV().rightCols(forms.rows() - rank).transpose();
  const Index faces = own.bounds.size();
  PolyhedronShadow shadow{MatrixXd(faces + 2 * fixed.rows(), forms.rows()),
                          VectorXd::Zero(faces + 2 * fixed.rows())};
  shadow.inequalities << own.inequalities * back, fixed, -fixed;
  shadow.bounds.head(faces) = own.bounds;
  const VectorXd lengths = shadow.inequalities.rowwise().norm();
  shadow.inequalities = lengths.cwiseInverse().asDiagonal() * shadow.inequalities;
  shadow.bounds = shadow.bounds.cwiseQuotient(lengths);
  return shadow;
}

absl::Status Check(const MatrixXd& inequalities, const VectorXd& bounds, const MatrixXd& forms) {
  if (inequalities.rows() != bounds.size() || inequalities.cols() != forms.cols()) {
    return InvalidField("forms", "sizes do not agree");
  }
  if (!inequalities.allFinite() || !bounds.allFinite() || !forms.allFinite()) {
    return InvalidField("forms", "must be finite, as inequalities and bounds");
  }
  const auto has_zero_row = [](const MatrixXd& rows) {
    return rows.rows() > 0 && rows.rowwise().norm().minCoeff() == 0;
  };
  if (has_zero_row(inequalities) || has_zero_row(forms)) {
    return InvalidField("forms", "must not be zero, nor inequalities");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PolyhedronShadow> ShadowOf(const MatrixXd& inequalities, const VectorXd& bounds,
                                          const MatrixXd& forms) {
  MORTISE_RETURN_IF_ERROR(Check(inequalities, bounds, forms));
  const Polyhedron whole{inequalities, bounds, forms, VectorXd::Zero(forms.rows())};
  PolyhedronShadow shadow{MatrixXd(0, forms.rows()), VectorXd(0)};
  for (const PolyhedronFactor& of : FactorsOf(whole)) {
    if (of.equalities.empty()) continue;
    MORTISE_ASSIGN_OR_RETURN(const PolyhedronShadow part, ShadowOfFactor(PolyhedronOf(whole, of)));
    const Index before = shadow.bounds.size();
    const Index rows = before + part.bounds.size();
    shadow.inequalities.conservativeResize(rows, Eigen::NoChange);
    shadow.inequalities.bottomRows(part.bounds.size()).setZero();
    for (std::size_t i = 0; i < of.equalities.size(); ++i) {
      shadow.inequalities.col(of.equalities[i]).tail(part.bounds.size()) =
          part.inequalities.col(static_cast<Index>(i));
    }
    shadow.bounds.conservativeResize(rows);
    shadow.bounds.tail(part.bounds.size()) = part.bounds;
  }
  return shadow;
}

}  // namespace mortise::parametric
