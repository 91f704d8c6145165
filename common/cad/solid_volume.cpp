// Integrates over the boundary: by the theorem of Gauss the volume is a third of the integral of
// P · N over all faces, and by that of Green, in the parameters of a face, one along its edges:
//
//   ∬ f du dv = ∮ G dv,   G(u, v) = ∫ f(s, v) ds from some u₀ to u,   f = P · (∂P/∂u × ∂P/∂v) / 3
//
// Both integrals are taken by Gauss–Legendre quadrature between the places where the integrand is
// not smooth, at which it converges exponentially for rational splines. It is done at two orders;
// where they differ, the kernel's own adaptive integration decides, which takes a hundred times as
// long.
#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Core>
#include <GProp_GProps.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <functional>
#include <math.hxx>
#include <math_Vector.hxx>
#include <optional>
#include <vector>

#include "common/cad/solid_kernel.h"

namespace mortise::cad {
namespace {

constexpr double kKernelError = 1e-8;  // relative
constexpr double kAgreement = 1e-9;    // of the volume, that the two orders may differ by
constexpr int kLowOrder = 12;
constexpr int kHighOrder = 20;
constexpr int kLooks = 16;       // for crossings, along each smooth piece of an edge
constexpr double kFlat = 1e-12;  // of the parameters' range: no change

// Gauss–Legendre quadrature on [-1, 1].
struct Quadrature {
  explicit Quadrature(int order) : points(order), weights(order) {
    math_Vector at(1, order), weight(1, order);
    math::GaussPoints(order, at);
    math::GaussWeights(order, weight);
    for (int i = 0; i < order; ++i) {
      points[i] = at(i + 1);
      weights[i] = weight(i + 1);
    }
  }

  template <class Function>
  double Integrate(double from, double to, const Function& function) const {
    const double middle = (from + to) / 2, half = (to - from) / 2;
    double sum = 0;
    for (Eigen::Index i = 0; i < points.size(); ++i) {
      sum += weights[i] * function(middle + half * points[i]);
    }
    return half * sum;
  }

  Eigen::VectorXd points, weights;
};

std::vector<double> ToVector(const TColStd_Array1OfReal& values) {
  return {values.begin(), values.end()};
}

// A face's parameters, and between which of them it is smooth.
class FaceIntegral {
 public:
  explicit FaceIntegral(const TopoDS_Face& face)
      : face_(TopoDS::Face(face.Oriented(TopAbs_FORWARD))),
        surface_(face_),
        sign_(face.Orientation() == TopAbs_REVERSED ? -1 : 1) {
    BRepTools::UVBounds(face_, u_minimum_, u_maximum_, v_minimum_, v_maximum_);
    FindBreaks();
  }

  // m³, of the cone from the origin over the face, negative where that sees it from outside.
  // Nothing if an edge has no place in the face's parameters.
  std::optional<double> At(const Quadrature& rule) const {
    double sum = 0;
    for (TopExp_Explorer edge(face_, TopAbs_EDGE); edge.More(); edge.Next()) {
      const TopAbs_Orientation orientation = edge.Current().Orientation();
      if (orientation != TopAbs_FORWARD && orientation != TopAbs_REVERSED) continue;
      double first = 0, last = 0;
      const Handle(Geom2d_Curve) curve =
          BRep_Tool::CurveOnSurface(TopoDS::Edge(edge.Current()), face_, first, last);
      if (curve.IsNull()) return std::nullopt;
      const double along = AlongEdge(Geom2dAdaptor_Curve(curve, first, last), rule);
      sum += orientation == TopAbs_REVERSED ? -along : along;
    }
    return sign_ * sum;
  }

 private:
  void FindBreaks() {
    if (surface_.GetType() == GeomAbs_BSplineSurface) {
      // What the adaptor says of periodic ones is not all of their knots.
      const Handle(Geom_BSplineSurface) spline = surface_.BSpline();
      u_breaks_ =
          Repeated(ToVector(spline->UKnots()), spline->IsUPeriodic(), u_minimum_, u_maximum_);
      v_breaks_ =
          Repeated(ToVector(spline->VKnots()), spline->IsVPeriodic(), v_minimum_, v_maximum_);
      return;
    }
    TColStd_Array1OfReal u(1, surface_.NbUIntervals(GeomAbs_CN) + 1);
    surface_.UIntervals(u, GeomAbs_CN);
    u_breaks_ = ToVector(u);
    TColStd_Array1OfReal v(1, surface_.NbVIntervals(GeomAbs_CN) + 1);
    surface_.VIntervals(v, GeomAbs_CN);
    v_breaks_ = ToVector(v);
  }

  // The knots again in each period that `from` to `to` touches.
  static std::vector<double> Repeated(const std::vector<double>& knots, bool is_periodic,
                                      double from, double to) {
    const double period = knots.back() - knots.front();
    if (!is_periodic) return knots;
    std::vector<double> repeated;
    const double first = std::floor((from - knots.front()) / period);
    for (double turn = first; knots.front() + turn * period < to; ++turn) {
      for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        repeated.push_back(knots[i] + turn * period);
      }
    }
    return repeated;
  }

  double AlongEdge(const Geom2dAdaptor_Curve& curve, const Quadrature& rule) const {
    const double flat_u = kFlat * (u_maximum_ - u_minimum_);
    const double flat_v = kFlat * (v_maximum_ - v_minimum_);
    const std::vector<double> breaks = BreaksOf(curve);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      sum += rule.Integrate(breaks[i], breaks[i + 1], [&](double t) {
        gp_Pnt2d at;
        gp_Vec2d change;
        curve.D1(t, at, change);
        const double moved = change.Y() * (breaks[i + 1] - breaks[i]);
        if (std::abs(moved) <= flat_v || std::abs(at.X() - u_minimum_) <= flat_u) return 0.0;
        return change.Y() * AcrossTo(at.X(), at.Y(), rule);
      });
    }
    return sum;
  }

  // G of the first lines of this file.
  double AcrossTo(double u, double v, const Quadrature& rule) const {
    const double low = std::min(u, u_minimum_), high = std::max(u, u_minimum_);
    double from = low, sum = 0;
    const auto f = [&](double s) {
      gp_Pnt at;
      gp_Vec along_u, along_v;
      surface_.D1(s, v, at, along_u, along_v);
      return at.XYZ().Dot(along_u.Crossed(along_v).XYZ()) / 3;
    };
    for (const double knot : u_breaks_) {
      if (knot <= from || knot >= high) continue;
      sum += rule.Integrate(from, knot, f);
      from = knot;
    }
    sum += rule.Integrate(from, high, f);
    return u < u_minimum_ ? -sum : sum;
  }

  // The parameters of the curve at its ends and where it, or the surface along it, is not smooth.
  std::vector<double> BreaksOf(const Geom2dAdaptor_Curve& curve) const {
    TColStd_Array1OfReal own(1, curve.NbIntervals(GeomAbs_CN) + 1);
    curve.Intervals(own, GeomAbs_CN);
    const std::vector<double> smooth = ToVector(own);
    std::vector<double> breaks = smooth;
    for (std::size_t i = 0; i + 1 < smooth.size(); ++i) {
      for (const double knot : u_breaks_) {
        AddCrossings([&](double t) { return curve.Value(t).X() - knot; }, smooth[i], smooth[i + 1],
                     breaks);
      }
      for (const double knot : v_breaks_) {
        AddCrossings([&](double t) { return curve.Value(t).Y() - knot; }, smooth[i], smooth[i + 1],
                     breaks);
      }
    }
    std::sort(breaks.begin(), breaks.end());
    return breaks;
  }

  // Where `distance` changes its sign, if it does so between two looks.
  static void AddCrossings(const std::function<double(double)>& distance, double from, double to,
                           std::vector<double>& breaks) {
    double before = from, value_before = distance(from);
    for (int look = 1; look <= kLooks; ++look) {
      const double now = from + (to - from) * look / kLooks;
      const double value = distance(now);
      if ((value_before < 0 && value > 0) || (value_before > 0 && value < 0)) {
        double low = before, high = now;
        for (int halving = 0; halving < 60; ++halving) {
          const double middle = (low + high) / 2;
          ((distance(middle) < 0) == (value_before < 0) ? low : high) = middle;
        }
        breaks.push_back(low);
      }
      before = now;
      value_before = value;
    }
  }

  const TopoDS_Face face_;
  const BRepAdaptor_Surface surface_;
  const double sign_;
  double u_minimum_ = 0, u_maximum_ = 0, v_minimum_ = 0, v_maximum_ = 0;
  std::vector<double> u_breaks_, v_breaks_;
};

// Nothing where the two orders do not agree.
std::optional<double> BoundaryIntegral(const TopoDS_Shape& solid) {
  static const Quadrature low(kLowOrder), high(kHighOrder);
  double volume = 0, difference = 0;
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    const FaceIntegral integral(TopoDS::Face(face.Current()));
    const std::optional<double> rough = integral.At(low), fine = integral.At(high);
    if (!rough || !fine) return std::nullopt;
    volume += *fine;
    difference += std::abs(*fine - *rough);
  }
  if (!(difference <= kAgreement * std::abs(volume))) return std::nullopt;
  return volume;
}

}  // namespace

double AccurateVolume(const TopoDS_Shape& solid) {
  if (const std::optional<double> volume = BoundaryIntegral(solid)) return *volume;
  GProp_GProps properties;
  BRepGProp::VolumePropertiesGK(solid, properties, kKernelError);
  return properties.Mass();
}

}  // namespace mortise::cad
