// Problems whose answers are published or known exactly, for the accuracy test and its bench.
//
// `n` sets the fineness of a mesh of mapped boxes; the number of elements grows with n³. Meshes are
// graded towards where the answer is read, by the same rule at every fineness.
#pragma once

#include <Eigen/Core>
#include <string>

namespace mortise::simulator {

// An answer beside what it should be.
struct TargetAnswer {
  std::string what;
  double target = 0;
  double value = 0;
  int elements = 0;
  int unknowns = 0;
  double seconds = 0;  // without making the mesh

  double error() const { return value / target - 1; }
};

// NAFEMS LE10 (The Standard NAFEMS Benchmarks, TNSB rev. 3, 1990): a quarter of a thick plate
// between the ellipses (x/2)² + y² = 1 and (x/3.25)² + (y/2.75)² = 1, 0 <= z <= 0.6 m, E = 210 GPa,
// ν = 0.3, pressed by 1 MPa on z = 0.6. Symmetry on x = 0 and y = 0; on the outer ellipse u = v =
// 0, and w = 0 along its middle z = 0.3. Target: σyy = −5.38 MPa at D (2, 0, 0.6). 36 n³ elements.
TargetAnswer ThickPlate(int n, bool quadratic);

// The traction on a plane of this normal at x, m, round a circular hole about z in a plate pulled
// along x by `pull`, Pa, at infinity, by Kirsch's solution (1898; Timoshenko and Goodier, Theory of
// Elasticity, §35).
Eigen::Vector3d KirschTraction(double radius, double pull, const Eigen::Vector3d& x,
                               const Eigen::Vector3d& normal);

// A plate with a circular hole of radius 1 m in plane strain, pulled along x by 1 MPa at infinity:
// a quarter of the square |x|, |y| <= 4 m, 0.1 m thick, with the exact tractions of Kirsch's
// solution (1898; Timoshenko and Goodier, Theory of Elasticity, §35) on its outer sides, symmetry
// on x = 0, y = 0 and both plane faces. Target: σxx = 3 MPa on the edge of the hole at x = 0, the
// node where it is worst. 864 n³ elements.
TargetAnswer PlateWithHole(int n, bool quadratic);

// Lamé's thick cylinder (Timoshenko and Goodier, §28) in plane strain: a quarter of the ring
// 1 <= r <= 2 m, 0.1 m high, E = 200 GPa, ν = 0.3, 1 MPa inside, symmetry on the plane faces.
// Target: the hoop stress 5/3 MPa at the inside, at the node where it is worst. 576 n³ elements.
TargetAnswer ThickCylinder(int n, bool quadratic);

// The same cylinder's widening at the inside, exact: p a (1 + ν) ((1 − 2ν) a² + b²) / (E (b² −
// a²)).
TargetAnswer ThickCylinderWidening(int n, bool quadratic);

// A cantilever 1 m long, 0.1 m square, E = 210 GPa, ν = 0.3, all displacements zero at x = 0,
// sheared by 1 MPa evenly over x = 1. Target: the mean deflection of the loaded end, by
// Richardson's extrapolation of quadratic meshes graded towards the clamped edges (see the bench,
// which prints it): no closed solution is known, since the clamp holds the section's warping. 48 n³
// elements.
TargetAnswer Cantilever3d(int n, bool quadratic);

// NAFEMS LE11 (same book): a quarter of a hollow body of revolution about z, cylinder, taper and
// sphere, E = 210 GPa, ν = 0.3, α = 2.3e-4 / K, under the temperature √(x² + y²) + z, no loads.
// Symmetry on x = 0, y = 0 and z = 0, and w = 0 on z = 1.79 m. Target: σzz = −105 MPa at A (1, 0,
// 0). 630 n³ elements.
TargetAnswer TaperedSphere(int n, bool quadratic);

// NAFEMS T4 (same book): the rectangle 0 <= x <= 0.6 m, 0 <= y <= 1 m, here 0.05 m thick, k = 52
// W/(m K); 100 °C on y = 0, no heat through x = 0 nor the plane faces, convection of 750 W/(m² K)
// to 0 °C on x = 0.6 and y = 1. Target: 18.25 °C at (0.6, 0.2), the worst node through the
// thickness. 90 n² elements, one cell thick.
TargetAnswer PlateWithConvection(int n, bool quadratic);

// How a plate is held at its four sides. All three are called simply supported.
enum class PlateSupport {
  kHard,   // w and the displacement along the side are zero on the whole side
  kSoft,   // w is zero on the whole side
  kEdges,  // w is zero along the lower edges: the text of the benchmark
};

// NAFEMS FV52 (Selected Benchmarks for Natural Frequency Analysis, 1989): a plate of 10 × 10 × 1 m,
// E = 200 GPa, ν = 0.3, 8000 kg/m³, simply supported. Target: 45.897 Hz, the lowest mode that bends
// it. The target is Mindlin's plate's, whose sides cannot turn about their normals: that is
// PlateSupport::kHard. The softer supports are lower by 2 % and more in every program, since the
// plate is thick and its sides may then twist. 96 n³ elements.
TargetAnswer ThickPlateVibration(int n, bool quadratic, PlateSupport support);

}  // namespace mortise::simulator
