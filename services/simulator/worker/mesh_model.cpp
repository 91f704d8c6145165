#include "services/simulator/worker/mesh_model.h"

#include <google/protobuf/util/json_util.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/fem/elements/shape_functions.h"
#include "common/mesh/files/grouped_mesh.h"
#include "common/mesh/length_unit.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/analysis/mesh_groups.h"
#include "services/simulator/worker/analysis_codec.h"
#include "services/simulator/worker/mesh_case.h"

namespace mortise::simulator {
namespace {

using Texts = google::protobuf::RepeatedPtrField<std::string>;

std::vector<std::string> Names(const Texts& groups) { return {groups.begin(), groups.end()}; }

// Of a Vector3 or a LoadVector.
template <typename Vector>
Eigen::Vector3d FromProto(const Vector& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Eigen::Vector3d Three(const google::protobuf::RepeatedField<double>& values) {
  return values.size() == 3 ? Eigen::Vector3d(values[0], values[1], values[2])
                            : Eigen::Vector3d::Zero();
}

Material MakeMaterial(const v1::MeshMaterial& use, const std::string& name) {
  const v1::MaterialValues& values = use.values();
  Material material{name,
                    values.density(),
                    values.youngs_modulus(),
                    values.poissons_ratio(),
                    values.strength(),
                    values.thermal_expansion(),
                    values.thermal_conductivity()};
  if (!values.has_orthotropic()) return material;
  Orthotropy& orthotropy = material.orthotropy.emplace();
  orthotropy.youngs_modulus = Three(values.orthotropic().youngs_modulus());
  orthotropy.poissons_ratio = Three(values.orthotropic().poissons_ratio());
  orthotropy.shear_modulus = Three(values.orthotropic().shear_modulus());
  orthotropy.thermal_expansion = Three(values.orthotropic().thermal_expansion());
  orthotropy.conductivity = Three(values.orthotropic().thermal_conductivity());
  if (use.has_axes()) {
    orthotropy.axes = GrainAxes(FromProto(use.axes().grain()), FromProto(use.axes().radial()));
  }
  return material;
}

// Counts what no solver can use; the criterion is that of the stiffness.
absl::Status CheckElements(const mesh::TetrahedralMesh& volume,
                           const std::vector<std::int64_t>& numbers) {
  const auto& rule = TetrahedronRule(volume.IsQuadratic() ? 2 : 1);
  Eigen::Index bad = 0, first = -1;
  for (Eigen::Index e = 0; e < volume.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(volume, e);
    const double longest = (positions.colwise() - Eigen::Vector3d(positions.col(0))).norm();
    const bool is_good = std::all_of(rule.begin(), rule.end(), [&](const TetrahedronPoint& point) {
      return EvaluateElement(positions, point.barycentric).determinant >
             1e-14 * longest * longest * longest;
    });
    if (is_good) continue;
    ++bad;
    if (first < 0) first = e;
  }
  if (bad == 0) return absl::OkStatus();
  return InvalidField("mesh_file", absl::StrCat(bad, " of ", volume.tetrahedra.cols(),
                                                " elements are inverted or have no volume; the "
                                                "first is element ",
                                                numbers[first]));
}

// Short, whatever there is: it is in each result.
std::string PartName(const Texts& groups) {
  if (groups.empty()) return "all elements";
  return groups.size() == 1 ? groups[0]
                            : absl::StrCat(groups[0], " and ", groups.size() - 1, " more");
}

template <typename Matrix>
double Columns(const Matrix& matrix) {
  return static_cast<double>(matrix.cols());
}

// How many nodes, sides or elements all conditions name together. A short case that names a large
// group again and again would take a multiple of the memory that the mesh does.
class Tally {
 public:
  // `what` the mesh has `count` of, of which groups have at most `most` members.
  Tally(const char* what, double count, double most)
      : what_(what), most_(most), limit_(kAlways + kTimes * count) {}

  // Groups of a name that is known already are not looked at.
  template <typename Group>
  void Know(const std::vector<Group>& groups, double of_member) {
    for (const Group& group : groups) {
      members_.emplace(group.name, of_member * static_cast<double>(group.members.size()));
    }
  }

  // Counts the members of a condition's groups before they are gathered. RESOURCE_EXHAUSTED naming
  // the list that the condition, `field`, is in.
  absl::Status Add(const Texts& groups, const std::string& field) {
    double members = 0;
    for (const std::string& name : groups) {
      const auto found = members_.find(name);
      if (found != members_.end()) members += found->second;
    }
    total_ += std::min(members, most_);
    if (members <= limit_ && total_ <= limit_) return absl::OkStatus();
    return TooLarge(
        field.substr(0, field.rfind('[')),
        absl::StrFormat("what conditions on this mesh may name: %.0f %s in all", limit_, what_));
  }

 private:
  // Each condition on nodes takes up to 250 bytes a node while supports are collected.
  static constexpr double kAlways = 2e5, kTimes = 8;

  const char* what_;
  double most_, limit_, total_ = 0;
  std::map<std::string, double> members_;  // by group
};

absl::StatusOr<std::string> ToJson(const v1::MeshCase& mesh_case) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.preserve_proto_field_names = true;
  std::string json;
  const auto written = google::protobuf::util::MessageToJsonString(mesh_case, &json, options);
  if (written.ok()) return json;
  return InvalidField("case",
                      absl::StrCat("cannot be written as JSON: ", std::string(written.message())));
}

class Modeller {
 public:
  Modeller(const mesh::GroupedMesh& grouped, const v1::MeshCase& of)
      : grouped_(grouped),
        case_(of),
        groups_(grouped),
        nodes_("nodes", Columns(grouped.nodes), Columns(grouped.nodes)),
        sides_("faces", Columns(grouped.tetrahedra), 4 * Columns(grouped.tetrahedra)),
        elements_("elements", Columns(grouped.tetrahedra), Columns(grouped.tetrahedra)) {
    nodes_.Know(grouped.face_groups, grouped.tetrahedra.rows() == 10 ? 6 : 3);
    nodes_.Know(grouped.node_groups, 1);
    sides_.Know(grouped.face_groups, 1);
    elements_.Know(grouped.element_groups, 1);
  }

  absl::StatusOr<MeshModel> Make() {
    model_.title = case_.title();
    MORTISE_ASSIGN_OR_RETURN(model_.case_json, ToJson(case_));
    MORTISE_ASSIGN_OR_RETURN(metres_, mesh::MetresOf(case_.length_unit(), "case.length_unit"));
    model_.mesh.nodes = metres_ * grouped_.nodes;
    model_.mesh.tetrahedra = grouped_.tetrahedra;
    model_.node_numbers = grouped_.node_numbers;
    constexpr double kFarthest = 1e30;  // m; products of coordinates must be numbers
    if (!(model_.mesh.nodes.cwiseAbs().maxCoeff() < kFarthest)) {
      return InvalidField("mesh_file", "a coordinate is too large");
    }
    MORTISE_RETURN_IF_ERROR(CheckElements(model_.mesh, grouped_.element_numbers));
    MORTISE_RETURN_IF_ERROR(MakeParts());
    for (int i = 0; i < case_.supports_size(); ++i) {
      MORTISE_RETURN_IF_ERROR(
          AddSupport(case_.supports(i), absl::StrCat("case.supports[", i, "]")));
    }
    for (int i = 0; i < case_.load_cases_size(); ++i) {
      MORTISE_RETURN_IF_ERROR(
          AddLoadCase(case_.load_cases(i), absl::StrCat("case.load_cases[", i, "]")));
    }
    AddCombinations();
    if (case_.has_heat()) MORTISE_RETURN_IF_ERROR(AddHeat());
    model_.modes = case_.modes();
    for (int i = 0; i < case_.probes_size(); ++i) {
      MORTISE_RETURN_IF_ERROR(AddProbe(case_.probes(i), absl::StrCat("case.probes[", i, "]")));
    }
    groups_.TakeFaces(model_.mesh);
    return std::move(model_);
  }

 private:
  // Groups as MeshGroups gives them, once they are counted.
  absl::StatusOr<std::vector<int>> Nodes(const Texts& groups, const std::string& field) {
    MORTISE_RETURN_IF_ERROR(nodes_.Add(groups, field));
    return groups_.Nodes(Names(groups), field);
  }
  absl::StatusOr<std::vector<int>> Elements(const Texts& groups, const std::string& field) {
    MORTISE_RETURN_IF_ERROR(elements_.Add(groups, field));
    return groups_.Elements(Names(groups), field);
  }
  // The same groups share a face, which counts once.
  absl::StatusOr<mesh::NamedFace> Face(const Texts& groups, bool is_loaded,
                                       const std::string& field) {
    if (faces_.insert(absl::StrJoin(groups, "', '")).second) {
      MORTISE_RETURN_IF_ERROR(sides_.Add(groups, field));
    }
    return groups_.Face(Names(groups), is_loaded, field);
  }

  // A part for each material.
  absl::Status MakeParts() {
    mesh::TetrahedralMesh& volume = model_.mesh;
    volume.part = Eigen::VectorXi::Constant(volume.tetrahedra.cols(), -1);
    for (int i = 0; i < case_.materials_size(); ++i) {
      const v1::MeshMaterial& use = case_.materials(i);
      const std::string field = absl::StrCat("case.materials[", i, "]");
      MORTISE_ASSIGN_OR_RETURN(std::vector<int> elements, Elements(use.groups(), field));
      if (use.groups().empty()) {
        elements.resize(volume.tetrahedra.cols());
        for (std::size_t e = 0; e < elements.size(); ++e) elements[e] = static_cast<int>(e);
      }
      const std::string name = PartName(use.groups());
      const auto taken = std::find_if(elements.begin(), elements.end(),
                                      [&](int e) { return volume.part[e] >= 0; });
      if (taken != elements.end()) {
        const int other = volume.part[*taken];
        const auto count = std::count_if(elements.begin(), elements.end(),
                                         [&](int e) { return volume.part[e] == other; });
        return InvalidField(
            field + ".groups",
            absl::StrCat(count, " elements of '", name, "' have a material already, of '",
                         volume.part_names[other], "' (materials[", other, "])"));
      }
      for (const int e : elements) volume.part[e] = i;
      volume.part_names.push_back(name);
      model_.materials.push_back(MakeMaterial(use, name));
      MORTISE_RETURN_IF_ERROR(CheckMaterial(model_.materials.back(), field + ".values"));
    }
    return CheckAllHaveMaterial();
  }

  absl::Status CheckAllHaveMaterial() const {
    const Eigen::VectorXi& part = model_.mesh.part;
    if ((part.array() >= 0).all()) return absl::OkStatus();
    for (const mesh::ElementGroup& group : grouped_.element_groups) {
      const auto count = std::count_if(group.members.begin(), group.members.end(),
                                       [&](int e) { return part[e] < 0; });
      if (count == 0) continue;
      return InvalidField("case.materials", absl::StrCat(count, " elements of group '", group.name,
                                                         "' have no material"));
    }
    return InvalidField("case.materials", absl::StrCat((part.array() < 0).count(),
                                                       " elements that are in no group have no "
                                                       "material"));
  }

  absl::Status AddSupport(const v1::MeshSupport& held, const std::string& field) {
    Support support;
    MORTISE_ASSIGN_OR_RETURN(std::vector<int> nodes, Nodes(held.groups(), field));
    if (held.symmetric()) {
      MORTISE_ASSIGN_OR_RETURN(support.face, Face(held.groups(), false, field));
      support.symmetric = true;
    } else {
      support.nodes = nodes;
    }
    if (held.has_displacement()) {
      const v1::PrescribedDisplacement& given = held.displacement();
      support.fixed = {given.has_x(), given.has_y(), given.has_z()};
      support.displacement = {given.x(), given.y(), given.z()};
    }
    model_.supports.push_back(std::move(support));
    model_.support_nodes.push_back(std::move(nodes));
    return absl::OkStatus();
  }

  absl::Status AddLoadCase(const v1::MeshLoadCase& given, const std::string& field) {
    NamedLoadCase named;
    named.name = given.name();
    named.thermal_stress = given.thermal_stress();
    LoadCase& loads = named.loads;
    const auto face = [&](const Texts& groups, const char* list, int i) {
      return Face(groups, true, absl::StrCat(field, ".", list, "[", i, "]"));
    };
    for (int i = 0; i < given.forces_size(); ++i) {
      FaceForce& force = loads.forces.emplace_back();
      MORTISE_ASSIGN_OR_RETURN(force.face, face(given.forces(i).groups(), "forces", i));
      force.force = FromProto(given.forces(i).force());
    }
    for (int i = 0; i < given.pressures_size(); ++i) {
      FacePressure& pressure = loads.pressures.emplace_back();
      MORTISE_ASSIGN_OR_RETURN(pressure.face, face(given.pressures(i).groups(), "pressures", i));
      pressure.pressure = given.pressures(i).pressure();
    }
    for (int i = 0; i < given.tractions_size(); ++i) {
      FaceTraction& traction = loads.tractions.emplace_back();
      MORTISE_ASSIGN_OR_RETURN(traction.face, face(given.tractions(i).groups(), "tractions", i));
      traction.traction = [value = FromProto(given.tractions(i).traction())](
                              const Eigen::Vector3d&, const Eigen::Vector3d&) { return value; };
    }
    for (const v1::PointForce& force : given.point_forces()) {
      loads.point_forces.push_back(
          {metres_ * FromProto(force.position()), FromProto(force.force())});
    }
    for (int i = 0; i < given.nodal_forces_size(); ++i) {
      const std::string place = absl::StrCat(field, ".nodal_forces[", i, "]");
      const Texts& groups = given.nodal_forces(i).groups();
      MORTISE_RETURN_IF_ERROR(nodes_.Add(groups, place));
      MORTISE_ASSIGN_OR_RETURN(const std::vector<int> nodes,
                               groups_.OwnNodes(Names(groups), place));
      for (const int node : nodes) {
        loads.nodal_forces.push_back({node, FromProto(given.nodal_forces(i).force())});
      }
    }
    loads.gravity = FromProto(given.gravity());
    if (given.has_body_force()) {
      loads.body_force = [value = FromProto(given.body_force())](const Eigen::Vector3d&) {
        return value;
      };
    }
    if (given.has_rotation()) {
      loads.rotation = Rotation{metres_ * FromProto(given.rotation().point()),
                                FromProto(given.rotation().angular_velocity())};
    }
    model_.load_cases.push_back(std::move(named));
    return absl::OkStatus();
  }

  void AddCombinations() {
    model_.solver = SolverKindOf(case_.solver());
    for (const v1::LoadCombination& given : case_.combinations()) {
      NamedCombination& combination = model_.combinations.emplace_back();
      combination.name = given.name();
      for (const v1::LoadCombination::Term& term : given.terms()) {
        const auto found = std::find_if(
            model_.load_cases.begin(), model_.load_cases.end(),
            [&](const NamedLoadCase& loads) { return loads.name == term.load_case(); });
        combination.terms.push_back(
            {static_cast<int>(found - model_.load_cases.begin()), term.factor()});
      }
    }
  }

  absl::Status AddHeat() {
    const v1::MeshHeat& given = case_.heat();
    HeatCase& heat = model_.heat.emplace();
    heat.materials = model_.materials;
    model_.reference_temperature = given.reference_temperature();
    const auto at = [](const char* list, int i) {
      return absl::StrCat("case.heat.", list, "[", i, "]");
    };
    for (int i = 0; i < given.temperatures_size(); ++i) {
      FixedTemperature& held = heat.temperatures.emplace_back();
      MORTISE_ASSIGN_OR_RETURN(held.nodes,
                               Nodes(given.temperatures(i).groups(), at("temperatures", i)));
      held.temperature = given.temperatures(i).temperature();
    }
    for (int i = 0; i < given.fluxes_size(); ++i) {
      HeatFlux& flux = heat.fluxes.emplace_back();
      MORTISE_ASSIGN_OR_RETURN(flux.face, Face(given.fluxes(i).groups(), true, at("fluxes", i)));
      flux.flux = given.fluxes(i).flux();
    }
    for (int i = 0; i < given.convections_size(); ++i) {
      Convection& convection = heat.convections.emplace_back();
      MORTISE_ASSIGN_OR_RETURN(convection.face,
                               Face(given.convections(i).groups(), true, at("convections", i)));
      convection.coefficient = given.convections(i).coefficient();
      convection.ambient = given.convections(i).ambient();
    }
    for (int i = 0; i < given.sources_size(); ++i) {
      MORTISE_ASSIGN_OR_RETURN(std::vector<int> elements,
                               Elements(given.sources(i).groups(), at("sources", i)));
      if (!given.sources(i).groups().empty()) {
        heat.sources.push_back({-1, given.sources(i).power(), std::move(elements)});
        continue;
      }
      for (int part = 0; part < case_.materials_size(); ++part) {
        heat.sources.push_back({part, given.sources(i).power()});
      }
    }
    return absl::OkStatus();
  }

  absl::Status AddProbe(const v1::MeshProbe& given, const std::string& field) {
    Probe& probe = model_.probes.emplace_back();
    probe.name = given.name();
    for (const v1::Vector3& point : given.points()) {
      probe.points.push_back(metres_ * FromProto(point));
    }
    MORTISE_ASSIGN_OR_RETURN(probe.nodes, Nodes(given.groups(), field));
    return absl::OkStatus();
  }

  const mesh::GroupedMesh& grouped_;
  const v1::MeshCase& case_;
  MeshGroups groups_;
  Tally nodes_, sides_, elements_;
  std::set<std::string> faces_;  // counted, by their groups
  double metres_ = 1;
  MeshModel model_;
};

}  // namespace

absl::StatusOr<MeshModel> MakeMeshModel(const mesh::GroupedMesh& mesh,
                                        const v1::MeshCase& mesh_case) {
  return Modeller(mesh, mesh_case).Make();
}

}  // namespace mortise::simulator
