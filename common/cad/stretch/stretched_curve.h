// Stretches curves by different factors along the axes. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <Eigen/Core>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <gp_XYZ.hxx>
#include <optional>

namespace mortise::cad {

// A curve whose point at `scale` t + `shift` is that of the drawn one at t, stretched.
struct StretchedCurve {
  Handle(Geom_Curve) curve;
  double scale = 1;
  double shift = 0;
};

// Returns factors ∘ p.
gp_XYZ Stretched(const gp_XYZ& p, const Eigen::Vector3d& factors);

// Return a curve, in space or in parameters, or a surface without the limits that are set to it.
template <class Curve, class Trimmed>
Handle(Curve) Untrimmed(Handle(Curve) curve) {
  for (;;) {
    const auto trimmed = Handle(Trimmed)::DownCast(curve);
    if (trimmed.IsNull()) return curve;
    curve = trimmed->BasisCurve();
  }
}
Handle(Geom_Surface) Untrimmed(Handle(Geom_Surface) surface);

// Stretches a curve exactly: lines, circles, ellipses, parabolas and hyperbolas, wherever they lie,
// stay lines and conics, and splines stay splines. Returns nothing for other curves. `factors` > 0.
std::optional<StretchedCurve> StretchCurve(const Handle(Geom_Curve) & drawn,
                                           const Eigen::Vector3d& factors);

}  // namespace mortise::cad
