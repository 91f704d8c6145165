// Fits splines to curves in the parameters of a surface. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <Eigen/Core>
#include <Geom2d_BSplineCurve.hxx>
#include <functional>
#include <vector>

namespace mortise::cad {

// The spline that goes as `curve` does, with the same parameter, and misses it by no more than
// `tolerance` > 0, unless that takes more than some thousand pieces. breaks: its ends and where it
// is not smooth, rising; at least two.
//
// Its pieces, of degree 9, interpolate the curve at Chebyshev points, which converges exponentially
// where the curve is smooth (L. N. Trefethen: Approximation Theory and Approximation Practice,
// 2013, ch. 8). A piece that misses by more is halved.
Handle(Geom2d_BSplineCurve) FitCurve(const std::function<Eigen::Vector2d(double)>& curve,
                                     const std::vector<double>& breaks, double tolerance);

}  // namespace mortise::cad
