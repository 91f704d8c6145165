#include "common/cad/stretch/stretched_surface.h"

#include <Eigen/Geometry>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/cad/occt_vectors.h"
#include "common/cad/stretch/stretched_curve.h"

namespace mortise::cad {
namespace {

constexpr double kSame = 1e-9;      // factors that differ by less, relatively, are one
constexpr double kParallel = 1e-9;  // sine of an angle
constexpr double kPi = std::numbers::pi;
constexpr double kMaxArc = 2 * kPi / 3;  // rad, of one rational arc
constexpr double kMargin = 0.02;         // of a face's range, that its surface reaches beyond it
constexpr double kWholeTurn = 1e-6;      // rad, that a face may lack of a turn which closes

// A curve's poles with weights, degree and knots, over which parameters go as `map` says.
struct RationalCurve {
  Eigen::Matrix4Xd poles;  // weight times place, and weight
  std::vector<double> knots;
  std::vector<int> multiplicities;
  int degree = 1;
  ParameterMap map;
};

Eigen::Vector4d Weighted(const Eigen::Vector3d& place, double weight) {
  return (Eigen::Vector4d() << weight * place, weight).finished();
}

// center + x cos t + y sin t for t from one angle to the other.
RationalCurve Arcs(const Eigen::Vector3d& center, const Eigen::Vector3d& x,
                   const Eigen::Vector3d& y, double from, double to) {
  const int count = std::max(1, static_cast<int>(std::ceil((to - from) / kMaxArc - kSame)));
  const double arc = (to - from) / count, weight = std::cos(arc / 2);
  RationalCurve curve;
  curve.degree = 2;
  curve.poles.resize(4, 2 * count + 1);
  for (int i = 0; i <= 2 * count; ++i) {
    const double t = from + i * arc / 2;
    const Eigen::Vector3d away = std::cos(t) * x + std::sin(t) * y;
    curve.poles.col(i) =
        i % 2 == 0 ? Weighted(center + away, 1) : Weighted(center + away / weight, weight);
  }
  for (int i = 0; i <= count; ++i) {
    curve.knots.push_back(i == count ? to : from + i * arc);
    curve.multiplicities.push_back(i == 0 || i == count ? 3 : 2);
  }
  curve.map.knots = curve.knots;
  return curve;
}

RationalCurve PolesOf(const Handle(Geom_BSplineCurve) & spline) {
  RationalCurve curve;
  curve.degree = spline->Degree();
  curve.poles.resize(4, spline->NbPoles());
  for (int i = 0; i < spline->NbPoles(); ++i) {
    curve.poles.col(i) = Weighted(ToEigen(spline->Pole(i + 1).XYZ()), spline->Weight(i + 1));
  }
  for (int i = 1; i <= spline->NbKnots(); ++i) {
    curve.knots.push_back(spline->Knot(i));
    curve.multiplicities.push_back(spline->Multiplicity(i));
  }
  return curve;
}

// A curve between two parameters; nothing if it is no line, circle, ellipse or spline.
std::optional<RationalCurve> RationalOf(const Handle(Geom_Curve) & drawn, double from, double to) {
  auto basis = Untrimmed<Geom_Curve, Geom_TrimmedCurve>(drawn);
  if (!Handle(Geom_Line)::DownCast(basis).IsNull()) {
    RationalCurve line;
    line.poles.resize(4, 2);
    line.poles << Weighted(ToEigen(basis->Value(from).XYZ()), 1),
        Weighted(ToEigen(basis->Value(to).XYZ()), 1);
    line.knots = {from, to};
    line.multiplicities = {2, 2};
    return line;
  }
  const auto circle = Handle(Geom_Circle)::DownCast(basis);
  const auto ellipse = Handle(Geom_Ellipse)::DownCast(basis);
  if (!circle.IsNull() || !ellipse.IsNull()) {
    const auto conic = Handle(Geom_Conic)::DownCast(basis);
    const double x = circle.IsNull() ? ellipse->MajorRadius() : circle->Radius();
    const double y = circle.IsNull() ? ellipse->MinorRadius() : circle->Radius();
    return Arcs(ToEigen(conic->Location().XYZ()), x * ToEigen(conic->XAxis().Direction().XYZ()),
                y * ToEigen(conic->YAxis().Direction().XYZ()), from, to);
  }
  if (!Handle(Geom_BezierCurve)::DownCast(basis).IsNull()) {
    basis = GeomConvert::CurveToBSplineCurve(basis);
  }
  if (Handle(Geom_BSplineCurve)::DownCast(basis).IsNull()) return std::nullopt;
  const auto spline = Handle(Geom_BSplineCurve)::DownCast(basis->Copy());
  if (spline->IsPeriodic()) spline->SetNotPeriodic();
  if (from < spline->FirstParameter() - kSame || to > spline->LastParameter() + kSame) {
    return std::nullopt;
  }
  return PolesOf(spline);
}

TColStd_Array1OfReal KnotsOf(const RationalCurve& curve) {
  TColStd_Array1OfReal knots(1, static_cast<int>(curve.knots.size()));
  std::copy(curve.knots.begin(), curve.knots.end(), knots.begin());
  return knots;
}

TColStd_Array1OfInteger MultiplicitiesOf(const RationalCurve& curve) {
  TColStd_Array1OfInteger multiplicities(1, static_cast<int>(curve.multiplicities.size()));
  std::copy(curve.multiplicities.begin(), curve.multiplicities.end(), multiplicities.begin());
  return multiplicities;
}

// A range with its margin within what the surface has: for what closes, a whole turn at most.
void AddMargin(double& minimum, double& maximum, double least, double most, double period) {
  const double length = maximum - minimum;
  if (period > 0 && length > period - kWholeTurn) {
    maximum = minimum + period;
    return;
  }
  double margin = kMargin * length;
  if (period > 0) margin = std::min(margin, (period - length) / 2);
  minimum = std::max(least, minimum - margin);
  maximum = std::min(most, maximum + margin);
}

// What is turned about an axis: its meridian, at u = 0, and the way that u goes round.
struct Revolution {
  gp_Ax1 axis;
  double way = 1;
  Handle(Geom_Curve) meridian;
  double v_least = -std::numeric_limits<double>::infinity();
  double v_most = std::numeric_limits<double>::infinity();
  double v_period = 0;
};

std::optional<Revolution> RevolutionOf(const Handle(Geom_Surface) & surface) {
  Revolution revolution;
  if (const auto turned = Handle(Geom_SurfaceOfRevolution)::DownCast(surface); !turned.IsNull()) {
    revolution.axis = turned->Axis();
    revolution.meridian = turned->BasisCurve();
    if (surface->IsVPeriodic()) revolution.v_period = surface->VPeriod();
    return revolution;
  }
  const auto elementary = Handle(Geom_ElementarySurface)::DownCast(surface);
  if (elementary.IsNull()) return std::nullopt;
  if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(surface); !cone.IsNull()) {
    const double apex = -cone->RefRadius() / std::sin(cone->SemiAngle());
    (cone->SemiAngle() > 0 ? revolution.v_least : revolution.v_most) = apex;
  } else if (!Handle(Geom_SphericalSurface)::DownCast(surface).IsNull()) {
    revolution.v_least = -kPi / 2;
    revolution.v_most = kPi / 2;
  } else if (!Handle(Geom_ToroidalSurface)::DownCast(surface).IsNull()) {
    revolution.v_period = 2 * kPi;
  } else {
    return std::nullopt;
  }
  const gp_Ax3& position = elementary->Position();
  revolution.axis = position.Axis();
  revolution.way = position.Direct() ? 1 : -1;
  revolution.meridian = surface->UIso(0);
  return revolution;
}

class SurfaceStretcher {
 public:
  SurfaceStretcher(const Eigen::Vector3d& factors, const ParameterRange& range)
      : factors_(factors), range_(range) {}

  std::optional<StretchedSurface> Surface(const Handle(Geom_Surface) & drawn) const {
    if (const auto plane = Handle(Geom_Plane)::DownCast(drawn); !plane.IsNull()) {
      return Plane(plane->Position());
    }
    if (const auto cylinder = Handle(Geom_CylindricalSurface)::DownCast(drawn);
        !cylinder.IsNull()) {
      return Cylinder(cylinder->Position(), cylinder->Radius());
    }
    if (const auto swept = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(drawn);
        !swept.IsNull()) {
      return Swept(swept->BasisCurve(), swept->Direction().XYZ());
    }
    if (const auto revolution = RevolutionOf(drawn)) return Turned(drawn, *revolution);
    if (const auto bezier = Handle(Geom_BezierSurface)::DownCast(drawn); !bezier.IsNull()) {
      return Spline(GeomConvert::SurfaceToBSplineSurface(bezier));
    }
    if (const auto spline = Handle(Geom_BSplineSurface)::DownCast(drawn); !spline.IsNull()) {
      return Spline(Handle(Geom_BSplineSurface)::DownCast(spline->Copy()));
    }
    return std::nullopt;
  }

 private:
  gp_XYZ To(const gp_XYZ& p) const { return Stretched(p, factors_); }

  // Whether what is round about it stays round.
  bool IsRoundAbout(const gp_Dir& direction) const {
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      if (std::hypot(direction.Coord(next + 1), direction.Coord(last + 1)) > kParallel) continue;
      return std::abs(factors_[next] - factors_[last]) <= kSame * factors_[next];
    }
    return false;
  }

  // How much what lies at right angles to the direction, or along it, grows.
  double Across(const gp_Dir& direction) const {
    Eigen::Index axis = 0;
    ToEigen(direction.XYZ()).cwiseAbs().maxCoeff(&axis);
    return factors_[(axis + 1) % 3];
  }
  double Along(const gp_Dir& direction) const { return To(direction.XYZ()).Modulus(); }

  StretchedSurface Plane(const gp_Ax3& position) const {
    const gp_XYZ n = position.Direction().XYZ();
    const gp_Dir normal(n.X() / factors_[0], n.Y() / factors_[1], n.Z() / factors_[2]);
    gp_Ax3 moved(gp_Pnt(To(position.Location().XYZ())), normal,
                 gp_Dir(To(position.XDirection().XYZ())));
    if (!position.Direct()) moved.YReverse();
    return {new Geom_Plane(moved), {}, {}};
  }

  std::optional<StretchedSurface> Cylinder(gp_Ax3 position, double radius) const {
    const gp_Dir& axis = position.Direction();
    if (!IsRoundAbout(axis)) {
      const gp_Dir normal = position.Direct() ? axis : axis.Reversed();
      const gp_Ax2 section(position.Location(), normal, position.XDirection());
      return Swept(new Geom_Circle(section, radius), axis.XYZ());
    }
    position.SetLocation(gp_Pnt(To(position.Location().XYZ())));
    return StretchedSurface{
        new Geom_CylindricalSurface(position, Across(axis) * radius), {}, {Along(axis), 0, {}}};
  }

  std::optional<StretchedSurface> Swept(const Handle(Geom_Curve) & section,
                                        const gp_XYZ& direction) const {
    const auto curve = StretchCurve(section, factors_);
    if (!curve) return std::nullopt;
    const gp_XYZ along = To(direction);
    return StretchedSurface{new Geom_SurfaceOfLinearExtrusion(curve->curve, gp_Dir(along)),
                            {curve->scale, curve->shift, {}},
                            {along.Modulus(), 0, {}}};
  }

  std::optional<StretchedSurface> Turned(const Handle(Geom_Surface) & drawn,
                                         const Revolution& revolution) const {
    const gp_Dir& axis = revolution.axis.Direction();
    if (!IsRoundAbout(axis)) return AsSpline(revolution);
    if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(drawn); !cone.IsNull()) {
      return Cone(cone->Position(), cone->RefRadius(), cone->SemiAngle());
    }
    // What meets its axis, as a ball does, the kernel does not bear turned from a circle.
    const bool is_ball = !Handle(Geom_SphericalSurface)::DownCast(drawn).IsNull();
    const auto meridian = StretchCurve(revolution.meridian, factors_);
    if (is_ball || !meridian) return AsSpline(revolution);
    const gp_Ax1 moved(gp_Pnt(To(revolution.axis.Location().XYZ())),
                       revolution.way > 0 ? axis : axis.Reversed());
    return StretchedSurface{new Geom_SurfaceOfRevolution(meridian->curve, moved),
                            {},
                            {meridian->scale, meridian->shift, {}}};
  }

  StretchedSurface Cone(gp_Ax3 position, double radius, double angle) const {
    const double across = Across(position.Direction());
    const double out = across * std::sin(angle);
    const double along = Along(position.Direction()) * std::cos(angle);
    position.SetLocation(gp_Pnt(To(position.Location().XYZ())));
    return {new Geom_ConicalSurface(position, std::atan2(out, along), across * radius),
            {},
            {std::hypot(out, along), 0, {}}};
  }

  // The rational splines of a meridian, each of whose poles goes round the axis in arcs.
  std::optional<StretchedSurface> AsSpline(const Revolution& revolution) const {
    ParameterRange range = range_;
    const double endless = std::numeric_limits<double>::infinity();
    AddMargin(range.u_minimum, range.u_maximum, -endless, endless, 2 * kPi);
    AddMargin(range.v_minimum, range.v_maximum, revolution.v_least, revolution.v_most,
              revolution.v_period);
    const auto meridian = RationalOf(revolution.meridian, range.v_minimum, range.v_maximum);
    if (!meridian) return std::nullopt;
    const Eigen::Vector3d foot = ToEigen(revolution.axis.Location().XYZ());
    const Eigen::Vector3d axis = revolution.way * ToEigen(revolution.axis.Direction().XYZ());
    RationalCurve around;
    const auto columns = static_cast<int>(meridian->poles.cols());
    TColgp_Array2OfPnt poles;
    TColStd_Array2OfReal weights;
    for (int j = 0; j < columns; ++j) {
      const double weight = meridian->poles(3, j);
      const Eigen::Vector3d away = meridian->poles.col(j).head<3>() / weight - foot;
      const Eigen::Vector3d along = axis.dot(away) * axis;
      around = Arcs(foot + along, away - along, axis.cross(away), range.u_minimum, range.u_maximum);
      const auto rows = static_cast<int>(around.poles.cols());
      if (j == 0) {
        poles.Resize(1, rows, 1, columns, Standard_False);
        weights.Resize(1, rows, 1, columns, Standard_False);
      }
      for (int i = 0; i < rows; ++i) {
        const Eigen::Vector3d place =
            factors_.cwiseProduct(around.poles.col(i).head<3>() / around.poles(3, i));
        poles.SetValue(i + 1, j + 1, gp_Pnt(place.x(), place.y(), place.z()));
        weights.SetValue(i + 1, j + 1, weight * around.poles(3, i));
      }
    }
    return StretchedSurface{
        new Geom_BSplineSurface(poles, weights, KnotsOf(around), KnotsOf(*meridian),
                                MultiplicitiesOf(around), MultiplicitiesOf(*meridian),
                                around.degree, meridian->degree),
        around.map, meridian->map};
  }

  std::optional<StretchedSurface> Spline(const Handle(Geom_BSplineSurface) & spline) const {
    for (int i = 1; i <= spline->NbUPoles(); ++i) {
      for (int j = 1; j <= spline->NbVPoles(); ++j) {
        spline->SetPole(i, j, gp_Pnt(To(spline->Pole(i, j).XYZ())));
      }
    }
    return StretchedSurface{Handle(Geom_Surface)(spline), {}, {}};
  }

  const Eigen::Vector3d factors_;
  const ParameterRange range_;
};

}  // namespace

double ParameterMap::At(double parameter) const {
  if (IsLinear()) return scale * parameter + shift;
  auto end = std::upper_bound(knots.begin(), knots.end(), parameter);
  end = std::clamp(end, knots.begin() + 1, knots.end() - 1);
  const double from = *(end - 1), half = (*end - from) / 2;
  return from + half * (1 + std::tan((parameter - from - half) / 2) / std::tan(half / 2));
}

std::optional<StretchedSurface> StretchSurface(const Handle(Geom_Surface) & drawn,
                                               const Eigen::Vector3d& factors,
                                               const ParameterRange& range) {
  return SurfaceStretcher(factors, range).Surface(Untrimmed(drawn));
}

}  // namespace mortise::cad
