#include "services/simulator/probe_table.h"

#include <Eigen/LU>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "services/simulator/mesh_analysis.h"
#include "services/simulator/shape_functions.h"

namespace mortise::simulator {
namespace {

// How far outside of an element's corners a point still counts as in it: curved sides bulge.
constexpr double kOutside = -0.05;

std::string Quoted(const std::string& text) {
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

// The element that a point is deepest in, and its barycentric coordinates there.
struct Found {
  Eigen::Index element = -1;
  Eigen::Vector4d barycentric = Eigen::Vector4d::Zero();
};

std::vector<Found> FindElements(const mesh::TetrahedralMesh& mesh,
                                const std::vector<Eigen::Vector3d>& points) {
  std::vector<Found> found(points.size());
  std::vector<double> depth(points.size(), kOutside);
  for (Eigen::Index e = 0; !points.empty() && e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = positions.col(k + 1) - positions.col(0);
    const Eigen::Matrix3d inverse = edges.inverse();
    for (std::size_t i = 0; i < points.size(); ++i) {
      Eigen::Vector4d l;
      l.tail<3>() = inverse * (points[i] - positions.col(0));
      l[0] = 1 - l.tail<3>().sum();
      if (!(l.minCoeff() > depth[i])) continue;
      depth[i] = l.minCoeff();
      found[i] = {e, l};
    }
  }
  return found;
}

}  // namespace

absl::StatusOr<ProbeTable> ProbeTable::Create(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Probe>& probes,
                                              const std::vector<std::int64_t>& node_numbers) {
  ProbeTable table;
  table.csv_ =
      "probe,kind,number,case,x (m),y (m),z (m),ux (m),uy (m),uz (m),sxx (Pa),syy (Pa),szz (Pa),"
      "sxy (Pa),syz (Pa),sxz (Pa),von Mises (Pa),max principal (Pa),temperature\n";
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const Probe& probe = probes[i];
    const std::vector<Found> found = FindElements(mesh, probe.points);
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (found[k].element < 0) {
        return InvalidField(absl::StrCat("probes[", i, "].points[", k, "]"),
                            "lies outside of the body");
      }
      table.places_.push_back(
          {Quoted(probe.name), static_cast<std::int64_t>(k) + 1, false, probe.points[k],
           mesh.tetrahedra.col(found[k].element),
           TetrahedronShape(found[k].barycentric, static_cast<int>(mesh.tetrahedra.rows()))});
    }
    for (const int node : probe.nodes) {
      table.places_.push_back({Quoted(probe.name), node_numbers[node], true, mesh.nodes.col(node),
                               Eigen::VectorXi::Constant(1, node), Eigen::VectorXd::Ones(1)});
    }
  }
  return table;
}

void ProbeTable::Add(const std::string& case_name, const ProbedFields& fields) {
  const std::string name = Quoted(case_name);
  for (const Place& place : places_) {
    absl::StrAppend(&csv_, place.probe, place.is_node ? ",node," : ",point,", place.number, ",",
                    name);
    for (const double x : place.position) absl::StrAppendFormat(&csv_, ",%.12g", x);
    const auto add = [&](const auto& field, Eigen::Index rows) {
      for (Eigen::Index r = 0; r < rows; ++r) {
        if (field.size() == 0) {
          csv_ += ",";
          continue;
        }
        double value = 0;
        for (Eigen::Index k = 0; k < place.nodes.size(); ++k) {
          value += place.shares[k] * field(r, place.nodes[k]);
        }
        absl::StrAppendFormat(&csv_, ",%.9g", value);
      }
    };
    add(fields.displacement, 3);
    add(fields.stress, 6);
    add(fields.von_mises.transpose(), 1);
    add(fields.maximum_principal.transpose(), 1);
    add(fields.temperature.transpose(), 1);
    csv_ += "\n";
  }
}

}  // namespace mortise::simulator
