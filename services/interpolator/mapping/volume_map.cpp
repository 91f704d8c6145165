#include "services/interpolator/mapping/volume_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fem/elements/material.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/linear/linear_solver.h"
#include "common/mesh/corner_mesh.h"
#include "common/mesh/element_faces.h"
#include "services/interpolator/mapping/untangling.h"

namespace mortise::interpolator {
namespace {

constexpr double kFlat = 1e-9;      // of the cube of an element's longest edge
constexpr int kStiffestClass = 20;  // elements are up to 2²⁰ times as stiff as the largest
constexpr double kTolerance = 1e-8;

double VolumeOf(const Eigen::Matrix3Xd& nodes, const Eigen::Vector4i& element) {
  const Eigen::Vector3d a = nodes.col(element[0]);
  const Eigen::Vector3d b = nodes.col(element[1]) - a, c = nodes.col(element[2]) - a;
  return b.cross(c).dot(nodes.col(element[3]) - a) / 6;
}

double LongestEdge(const Eigen::Matrix3Xd& nodes, const Eigen::Vector4i& element) {
  double longest = 0;
  for (const auto& [from, to] : mesh::kTetrahedronEdges) {
    longest = std::max(longest, (nodes.col(element[from]) - nodes.col(element[to])).norm());
  }
  return longest;
}

// How an attempt to displace the body is made.
struct Attempt {
  bool is_stiffened = false;  // small elements are stiffer
  int steps = 1;
};
constexpr Attempt kAttempts[] = {{false, 1}, {true, 1}, {true, 4}, {true, 16}};

// The corners of a mesh, whose parts are classes of stiffness, and the displaced surface.
class ElasticBody {
 public:
  ElasticBody(mesh::TetrahedralMesh corners, Eigen::Array3Xi is_fixed, Eigen::Matrix3Xd goal,
              const VolumeMapOptions& options)
      : mesh_(std::move(corners)), is_fixed_(std::move(is_fixed)), goal_(std::move(goal)) {
    solver_options_.memory_limit = options.memory_limit;
    solver_options_.threads = options.threads;
    solver_options_.tolerance = kTolerance;
    start_ = mesh_.nodes;
  }

  // Returns the corners when the surface is where it is wanted. Nothing, where elements are turned
  // over after a step that is not the last.
  absl::StatusOr<std::optional<Eigen::Matrix3Xd>> Displace(const Attempt& attempt) {
    Classify(attempt.is_stiffened);
    mesh_.nodes = start_;
    for (int step = 1; step <= attempt.steps; ++step) {
      const double share = static_cast<double>(step) / attempt.steps;
      const Eigen::Matrix3Xd wanted = (1 - share) * start_ + share * goal_;
      const Eigen::Matrix3Xd prescribed =
          (is_fixed_ != 0).select((wanted - mesh_.nodes).array(), 0.0).matrix();
      MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd inner, Solve(prescribed));
      mesh_.nodes += prescribed + inner;
      mesh_.nodes = (is_fixed_ != 0).select(wanted.array(), mesh_.nodes.array()).matrix();
      const bool is_last = step == attempt.steps;
      if (!is_last && !InvertedElements(mesh_, mesh_.nodes).empty()) return {std::nullopt};
    }
    return {mesh_.nodes};
  }

  int solves() const { return solves_; }

 private:
  void Classify(bool is_stiffened) {
    double largest = 0;
    for (Eigen::Index e = 0; e < mesh_.tetrahedra.cols(); ++e) {
      largest = std::max(largest, VolumeOf(start_, mesh_.tetrahedra.col(e)));
    }
    int stiffest = 0;
    for (Eigen::Index e = 0; e < mesh_.tetrahedra.cols(); ++e) {
      const double ratio = largest / VolumeOf(start_, mesh_.tetrahedra.col(e));
      const double level = std::min(std::log2(ratio), static_cast<double>(kStiffestClass));
      mesh_.part[e] = is_stiffened ? static_cast<int>(std::round(level)) : 0;
      stiffest = std::max(stiffest, mesh_.part[e]);
    }
    materials_.clear();
    mesh_.part_names.clear();
    for (int level = 0; level <= stiffest; ++level) {
      simulator::Material rubber;
      rubber.name = absl::StrCat("stiffness ", level);
      rubber.density = 1;
      rubber.youngs_modulus = std::exp2(level);
      mesh_.part_names.push_back(rubber.name);
      materials_.push_back(rubber);
    }
  }

  absl::StatusOr<Eigen::Matrix3Xd> Solve(const Eigen::Matrix3Xd& prescribed) {
    ++solves_;
    if ((is_fixed_ != 0).all()) return Eigen::Matrix3Xd::Zero(3, prescribed.cols()).eval();
    MORTISE_ASSIGN_OR_RETURN(simulator::BlockMatrix assembled,
                             simulator::AssembleStiffness(mesh_, materials_));
    const auto stiffness = std::make_shared<const simulator::BlockMatrix>(std::move(assembled));
    const Eigen::Matrix3Xd load =
        (is_fixed_ == 0).select(-stiffness->Multiply(prescribed).array(), 0.0).matrix();
    // What moves as a whole, or not at all, needs no solution, which could not be told from 0.
    if (load.norm() == 0) return Eigen::Matrix3Xd::Zero(3, prescribed.cols()).eval();
    MORTISE_ASSIGN_OR_RETURN(const auto solver,
                             simulator::LinearSolver::Create(mesh_, stiffness->pattern(), is_fixed_,
                                                             {}, solver_options_));
    MORTISE_RETURN_IF_ERROR(solver->Prepare(stiffness, mesh_.nodes));
    return solver->Solve(load);
  }

  mesh::TetrahedralMesh mesh_;
  Eigen::Array3Xi is_fixed_;
  Eigen::Matrix3Xd goal_;  // of the surface
  Eigen::Matrix3Xd start_;
  std::vector<simulator::Material> materials_;
  simulator::SolverOptions solver_options_;
  int solves_ = 0;
};

absl::Status CheckOuter(const mesh::TetrahedralMesh& mesh, const mesh::CornerMesh& corners,
                        const std::vector<int>& outer, const Eigen::Matrix3Xd& positions) {
  if (positions.cols() != static_cast<Eigen::Index>(outer.size()) || !positions.allFinite()) {
    return InvalidField("positions", "they are not finite, or not as many as 'outer'");
  }
  std::vector<bool> is_outer(corners.corner_of.size(), false);
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const int node = outer[i];
    if (node < 0 || node >= static_cast<int>(mesh.nodes.cols()) ||
        corners.corner_of[static_cast<std::size_t>(node)] < 0) {
      return InvalidField(absl::StrCat("outer[", i, "]"), "it is no corner of an element");
    }
    is_outer[static_cast<std::size_t>(node)] = true;
  }
  for (const mesh::ElementFace& face : mesh::ElementFaces(mesh).Outer()) {
    for (const int node : face.key) {
      if (is_outer[static_cast<std::size_t>(node)]) continue;
      return InvalidField("outer", absl::StrCat("node ", node, " of the surface is missing"));
    }
  }
  const std::vector<int> inverted = InvertedElements(mesh, mesh.nodes);
  if (!inverted.empty()) {
    return InvalidField("mesh", absl::StrCat("element ", inverted.front(),
                                             " is turned over or flat before it is mapped"));
  }
  return absl::OkStatus();
}

}  // namespace

std::vector<int> InvertedElements(const mesh::TetrahedralMesh& mesh,
                                  const Eigen::Matrix3Xd& nodes) {
  std::vector<int> inverted;
  for (int e = 0; e < static_cast<int>(mesh.tetrahedra.cols()); ++e) {
    const Eigen::Vector4i element = mesh.tetrahedra.col(e).head<4>();
    const double longest = LongestEdge(nodes, element);
    const bool is_sound = VolumeOf(nodes, element) > kFlat * longest * longest * longest;
    if (!is_sound) inverted.push_back(e);
  }
  return inverted;
}

absl::StatusOr<VolumeMap> MapVolume(const mesh::TetrahedralMesh& mesh,
                                    const std::vector<int>& outer,
                                    const Eigen::Matrix3Xd& positions,
                                    const VolumeMapOptions& options) {
  const mesh::CornerMesh corners = mesh::CornersOf(mesh);
  MORTISE_RETURN_IF_ERROR(CheckOuter(mesh, corners, outer, positions));
  Eigen::Array3Xi is_fixed = Eigen::Array3Xi::Zero(3, corners.mesh.nodes.cols());
  Eigen::Matrix3Xd goal = corners.mesh.nodes;
  std::vector<bool> is_free(static_cast<std::size_t>(goal.cols()), true);
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const int corner = corners.corner_of[static_cast<std::size_t>(outer[i])];
    is_fixed.col(corner) = 1;
    is_free[static_cast<std::size_t>(corner)] = false;
    goal.col(corner) = positions.col(static_cast<Eigen::Index>(i));
  }
  ElasticBody body(corners.mesh, is_fixed, goal, options);
  VolumeMap map;
  Eigen::Matrix3Xd best;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  // Elements between nodes of the surface are as the surface wants them.
  const auto is_movable = [&](int element) {
    for (int k = 0; k < 4; ++k) {
      if (is_free[static_cast<std::size_t>(corners.mesh.tetrahedra(k, element))]) return true;
    }
    return false;
  };
  for (const Attempt& attempt : kAttempts) {
    MORTISE_ASSIGN_OR_RETURN(const std::optional<Eigen::Matrix3Xd> displaced,
                             body.Displace(attempt));
    if (!displaced) continue;
    const std::vector<int> inverted = InvertedElements(corners.mesh, *displaced);
    if (best.size() == 0) map.inverted_at_first = static_cast<int>(inverted.size());
    if (inverted.size() < fewest) best = *displaced;
    fewest = std::min(fewest, inverted.size());
    if (std::none_of(inverted.begin(), inverted.end(), is_movable)) break;
  }
  map.solves = body.solves();
  if (fewest > 0) Untangle(corners.mesh, is_free, best);
  map.inverted = InvertedElements(corners.mesh, best);
  map.untangled = static_cast<int>(fewest) - static_cast<int>(map.inverted.size());
  map.nodes = mesh::AtAllNodes(mesh, corners, best);
  return map;
}

}  // namespace mortise::interpolator
