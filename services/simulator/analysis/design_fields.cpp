#include "services/simulator/analysis/design_fields.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/fields/control_variables.h"
#include "common/mesh/face_edges.h"
#include "services/simulator/analysis/case_outcome.h"
#include "services/simulator/analysis/place_functions.h"

namespace mortise::simulator {
namespace {

constexpr std::size_t kNamesTold = 20;
constexpr double kSamePlace = 1e-5;  // of the spacing of control points

const FieldDescription* FindField(const std::string& name) {
  for (const FieldDescription& field : OfferedFields()) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

// The triangles of a design, of its mesh or of its surface, and the faces they lie on.
struct Faceted {
  const Eigen::VectorXi& triangle_face;
  const std::vector<mesh::AssemblyFace>& faces;
};

// The faces that belong to each region, by its name.
class RegionNames {
 public:
  void Add(const std::string& name, int face) {
    if (name.empty()) return;
    const auto [found, is_new] = numbers_.emplace(name, std::ssize(faces_));
    if (is_new) faces_.emplace_back(name, std::vector<int>());
    std::vector<int>& of = faces_[static_cast<std::size_t>(found->second)].second;
    if (face >= 0 && (of.empty() || of.back() != face)) of.push_back(face);
  }

  bool Has(const std::string& name) const { return numbers_.contains(name); }

  // Name and faces, ascending, in the order in which they were added first.
  const std::vector<std::pair<std::string, std::vector<int>>>& all() const { return faces_; }

 private:
  std::map<std::string, std::ptrdiff_t> numbers_;
  std::vector<std::pair<std::string, std::vector<int>>> faces_;
};

RegionNames NameRegions(const DesignModel& model, const std::vector<mesh::AssemblyFace>& faces) {
  RegionNames regions;
  for (const auto& [condition, face] : model.condition_faces) {
    regions.Add(condition, -1);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const std::vector<mesh::NamedFace>& origins = faces[f].origins;
      if (std::find(origins.begin(), origins.end(), face) == origins.end()) continue;
      regions.Add(condition, static_cast<int>(f));
    }
  }
  const RegionNames conditions = regions;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const mesh::NamedFace& origin : faces[f].origins) {
      if (origin.name.empty()) continue;
      const std::string name = FaceText(model.surface, origin);
      if (!conditions.Has(name)) regions.Add(name, static_cast<int>(f));
    }
  }
  return regions;
}

absl::Status NoRegion(std::size_t index, const std::string& name, const RegionNames& regions) {
  std::vector<std::string> names;
  for (const auto& [known, faces] : regions.all()) names.push_back(known);
  const std::size_t more = names.size() - std::min(names.size(), kNamesTold);
  names.resize(names.size() - more);
  return InvalidField(
      absl::StrCat("design_fields.regions[", index, "]"),
      absl::StrCat("there is no region '", name, "'; there are ", absl::StrJoin(names, ", "),
                   more > 0 ? absl::StrCat(" and ", more, " more") : ""));
}

absl::StatusOr<std::vector<fields::Region>> RegionsOf(const DesignModel& model,
                                                      const Faceted& faceted,
                                                      const std::vector<std::string>& wanted) {
  const RegionNames regions = NameRegions(model, faceted.faces);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (!regions.Has(wanted[i])) return NoRegion(i, wanted[i], regions);
  }
  std::vector<fields::Region> found;
  std::vector<std::vector<std::size_t>> regions_of_face(faceted.faces.size());
  for (const auto& [name, faces] : regions.all()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
    for (const int face : faces) {
      regions_of_face[static_cast<std::size_t>(face)].push_back(found.size());
    }
    found.push_back({name, {}});
  }
  for (Eigen::Index t = 0; t < faceted.triangle_face.size(); ++t) {
    for (const std::size_t r :
         regions_of_face[static_cast<std::size_t>(faceted.triangle_face[t])]) {
      found[r].triangles.push_back(static_cast<int>(t));
    }
  }
  return found;
}

void AddSides(const Faceted& faceted, fields::DesignFields& design) {
  const Eigen::Index count = faceted.triangle_face.size();
  design.triangle_back.resize(count);
  design.triangle_front.resize(count);
  for (Eigen::Index t = 0; t < count; ++t) {
    const auto& face = faceted.faces[static_cast<std::size_t>(faceted.triangle_face[t])];
    design.triangle_back[t] = face.back_part;
    design.triangle_front[t] = face.front_part;
  }
}

void AddField(const FieldDescription& field, const std::string& load_case, Eigen::MatrixXd values,
              fields::DesignFields& design) {
  design.fields.push_back(
      {field.name, field.unit, load_case,
       field.of_elements ? fields::FieldPlace::kElements : fields::FieldPlace::kNodes,
       std::move(values)});
}

Eigen::MatrixXd UnderLoads(const std::string& name, const ElasticitySolution& solution) {
  if (name == "displacement") return solution.displacement;
  if (name == "von_mises") return solution.von_mises.transpose();
  if (name == "stress") return solution.stress;
  if (name == "max_principal") return solution.maximum_principal.transpose();
  return solution.reaction;
}

void AddModes(const FieldDescription& field, const ModalSolution& vibration, int modes,
              fields::DesignFields& design) {
  const auto rigid = static_cast<std::size_t>(vibration.rigid_motions);
  for (int m = 0; m < modes; ++m) {
    const std::size_t index = rigid + static_cast<std::size_t>(m);
    if (index >= vibration.modes.size()) return;
    AddField(field, absl::StrCat("mode ", m + 1), vibration.modes[index].shape, design);
  }
}

// On nodes of the outside, where `design` has triangles that nothing is in front of.
Eigen::MatrixXd PressureOn(const AirflowSolution& airflow, const fields::DesignFields& design) {
  std::vector<Eigen::Index> outer;
  for (Eigen::Index t = 0; t < design.triangles.cols(); ++t) {
    if (design.triangle_front[t] < 0) outer.push_back(t);
  }
  return ValuesAtNodes(airflow.wall, design.nodes, design.triangles(Eigen::all, outer)).transpose();
}

void AddFields(const DesignModel& model, const DesignAnalysis& analysis, const FieldsDemand& demand,
               fields::DesignFields& design) {
  for (const std::string& name : demand.fields) {
    const FieldDescription* const field = FindField(name);
    if (field == nullptr) continue;
    switch (field->source) {
      case FieldSource::kLoads:
        for (const SolvedCase& solved : analysis.cases) {
          AddField(*field, solved.name, UnderLoads(name, solved.solution), design);
        }
        break;
      case FieldSource::kHeat:
        AddField(*field, "",
                 field->of_elements
                     ? Eigen::MatrixXd(ElementHeatFlux(*analysis.mesh, model.analysis.materials,
                                                       analysis.heat->temperature))
                     : Eigen::MatrixXd(analysis.heat->temperature.transpose()),
                 design);
        break;
      case FieldSource::kModes:
        AddModes(*field, *analysis.vibration, demand.modes, design);
        break;
      case FieldSource::kAirflow:
        AddField(*field, "", PressureOn(*analysis.airflow, design), design);
        break;
    }
  }
}

// Leaves out the tetrahedra, and the nodes that no triangle has.
void KeepSurface(fields::DesignFields& design) {
  design.tetrahedra.resize(design.tetrahedra.rows(), 0);
  design.tetrahedron_part.resize(0);
  Eigen::VectorXi number = Eigen::VectorXi::Constant(design.nodes.cols(), -1);
  std::vector<Eigen::Index> kept;
  for (int& node : design.triangles.reshaped()) number[node] = 0;
  for (Eigen::Index v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(kept.size());
    kept.push_back(v);
  }
  for (int& node : design.triangles.reshaped()) node = number[node];
  design.nodes = Eigen::Matrix3Xd(design.nodes(Eigen::all, kept));
  for (fields::Field& field : design.fields) {
    field.values = Eigen::MatrixXd(field.values(Eigen::all, kept));
  }
}

// Finds which points lie at corners of triangles, but for the kernel's tolerance.
void FindNodes(const fields::DesignFields& design, mesh::ControlVariables& variables) {
  std::vector<std::pair<double, int>> corners;  // x, node
  for (const int node : design.triangles.topRows<3>().reshaped()) {
    corners.emplace_back(design.nodes(0, node), node);
  }
  std::sort(corners.begin(), corners.end());
  const double tolerance = kSamePlace * fields::ControlSpacing(design.nodes);
  for (mesh::ControlVariables::Point& point : variables.points) {
    double nearest = tolerance;
    auto corner = std::lower_bound(corners.begin(), corners.end(),
                                   std::pair(point.position.x() - tolerance, -1));
    for (; corner != corners.end() && corner->first <= point.position.x() + tolerance; ++corner) {
      const double distance = (design.nodes.col(corner->second) - point.position).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      point.vertex = corner->second;
    }
  }
}

// Of the solid, or else of the faces that triangles lie on; `design` has its nodes and triangles. A
// design with more of them than can be kept has none, which is no reason to fail.
void AddControlVariables(const DesignModel& model, const Faceted& faceted,
                         fields::DesignFields& design) {
  if (model.control_variables) {
    mesh::ControlVariables variables = *model.control_variables;
    FindNodes(design, variables);
    fields::SetControlVariables(variables, design);
    return;
  }
  const auto variables = mesh::FindControlVariables(
      mesh::OuterFaces(design.nodes, design.triangles, faceted.triangle_face, faceted.faces,
                       design.parts),
      fields::ControlSpacing(design.nodes));
  if (variables.ok()) fields::SetControlVariables(*variables, design);
}

absl::Status CheckOnSurface(const FieldsDemand& demand) {
  for (std::size_t i = 0; i < demand.fields.size(); ++i) {
    const FieldDescription* const field = FindField(demand.fields[i]);
    if (field == nullptr || !field->of_elements) continue;
    return InvalidField(absl::StrCat("design_fields.fields[", i, "]"),
                        absl::StrCat(field->name, " is of tetrahedra: ask for them as geometry"));
  }
  return absl::OkStatus();
}

}  // namespace

const std::vector<FieldDescription>& OfferedFields() {
  static const std::vector<FieldDescription> fields = {
      {"displacement", "m", 3, false, FieldSource::kLoads, "Displacement under a load case."},
      {"von_mises", "Pa", 1, false, FieldSource::kLoads,
       "Von Mises stress; where parts meet, the largest of them."},
      {"stress", "Pa", 6, false, FieldSource::kLoads, "Stress: xx, yy, zz, xy, yz, xz."},
      {"max_principal", "Pa", 1, false, FieldSource::kLoads, "Largest principal stress."},
      {"reaction", "N", 3, false, FieldSource::kLoads, "Force that a support puts on a node."},
      {"temperature", "K", 1, false, FieldSource::kHeat, "Steady temperature."},
      {"heat_flux", "W/m^2", 3, true, FieldSource::kHeat, "Heat flux, mean over an element."},
      {"mode_shape", "1", 3, false, FieldSource::kModes,
       "Displacement of a natural mode whose modal mass is 1 kg; its sign is arbitrary."},
      {"air_pressure", "Pa", 1, false, FieldSource::kAirflow,
       "Pressure of the air on the outside, above that of the oncoming air; 0 within."}};
  return fields;
}

void DemandFields(const FieldsDemand& demand, DesignAnalysisOptions& options) {
  options.with_mesh = demand.tetrahedra;
  options.besides.surface = true;
  for (const std::string& name : demand.fields) {
    const FieldDescription* const field = FindField(name);
    if (field == nullptr) continue;
    options.besides.loads = options.besides.loads || field->source == FieldSource::kLoads;
    options.besides.heat = options.besides.heat || field->source == FieldSource::kHeat;
    if (field->source == FieldSource::kAirflow) {
      options.besides.airflow = true;
      options.with_mesh = true;  // the surface as it was joined may have no nodes within a face
    }
    if (field->source != FieldSource::kModes) continue;
    options.besides.modes = true;
    options.modes = std::max(options.modes, demand.modes);
  }
}

absl::StatusOr<fields::DesignFields> CollectFields(const DesignModel& model,
                                                   const DesignAnalysis& analysis,
                                                   const FieldsDemand& demand) {
  if (!demand.tetrahedra) MORTISE_RETURN_IF_ERROR(CheckOnSurface(demand));
  fields::DesignFields design;
  const mesh::AssemblySurface& surface = model.surface;
  const bool has_mesh = analysis.mesh.has_value();
  const Faceted faceted = has_mesh
                              ? Faceted{analysis.mesh->face_triangle_face, analysis.mesh->faces}
                              : Faceted{surface.triangle_face, surface.faces};
  if (has_mesh) {
    design.nodes = analysis.mesh->nodes;
    design.tetrahedra = analysis.mesh->tetrahedra;
    design.tetrahedron_part = analysis.mesh->part;
    design.triangles = analysis.mesh->face_triangles;
  } else {
    design.nodes = surface.vertices;
    design.triangles = surface.triangles;
  }
  design.parts = surface.part_names;
  AddSides(faceted, design);
  MORTISE_ASSIGN_OR_RETURN(design.regions, RegionsOf(model, faceted, demand.regions));
  AddFields(model, analysis, demand, design);
  if (!demand.tetrahedra) KeepSurface(design);
  AddControlVariables(model, faceted, design);
  return design;
}

}  // namespace mortise::simulator
