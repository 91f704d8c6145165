// Solids with curved faces on which the stress is known, meshed without any structure, for tests of
// recovered stress and its bench.
#pragma once

#include <Eigen/Core>
#include <TopoDS_Shape.hxx>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid_kernel.h"
#include "common/fem/stress/patch_recovery.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

// A body under load whose stress is read on its rim, along one direction at each node of the face
// "inside", edges included.
struct CurvedBody {
  std::string name;
  DesignModel model;
  double element_size = 0;                                                 // m
  std::function<Eigen::Vector3d(const Eigen::Vector3d& place)> direction;  // of length 1
  std::function<Eigen::Vector3d(const Eigen::Vector3d& place)> normal;     // outward
  std::function<double(const Eigen::Vector3d& place)> stress;              // Pa
  std::function<Eigen::Vector3d(const Eigen::Vector3d& place)> traction;   // Pa, on the rim's face
  double largest = 0;                                                      // Pa, on the rim
  std::array<double, 2> edges{-1, -1};  // m, in z, of the rim's edges with planes; -1: of none
};

// Lamé's thick cylinder, 20 mm inside and 40 mm outside, under 1 MPa inside, in plane strain: a
// quarter of a slice of 4 mm (Timoshenko and Goodier, Theory of Elasticity, §28). Read: hoop
// stress.
CurvedBody PressedRing(double element_size);

// Lamé's hollow ball, 20 mm inside and 40 mm outside, under 1 MPa inside: an eighth (the same,
// §136). Read: the stress along circles of latitude.
CurvedBody PressedBall(double element_size);

// A plate with a hole of 20 mm under the tractions of Kirsch's solution for 1 MPa along x at
// infinity, in plane strain: a quarter of 80 × 80 × 8 mm. Read: the stress round the hole.
CurvedBody PlateWithAHole(double element_size);

// A plate of 80 × 80 × 12 mm with a bore of 18 mm, clamped at one end and pulled by 100 MPa at the
// other. Read: the stress round the bore, which was computed once: a quarter of 25,700 quadratic
// elements, of 0.45 mm at the bore, with the displacements of CalculiX.
CurvedBody BoredPlate(double element_size);

// What CalculiX does: the mean over the elements at each node of what these have there, continued
// linearly from the integration points. `at_points`: from StressAtPoints; 6 × nodes, of one part.
Stresses MeanOfElements(const mesh::TetrahedralMesh& mesh, const Stresses& at_points);

// How far the stress on the rim is off, Pa; over its nodes.
struct RimError {
  double stress = 0;    // root of the mean of squares
  double bias = 0;      // mean
  double at_edges = 0;  // as `stress`, at nodes on the rim's edges only
  double traction = 0;  // likewise of the traction, as a vector
  double largest = 0;   // the largest stress itself
};
struct RimErrors {
  int elements = 0, nodes = 0;  // of the mesh, and those on the rim
  RimError recovered, mean;     // by the simulator, and as the mean of elements
};
// `rim`: its nodes.
RimErrors RimErrorsOf(const CurvedBody& body, const mesh::TetrahedralMesh& mesh,
                      const ElasticitySolution& solution, const std::vector<int>& rim);

// Of the body meshed and solved as designs are.
absl::StatusOr<RimErrors> MeasureRim(const CurvedBody& body, bool quadratic);

// The same with quadratic elements whose sides are straight, as many meshers make them.
absl::StatusOr<RimErrors> MeasureFacetedRim(const CurvedBody& body);

// The solid of a shape whose faces are named by where they are: "x_min" where the outward normal of
// a plane is along -x; "inside" and "outside", of cylinders and balls, by their radius.
cad::Solid NamedSolid(const TopoDS_Shape& shape, double inner_radius);

}  // namespace mortise::simulator
