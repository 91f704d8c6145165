#include "common/fem/problems/heat_conduction.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fem/elements/analysis_case.h"
#include "common/fem/elements/matrix_assembly.h"
#include "common/fem/elements/shape_functions.h"
#include "common/fem/mechanisms/bodies.h"

namespace mortise::simulator {
namespace {

// The solver of displacements serves temperatures as the first of each node's three unknowns, the
// other two held; blocks carry the conductivity in their first entry.
constexpr int kTemperature = 0;

constexpr char kNotFinite[] = "must be finite";

absl::Status CheckConvections(const mesh::TetrahedralMesh& mesh,
                              const std::vector<Convection>& convections) {
  for (std::size_t i = 0; i < convections.size(); ++i) {
    const std::string field = absl::StrCat("convections[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckFace(mesh, convections[i].face, true, field + ".face"));
    if (!std::isfinite(convections[i].coefficient) || convections[i].coefficient <= 0) {
      return InvalidField(field + ".coefficient", "must be positive");
    }
    if (!std::isfinite(convections[i].ambient)) {
      return InvalidField(field + ".ambient", kNotFinite);
    }
  }
  return absl::OkStatus();
}

// Whether all are indices of things of which there are `count`, and there is one.
bool AreIndices(const std::vector<int>& indices, Eigen::Index count) {
  return !indices.empty() && std::all_of(indices.begin(), indices.end(),
                                         [&](int index) { return index >= 0 && index < count; });
}

absl::Status CheckPlace(const mesh::TetrahedralMesh& mesh, const FixedTemperature& held,
                        const std::string& field) {
  if (!held.face.name.empty()) return CheckFace(mesh, held.face, false, field + ".face");
  if (AreIndices(held.nodes, mesh.nodes.cols())) return absl::OkStatus();
  return InvalidField(field + ".nodes", "name a face, or nodes that exist");
}

absl::Status CheckPlace(const mesh::TetrahedralMesh& mesh, const HeatSource& source,
                        const std::string& field) {
  if (source.part == -1 && AreIndices(source.elements, mesh.tetrahedra.cols())) {
    return absl::OkStatus();
  }
  if (source.part >= 0 && source.part < static_cast<int>(mesh.part_names.size())) {
    return absl::OkStatus();
  }
  return InvalidField(field + ".part", "there is no such part");
}

absl::Status CheckCase(const mesh::TetrahedralMesh& mesh, const HeatCase& heat) {
  if (heat.materials.size() != mesh.part_names.size()) {
    return InvalidField("materials", "there must be one for each part");
  }
  for (std::size_t p = 0; p < heat.materials.size(); ++p) {
    MORTISE_RETURN_IF_ERROR(
        CheckConductivity(heat.materials[p], absl::StrCat("materials[", p, "]")));
  }
  for (std::size_t i = 0; i < heat.temperatures.size(); ++i) {
    const std::string field = absl::StrCat("temperatures[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckPlace(mesh, heat.temperatures[i], field));
    if (!std::isfinite(heat.temperatures[i].temperature)) {
      return InvalidField(field + ".temperature", kNotFinite);
    }
  }
  for (std::size_t i = 0; i < heat.fluxes.size(); ++i) {
    const std::string field = absl::StrCat("fluxes[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckFace(mesh, heat.fluxes[i].face, true, field + ".face"));
    if (!std::isfinite(heat.fluxes[i].flux)) return InvalidField(field + ".flux", kNotFinite);
  }
  for (std::size_t i = 0; i < heat.sources.size(); ++i) {
    const std::string field = absl::StrCat("sources[", i, "]");
    MORTISE_RETURN_IF_ERROR(CheckPlace(mesh, heat.sources[i], field));
    if (!std::isfinite(heat.sources[i].power)) return InvalidField(field + ".power", kNotFinite);
  }
  return CheckConvections(mesh, heat.convections);
}

absl::StatusOr<BlockMatrix> AssembleConductivity(const mesh::TetrahedralMesh& mesh,
                                                 const std::vector<Material>& materials,
                                                 ThreadTeam& team) {
  std::vector<Eigen::Matrix3d> conductivity;
  for (const Material& material : materials) conductivity.push_back(ConductivityMatrix(material));
  const int nodes = static_cast<int>(mesh.tetrahedra.rows());
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  const auto kernel = [&](int e, Eigen::Matrix3d* blocks) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    const double longest = (positions.colwise() - Eigen::Vector3d(positions.col(0))).norm();
    for (const TetrahedronPoint& point : rule) {
      const ElementPoint geometry = EvaluateElement(positions, point.barycentric);
      if (!(geometry.determinant > 1e-14 * longest * longest * longest)) return false;
      const GradientMatrix flux =
          point.weight * geometry.determinant / 6 * conductivity[mesh.part[e]] * geometry.gradients;
      int k = 0;
      for (int a = 0; a < nodes; ++a) {
        for (int b = a; b < nodes; ++b) {
          blocks[k++](kTemperature, kTemperature) += geometry.gradients.col(a).dot(flux.col(b));
        }
      }
    }
    return true;
  };
  BlockMatrix sum(mesh);
  MORTISE_RETURN_IF_ERROR(AssembleBlocks(mesh, {}, kernel, team, sum));
  return sum;
}

// Calls visit(triangle, shape values, area) at each integration point of the face's free area.
template <typename Visit>
void VisitSurface(const mesh::TetrahedralMesh& mesh, const mesh::NamedFace& face,
                  const Visit& visit) {
  for (const int t : TrianglesOn(mesh, face, true)) {
    const GradientMatrix positions = TrianglePositions(mesh, t);
    for (const TrianglePoint& point : TriangleRule()) {
      const double area = point.weight * TriangleAreaVector(positions, point.barycentric).norm();
      visit(t, TriangleShape(point.barycentric, static_cast<int>(positions.cols())), area);
    }
  }
}

void AddConvection(const mesh::TetrahedralMesh& mesh, const Convection& convection,
                   BlockMatrix& matrix, Eigen::Matrix3Xd& loads) {
  VisitSurface(mesh, convection.face, [&](int t, const ShapeVector& shape, double area) {
    const double h = convection.coefficient * area;
    for (Eigen::Index a = 0; a < shape.size(); ++a) {
      const int i = mesh.face_triangles(a, t);
      loads(kTemperature, i) += h * shape[a] * convection.ambient;
      for (Eigen::Index b = 0; b < shape.size(); ++b) {
        const int j = mesh.face_triangles(b, t);
        if (i > j) continue;
        Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
        block(kTemperature, kTemperature) = h * shape[a] * shape[b];
        matrix.Add(i, j, block);
      }
    }
  });
}

// W/m³ of each element.
Eigen::VectorXd SourcePower(const mesh::TetrahedralMesh& mesh,
                            const std::vector<HeatSource>& sources) {
  Eigen::VectorXd of_part = Eigen::VectorXd::Zero(mesh.part_names.size());
  Eigen::VectorXd power = Eigen::VectorXd::Zero(mesh.tetrahedra.cols());
  for (const HeatSource& source : sources) {
    if (source.part >= 0) of_part[source.part] += source.power;
    for (const int e : source.elements) power[e] += source.power;
  }
  for (Eigen::Index e = 0; e < power.size(); ++e) power[e] += of_part[mesh.part[e]];
  return power;
}

// W of fluxes and sources, at the nodes.
Eigen::Matrix3Xd Supply(const mesh::TetrahedralMesh& mesh, const HeatCase& heat) {
  Eigen::Matrix3Xd supply = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  for (const HeatFlux& flux : heat.fluxes) {
    VisitSurface(mesh, flux.face, [&](int t, const ShapeVector& shape, double area) {
      for (Eigen::Index k = 0; k < shape.size(); ++k) {
        supply(kTemperature, mesh.face_triangles(k, t)) += flux.flux * area * shape[k];
      }
    });
  }
  const Eigen::VectorXd power = SourcePower(mesh, heat.sources);
  if (power.isZero(0)) return supply;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    if (power[e] == 0) continue;
    const GradientMatrix positions = ElementPositions(mesh, e);
    for (const TetrahedronPoint& point : TetrahedronRule(2)) {
      const double volume =
          point.weight * EvaluateElement(positions, point.barycentric).determinant / 6;
      const ShapeVector shape =
          TetrahedronShape(point.barycentric, static_cast<int>(mesh.tetrahedra.rows()));
      for (Eigen::Index k = 0; k < shape.size(); ++k) {
        supply(kTemperature, mesh.tetrahedra(k, e)) += power[e] * volume * shape[k];
      }
    }
  }
  return supply;
}

struct Held {
  Eigen::Array3Xi fixed;         // 3 × nodes
  Eigen::Matrix3Xd temperature;  // in the first row, where fixed
};

std::vector<int> NodesOf(const mesh::TetrahedralMesh& mesh, const FixedTemperature& held) {
  if (held.face.name.empty()) return held.nodes;
  std::vector<int> nodes;
  for (const int t : TrianglesOn(mesh, held.face, false)) {
    for (Eigen::Index k = 0; k < mesh.face_triangles.rows(); ++k) {
      nodes.push_back(mesh.face_triangles(k, t));
    }
  }
  return nodes;
}

absl::StatusOr<Held> HoldTemperatures(const mesh::TetrahedralMesh& mesh,
                                      const std::vector<FixedTemperature>& temperatures) {
  Held held{Eigen::Array3Xi::Ones(3, mesh.nodes.cols()),
            Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols())};
  held.fixed.row(kTemperature).setZero();
  for (std::size_t i = 0; i < temperatures.size(); ++i) {
    for (const int node : NodesOf(mesh, temperatures[i])) {
      double& value = held.temperature(kTemperature, node);
      if (held.fixed(kTemperature, node) && value != temperatures[i].temperature) {
        return InvalidField(absl::StrCat("temperatures[", i, "].temperature"),
                            "contradicts another one on a shared edge");
      }
      held.fixed(kTemperature, node) = 1;
      value = temperatures[i].temperature;
    }
  }
  return held;
}

absl::Status CheckFreeTemperature(const mesh::TetrahedralMesh& mesh, const HeatCase& heat,
                                  const Held& held) {
  MORTISE_RETURN_IF_ERROR(CheckNodesAreUsed(mesh));
  std::vector<int> convecting;  // triangles
  for (const Convection& convection : heat.convections) {
    const std::vector<int> triangles = TrianglesOn(mesh, convection.face, true);
    convecting.insert(convecting.end(), triangles.begin(), triangles.end());
  }
  // Through an edge or a point flows no heat: what of it the elements let through becomes less and
  // less the smaller they are.
  const std::vector<Body> bodies = FindBodies(mesh);
  std::vector<const Body*> body_of(mesh.nodes.cols(), nullptr);
  std::vector<int> bodies_at(mesh.nodes.cols(), 0);
  for (const Body& body : bodies) {
    for (const int v : body.nodes) ++bodies_at[v];
  }
  for (const Body& body : bodies) {
    for (const int v : body.nodes) body_of[v] = &body;
    const auto is_held = [&](int v) { return held.fixed(kTemperature, v) != 0; };
    const auto is_own_and_held = [&](int v) { return is_held(v) && bodies_at[v] == 1; };
    const auto is_of_body = [&](int t) {
      const auto corners = mesh.face_triangles.col(t).head<3>();
      return std::all_of(corners.begin(), corners.end(),
                         [&](int v) { return body_of[v] == &body; });
    };
    if (std::any_of(body.nodes.begin(), body.nodes.end(), is_own_and_held) ||
        std::all_of(body.nodes.begin(), body.nodes.end(), is_held) ||
        std::any_of(convecting.begin(), convecting.end(), is_of_body)) {
      continue;
    }
    return PreconditionFailed(
        "FREE_TEMPERATURE",
        absl::StrCat(BodyText(body, bodies, mesh),
                     " without a fixed temperature or convection, and shares no face with a body "
                     "that has one: any temperature would do"),
        "temperatures");
  }
  return absl::OkStatus();
}

// Over the volume.
double MeanTemperature(const mesh::TetrahedralMesh& mesh, const Eigen::VectorXd& temperature) {
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 5 : 1);
  double sum = 0, volume = 0;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    for (const TetrahedronPoint& point : rule) {
      const double part =
          point.weight * EvaluateElement(positions, point.barycentric).determinant / 6;
      const ShapeVector shape =
          TetrahedronShape(point.barycentric, static_cast<int>(mesh.tetrahedra.rows()));
      for (Eigen::Index k = 0; k < shape.size(); ++k) {
        sum += part * shape[k] * temperature[mesh.tetrahedra(k, e)];
      }
      volume += part;
    }
  }
  return sum / volume;
}

// Balances the heat of a solution.
void Summarise(const mesh::TetrahedralMesh& mesh, const HeatCase& heat, const Held& held,
               const Eigen::Matrix3Xd& unbalanced, HeatSolution& solution) {
  const Eigen::Index nodes = mesh.nodes.cols();
  solution.reaction = Eigen::VectorXd::Zero(nodes);
  for (Eigen::Index v = 0; v < nodes; ++v) {
    if (held.fixed(kTemperature, v)) solution.reaction[v] = unbalanced(kTemperature, v);
  }
  solution.convected = Eigen::VectorXd::Zero(heat.convections.size());
  for (std::size_t i = 0; i < heat.convections.size(); ++i) {
    const Convection& convection = heat.convections[i];
    VisitSurface(mesh, convection.face, [&](int t, const ShapeVector& shape, double area) {
      double temperature = 0;
      for (Eigen::Index k = 0; k < shape.size(); ++k) {
        temperature += shape[k] * solution.temperature[mesh.face_triangles(k, t)];
      }
      solution.convected[i] += convection.coefficient * area * (temperature - convection.ambient);
    });
  }
  solution.held = Eigen::VectorXd::Zero(heat.temperatures.size());
  std::vector<bool> counted(nodes);
  for (std::size_t i = 0; i < heat.temperatures.size(); ++i) {
    for (const int node : NodesOf(mesh, heat.temperatures[i])) {
      if (counted[node]) continue;
      counted[node] = true;
      solution.held[i] += solution.reaction[node];
    }
  }
  const double scale = std::abs(solution.supplied) + solution.reaction.cwiseAbs().sum() +
                       solution.convected.cwiseAbs().sum();
  const double rest = solution.supplied + solution.reaction.sum() - solution.convected.sum();
  solution.imbalance = scale > 0 ? std::abs(rest) / scale : 0;
  solution.minimum = solution.temperature.minCoeff();
  solution.maximum = solution.temperature.maxCoeff();
  solution.mean = MeanTemperature(mesh, solution.temperature);
}

}  // namespace

absl::StatusOr<HeatSolution> SolveHeat(const mesh::TetrahedralMesh& mesh, const HeatCase& heat,
                                       const HeatOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  MORTISE_RETURN_IF_ERROR(CheckMesh(mesh));
  MORTISE_RETURN_IF_ERROR(CheckCase(mesh, heat));
  MORTISE_ASSIGN_OR_RETURN(const Held held, HoldTemperatures(mesh, heat.temperatures));
  MORTISE_RETURN_IF_ERROR(CheckFreeTemperature(mesh, heat, held));
  ThreadTeam team(options.threads);
  MORTISE_ASSIGN_OR_RETURN(BlockMatrix matrix, AssembleConductivity(mesh, heat.materials, team));
  Eigen::Matrix3Xd loads = Supply(mesh, heat);
  HeatSolution solution;
  solution.supplied = loads.row(kTemperature).sum();
  for (const Convection& convection : heat.convections) {
    AddConvection(mesh, convection, matrix, loads);
  }
  MORTISE_ASSIGN_OR_RETURN(SparseCholesky factor,
                           SparseCholesky::Create(matrix, held.fixed, options.cholesky));
  MORTISE_ASSIGN_OR_RETURN(Eigen::Matrix3Xd temperature,
                           factor.Solve(loads - matrix.Multiply(held.temperature)));
  temperature += held.temperature;
  solution.temperature = temperature.row(kTemperature).transpose();
  if (!solution.temperature.allFinite()) {
    return PreconditionFailed("SINGULAR", "the temperature is not finite", "temperatures");
  }
  Summarise(mesh, heat, held, matrix.Multiply(temperature) - loads, solution);
  solution.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return solution;
}

double DissipatedHeat(const HeatSolution& solution) {
  return solution.convected.cwiseMax(0).sum() + (-solution.held).cwiseMax(0).sum();
}

Eigen::Matrix3Xd HeatFluxAtPoints(const mesh::TetrahedralMesh& mesh,
                                  const std::vector<Material>& materials,
                                  const Eigen::VectorXd& temperature) {
  std::vector<Eigen::Matrix3d> conductivity;
  for (const Material& material : materials) conductivity.push_back(ConductivityMatrix(material));
  const auto& rule = TetrahedronRule(mesh.IsQuadratic() ? 2 : 1);
  Eigen::Matrix3Xd flux(3, rule.size() * mesh.tetrahedra.cols());
  Eigen::Index column = 0;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const GradientMatrix positions = ElementPositions(mesh, e);
    for (const TetrahedronPoint& point : rule) {
      const ElementPoint geometry = EvaluateElement(positions, point.barycentric);
      Eigen::Vector3d slope = Eigen::Vector3d::Zero();
      for (Eigen::Index k = 0; k < positions.cols(); ++k) {
        slope += temperature[mesh.tetrahedra(k, e)] * geometry.gradients.col(k);
      }
      flux.col(column++) = -conductivity[mesh.part[e]] * slope;
    }
  }
  return flux;
}

}  // namespace mortise::simulator
