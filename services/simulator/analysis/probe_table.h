// Writes values at chosen places as a table.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

struct Probe;

// The values known at the nodes; an empty field leaves its columns empty.
struct ProbedFields {
  Eigen::Matrix3Xd displacement;                    // 3 × nodes, m
  Eigen::Matrix<double, 6, Eigen::Dynamic> stress;  // 6 × nodes, Pa
  Eigen::VectorXd von_mises, maximum_principal;     // nodes, Pa
  Eigen::VectorXd temperature;                      // nodes
};

// A CSV table of one row for each place and each case that Add was called for.
class ProbeTable {
 public:
  // Finds the elements that the points lie in. INVALID_ARGUMENT naming "probes[i].points[k]" for
  // one that lies outside of the body by more than a twentieth of an element.
  // `node_numbers`: what nodes are called in the table.
  static absl::StatusOr<ProbeTable> Create(const mesh::TetrahedralMesh& mesh,
                                           const std::vector<Probe>& probes,
                                           const std::vector<std::int64_t>& node_numbers);

  // Displacements, stresses and temperatures at a point are those of the element's shape functions;
  // von Mises and principal stress are of that stress.
  void Add(const std::string& case_name, const ProbedFields& fields);

  std::size_t size() const { return places_.size(); }  // places
  const std::string& csv() const { return csv_; }

 private:
  struct Place {
    std::string probe;    // as CSV
    std::int64_t number;  // of the node, or of the point in the probe, from 1
    bool is_node;
    Eigen::Vector3d position;
    Eigen::VectorXi nodes;   // that the value is made of
    Eigen::VectorXd shares;  // how much of each
  };

  std::vector<Place> places_;
  std::string csv_;
};

}  // namespace mortise::simulator
