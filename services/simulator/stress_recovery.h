// Stresses at nodes from displacements.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/simulator/analysis_case.h"

namespace mortise::simulator {

struct NodalStress {
  Eigen::Matrix<double, 6, Eigen::Dynamic> stress;  // 6 × nodes, Pa: xx yy zz xy yz xz
  Eigen::VectorXd von_mises;                        // nodes, Pa
  Eigen::VectorXd part_maximum;                     // parts, Pa: largest von Mises stress of each
};

// Stress is computed where it is most accurate (the integration points), carried linearly to the
// nodes and averaged there, weighted by volume, over the elements of each part by itself: across a
// joint stress may jump. Where parts meet, `stress` is that of the part under the larger von Mises
// stress.
NodalStress RecoverStress(const mesh::TetrahedralMesh& mesh, const std::vector<Material>& materials,
                          const Eigen::Matrix3Xd& displacement);

}  // namespace mortise::simulator
