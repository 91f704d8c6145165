// A linear map takes a conic to a conic: where two conjugate diameters of the one go, there are two
// of the other. Its own axes are found by moving along it, so that its parameter only shifts.
#include "common/cad/stretch/stretched_curve.h"

#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Lin.hxx>
#include <numbers>

namespace mortise::cad {
namespace {

constexpr double kRound = 1e-9;    // relative difference of an ellipse's radii that makes none
constexpr double kNoTurn = 1e-12;  // rad

// center + p cos t + q sin t.
StretchedCurve EllipseThrough(const gp_XYZ& center, const gp_XYZ& p, const gp_XYZ& q) {
  const gp_Dir normal(p.Crossed(q));
  const double same = kRound * p.SquareModulus();
  if (std::abs(p.SquareModulus() - q.SquareModulus()) <= same && std::abs(p.Dot(q)) <= same) {
    return {new Geom_Circle(gp_Ax2(gp_Pnt(center), normal, gp_Dir(p)), p.Modulus()), 1, 0};
  }
  double to_longest = std::atan2(2 * p.Dot(q), p.SquareModulus() - q.SquareModulus()) / 2;
  // Forwards: the kernel mistakes the direction of closed ellipses that begin before their own
  // parameter 0.
  if (to_longest > kNoTurn) to_longest -= std::numbers::pi;
  to_longest = std::min(to_longest, 0.0);
  const double c = std::cos(to_longest), s = std::sin(to_longest);
  const gp_XYZ longest = p * c + q * s, shortest = q * c - p * s;
  return {new Geom_Ellipse(gp_Ax2(gp_Pnt(center), normal, gp_Dir(longest)), longest.Modulus(),
                           shortest.Modulus()),
          1, -to_longest};
}

// center + p cosh t + q sinh t.
StretchedCurve HyperbolaThrough(const gp_XYZ& center, const gp_XYZ& p, const gp_XYZ& q) {
  const double to_vertex = -std::atanh(2 * p.Dot(q) / (p.SquareModulus() + q.SquareModulus())) / 2;
  const double c = std::cosh(to_vertex), s = std::sinh(to_vertex);
  const gp_XYZ major = p * c + q * s, minor = p * s + q * c;
  return {new Geom_Hyperbola(gp_Ax2(gp_Pnt(center), gp_Dir(major.Crossed(minor)), gp_Dir(major)),
                             major.Modulus(), minor.Modulus()),
          1, -to_vertex};
}

// apex + a t² + b t.
StretchedCurve ParabolaThrough(const gp_XYZ& apex, const gp_XYZ& a, const gp_XYZ& b) {
  const double to_vertex = -a.Dot(b) / (2 * a.SquareModulus());
  const gp_XYZ across = b + a * (2 * to_vertex);
  const gp_XYZ vertex = apex + a * (to_vertex * to_vertex) + b * to_vertex;
  const double scale = across.Modulus();
  return {new Geom_Parabola(gp_Ax2(gp_Pnt(vertex), gp_Dir(a.Crossed(across)), gp_Dir(a)),
                            scale * scale / (4 * a.Modulus())),
          scale, -to_vertex* scale};
}

}  // namespace

gp_XYZ Stretched(const gp_XYZ& p, const Eigen::Vector3d& factors) {
  return {factors[0] * p.X(), factors[1] * p.Y(), factors[2] * p.Z()};
}

Handle(Geom_Surface) Untrimmed(Handle(Geom_Surface) surface) {
  for (;;) {
    const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
    if (trimmed.IsNull()) return surface;
    surface = trimmed->BasisSurface();
  }
}

std::optional<StretchedCurve> StretchCurve(const Handle(Geom_Curve) & drawn,
                                           const Eigen::Vector3d& factors) {
  auto basis = Untrimmed<Geom_Curve, Geom_TrimmedCurve>(drawn);
  const auto to = [&](const gp_XYZ& p) { return Stretched(p, factors); };
  if (const auto line = Handle(Geom_Line)::DownCast(basis); !line.IsNull()) {
    const gp_XYZ direction = to(line->Lin().Direction().XYZ());
    return StretchedCurve{
        new Geom_Line(gp_Pnt(to(line->Lin().Location().XYZ())), gp_Dir(direction)),
        direction.Modulus(), 0};
  }
  if (const auto conic = Handle(Geom_Conic)::DownCast(basis); !conic.IsNull()) {
    const gp_XYZ center = to(conic->Location().XYZ());
    const gp_XYZ x = to(conic->XAxis().Direction().XYZ()), y = to(conic->YAxis().Direction().XYZ());
    if (const auto circle = Handle(Geom_Circle)::DownCast(basis); !circle.IsNull()) {
      return EllipseThrough(center, x * circle->Radius(), y * circle->Radius());
    }
    if (const auto ellipse = Handle(Geom_Ellipse)::DownCast(basis); !ellipse.IsNull()) {
      return EllipseThrough(center, x * ellipse->MajorRadius(), y * ellipse->MinorRadius());
    }
    if (const auto hyperbola = Handle(Geom_Hyperbola)::DownCast(basis); !hyperbola.IsNull()) {
      return HyperbolaThrough(center, x * hyperbola->MajorRadius(), y * hyperbola->MinorRadius());
    }
    if (const auto parabola = Handle(Geom_Parabola)::DownCast(basis); !parabola.IsNull()) {
      return ParabolaThrough(center, x / (4 * parabola->Focal()), y);
    }
    return std::nullopt;
  }
  if (!Handle(Geom_BezierCurve)::DownCast(basis).IsNull()) {
    basis = GeomConvert::CurveToBSplineCurve(basis);
  }
  if (const auto spline = Handle(Geom_BSplineCurve)::DownCast(basis); !spline.IsNull()) {
    const auto stretched = Handle(Geom_BSplineCurve)::DownCast(spline->Copy());
    for (int i = 1; i <= stretched->NbPoles(); ++i) {
      stretched->SetPole(i, gp_Pnt(to(stretched->Pole(i).XYZ())));
    }
    return StretchedCurve{Handle(Geom_Curve)(stretched)};
  }
  return std::nullopt;
}

}  // namespace mortise::cad
