// Writes an analysis as files people open: fields for ParaView, a picture of the stress.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/fem/problems/elasticity.h"
#include "common/fem/problems/modal_analysis.h"
#include "common/mesh/files/vtu_writer.h"
#include "services/simulator/airflow/airflow.h"

namespace mortise::simulator {

// A file that belongs to an analysis.
struct AnalysisFile {
  std::string name;        // "stress.png"
  std::string media_type;  // "image/png"
  std::string bytes;
};

// Returns the shapes of vibration as fields, each with its number and frequency in its name.
std::vector<mesh::VtuField> ShapeFields(const ModalSolution& vibration);

struct StressPictureOptions {
  int width = 1200;                  // pixels
  int height = 800;                  // pixels
  double visible_deflection = 0.05;  // exaggeration: the largest displacement, drawn, as a share of
                                     // the design's size
};

// Returns a PNG: the deformed shape, exaggerated, coloured by von Mises stress, over the outline of
// the undeformed one. The scale ends at the 99.5th percentile, since a few nodes at sharp corners
// would otherwise darken all the rest; the footnote gives the true maximum.
absl::StatusOr<std::string> DrawStress(const mesh::TetrahedralMesh& volume,
                                       const ElasticitySolution& solution, const std::string& title,
                                       const StressPictureOptions& options = {});

// Returns a PNG of a shape of vibration, exaggerated, coloured by how far each point moves as a
// share of what moves farthest, over the outline at rest.
absl::StatusOr<std::string> DrawMode(const mesh::TetrahedralMesh& volume, const Mode& mode,
                                     const std::string& title,
                                     const StressPictureOptions& options = {});

// Returns a PNG of the shape coloured by temperature (nodes, °C or K).
absl::StatusOr<std::string> DrawTemperature(const mesh::TetrahedralMesh& volume,
                                            const Eigen::VectorXd& temperature,
                                            const std::string& title,
                                            const StressPictureOptions& options = {});

// Returns a PNG of the outside coloured by the pressure of the air, with an arrow along the wind.
// The scale leaves out the extreme 0.5 % at either end; the footnote gives the true extremes.
absl::StatusOr<std::string> DrawAirPressure(const AirflowSolution& airflow,
                                            const Eigen::Vector3d& wind, const std::string& title,
                                            const StressPictureOptions& options = {});

}  // namespace mortise::simulator
