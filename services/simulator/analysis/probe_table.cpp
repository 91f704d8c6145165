#include "services/simulator/analysis/probe_table.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/text_escapes.h"
#include "common/fem/elements/material.h"
#include "common/fem/elements/point_location.h"
#include "common/fem/elements/shape_functions.h"
#include "services/simulator/analysis/mesh_analysis.h"

namespace mortise::simulator {

absl::StatusOr<ProbeTable> ProbeTable::Create(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Probe>& probes,
                                              const std::vector<std::int64_t>& node_numbers) {
  ProbeTable table;
  table.csv_ =
      "probe,kind,number,case,x (m),y (m),z (m),ux (m),uy (m),uz (m),sxx (Pa),syy (Pa),szz (Pa),"
      "sxy (Pa),syz (Pa),sxz (Pa),von Mises (Pa),max principal (Pa),temperature\n";
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const Probe& probe = probes[i];
    const std::vector<LocatedPoint> found = LocatePoints(mesh, probe.points);
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (found[k].element < 0) {
        return InvalidField(absl::StrCat("probes[", i, "].points[", k, "]"),
                            "lies outside of the body");
      }
      table.places_.push_back(
          {CsvField(probe.name), static_cast<std::int64_t>(k) + 1, false, probe.points[k],
           mesh.tetrahedra.col(found[k].element),
           TetrahedronShape(found[k].barycentric, static_cast<int>(mesh.tetrahedra.rows()))});
    }
    for (const int node : probe.nodes) {
      table.places_.push_back({CsvField(probe.name), node_numbers[node], true, mesh.nodes.col(node),
                               Eigen::VectorXi::Constant(1, node), Eigen::VectorXd::Ones(1)});
    }
  }
  return table;
}

void ProbeTable::Add(const std::string& case_name, const ProbedFields& fields) {
  const std::string name = CsvField(case_name);
  const auto write = [&](double value) { absl::StrAppendFormat(&csv_, ",%.9g", value); };
  for (const Place& place : places_) {
    absl::StrAppend(&csv_, place.probe, place.is_node ? ",node," : ",point,", place.number, ",",
                    name);
    for (const double x : place.position) absl::StrAppendFormat(&csv_, ",%.12g", x);
    const auto at = [&](const auto& field) {
      Eigen::VectorXd value = Eigen::VectorXd::Zero(field.rows());
      for (Eigen::Index k = 0; k < place.nodes.size(); ++k) {
        value += place.shares[k] * field.col(place.nodes[k]);
      }
      return value;
    };
    if (fields.displacement.size() == 0) {
      csv_ += ",,,";
    } else {
      for (const double u : at(fields.displacement)) write(u);
    }
    if (fields.stress.size() == 0) {
      csv_ += ",,,,,,,,";
    } else {
      const Vector6d stress = at(fields.stress);
      for (const double s : stress) write(s);
      // At nodes of several parts, those of the part that is most under stress.
      write(place.is_node ? fields.von_mises[place.nodes[0]] : VonMises(stress));
      write(place.is_node ? fields.maximum_principal[place.nodes[0]] : MaximumPrincipal(stress));
    }
    if (fields.temperature.size() == 0) {
      csv_ += ",";
    } else {
      write(at(fields.temperature.transpose())[0]);
    }
    csv_ += "\n";
  }
}

}  // namespace mortise::simulator
