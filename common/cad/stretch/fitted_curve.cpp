#include "common/cad/stretch/fitted_curve.h"

#include <Eigen/LU>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <cmath>
#include <numbers>

namespace mortise::cad {
namespace {

constexpr int kDegree = 9;
constexpr int kMaxHalvings = 10;  // of a piece between two breaks

using Poles = Eigen::Matrix<double, kDegree + 1, 2>;
using Row = Eigen::Matrix<double, 1, kDegree + 1>;

// Bernstein polynomials at a place in 0 … 1.
Row BernsteinAt(double place) {
  Row values = Row::Zero();
  values[0] = 1;
  for (int degree = 1; degree <= kDegree; ++degree) {
    for (int k = degree; k > 0; --k) {
      values[k] = (1 - place) * values[k] + place * values[k - 1];
    }
    values[0] *= 1 - place;
  }
  return values;
}

double ChebyshevPoint(int i) { return (1 - std::cos(i * std::numbers::pi / kDegree)) / 2; }

struct Piece {
  double to;
  Poles poles;
};

class Fit {
 public:
  Fit(const std::function<Eigen::Vector2d(double)>& curve, double tolerance)
      : curve_(curve), tolerance_(tolerance) {
    Eigen::Matrix<double, kDegree + 1, kDegree + 1> values;
    for (int i = 0; i <= kDegree; ++i) values.row(i) = BernsteinAt(ChebyshevPoint(i));
    poles_of_values_ = values.inverse();
  }

  void Append(double from, double to, int halvings = 0) {
    Poles at;
    for (int i = 0; i <= kDegree; ++i) {
      at.row(i) = curve_(i == kDegree ? to : from + (to - from) * ChebyshevPoint(i)).transpose();
    }
    Piece piece{to, poles_of_values_ * at};
    piece.poles.row(0) = at.row(0);
    piece.poles.row(kDegree) = at.row(kDegree);
    if (halvings < kMaxHalvings && Misses(piece, from, to)) {
      Append(from, (from + to) / 2, halvings + 1);
      Append((from + to) / 2, to, halvings + 1);
      return;
    }
    pieces_.push_back(piece);
  }

  Handle(Geom2d_BSplineCurve) Spline(double from) const {
    const auto count = static_cast<int>(pieces_.size());
    TColgp_Array1OfPnt2d poles(1, count * kDegree + 1);
    TColStd_Array1OfReal knots(1, count + 1);
    TColStd_Array1OfInteger multiplicities(1, count + 1);
    multiplicities.Init(kDegree);
    multiplicities.SetValue(1, kDegree + 1);
    multiplicities.SetValue(count + 1, kDegree + 1);
    knots.SetValue(1, from);
    for (int i = 0; i < count; ++i) {
      const Piece& piece = pieces_[static_cast<std::size_t>(i)];
      knots.SetValue(i + 2, piece.to);
      for (int k = 0; k <= kDegree; ++k) {
        poles.SetValue(i * kDegree + k + 1, gp_Pnt2d(piece.poles(k, 0), piece.poles(k, 1)));
      }
    }
    return new Geom2d_BSplineCurve(poles, knots, multiplicities, kDegree);
  }

 private:
  bool Misses(const Piece& piece, double from, double to) const {
    for (int i = 0; i < kDegree; ++i) {
      const double place = (ChebyshevPoint(i) + ChebyshevPoint(i + 1)) / 2;
      const Eigen::Vector2d fitted = (BernsteinAt(place) * piece.poles).transpose();
      if (!((fitted - curve_(from + (to - from) * place)).norm() <= tolerance_)) return true;
    }
    return false;
  }

  const std::function<Eigen::Vector2d(double)>& curve_;
  const double tolerance_;
  Eigen::Matrix<double, kDegree + 1, kDegree + 1> poles_of_values_;
  std::vector<Piece> pieces_;
};

}  // namespace

Handle(Geom2d_BSplineCurve) FitCurve(const std::function<Eigen::Vector2d(double)>& curve,
                                     const std::vector<double>& breaks, double tolerance) {
  Fit fit(curve, tolerance);
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) fit.Append(breaks[i], breaks[i + 1]);
  return fit.Spline(breaks.front());
}

}  // namespace mortise::cad
