#include "services/interpolator/mapping/volume_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <mutex>
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
constexpr double kUnsound = 1e-3;  // of the volume, that may be turned over to begin with
constexpr int kLoads = 30;         // that a solver made ready is made for

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

// A body between corners that answers displacements of its surface with those of its interior.
class ElasticBody {
 public:
  // `mesh`: 4-node elements; a stiffened one has small elements stiffer.
  static absl::StatusOr<ElasticBody> Create(mesh::TetrahedralMesh mesh,
                                            const Eigen::Array3Xi& is_fixed, bool is_stiffened,
                                            simulator::SolverOptions options) {
    ElasticBody body(is_fixed);
    if ((is_fixed != 0).all()) return body;
    const std::vector<simulator::Material> materials = Classify(is_stiffened, mesh);
    MORTISE_ASSIGN_OR_RETURN(simulator::BlockMatrix assembled,
                             simulator::AssembleStiffness(mesh, materials));
    body.stiffness_ = std::make_shared<const simulator::BlockMatrix>(std::move(assembled));
    MORTISE_ASSIGN_OR_RETURN(
        body.solver_,
        simulator::LinearSolver::Create(mesh, body.stiffness_->pattern(), is_fixed, {}, options));
    MORTISE_RETURN_IF_ERROR(body.solver_->Prepare(body.stiffness_, mesh.nodes));
    return body;
  }

  // Returns the displacements of all corners, `prescribed` on the surface.
  absl::StatusOr<Eigen::Matrix3Xd> Displace(const Eigen::Matrix3Xd& prescribed) {
    if (solver_ == nullptr) return prescribed;
    const Eigen::Matrix3Xd load =
        (is_fixed_ == 0).select(-stiffness_->Multiply(prescribed).array(), 0.0).matrix();
    // What moves as a whole, or not at all, needs no solution, which could not be told from 0.
    if (load.norm() == 0) return prescribed;
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd inner, solver_->Solve(load));
    return (prescribed + inner).eval();
  }

 private:
  explicit ElasticBody(const Eigen::Array3Xi& is_fixed) : is_fixed_(is_fixed) {}

  // Makes parts of elements of similar volume, and returns their materials.
  static std::vector<simulator::Material> Classify(bool is_stiffened, mesh::TetrahedralMesh& mesh) {
    double largest = 0;
    for (const auto& element : mesh.tetrahedra.colwise()) {
      largest = std::max(largest, VolumeOf(mesh.nodes, element));
    }
    int stiffest = 0;
    for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
      const double ratio = largest / VolumeOf(mesh.nodes, mesh.tetrahedra.col(e));
      const double level = std::min(std::log2(ratio), static_cast<double>(kStiffestClass));
      mesh.part[e] = is_stiffened ? static_cast<int>(std::round(level)) : 0;
      stiffest = std::max(stiffest, mesh.part[e]);
    }
    std::vector<simulator::Material> materials;
    mesh.part_names.clear();
    for (int level = 0; level <= stiffest; ++level) {
      simulator::Material rubber;
      rubber.name = absl::StrCat("stiffness ", level);
      rubber.density = 1;
      rubber.youngs_modulus = std::exp2(level);
      mesh.part_names.push_back(rubber.name);
      materials.push_back(rubber);
    }
    return materials;
  }

  Eigen::Array3Xi is_fixed_;
  std::shared_ptr<const simulator::BlockMatrix> stiffness_;
  std::unique_ptr<simulator::LinearSolver> solver_;  // none where all is fixed
};

absl::Status CheckOuter(const mesh::TetrahedralMesh& mesh, const mesh::CornerMesh& corners,
                        const std::vector<int>& outer) {
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
  return absl::OkStatus();
}

// Returns the elements that are turned over or flat to begin with. INVALID_ARGUMENT if they are
// more than rounding and curved sides explain.
absl::StatusOr<std::vector<int>> UnsoundElements(const mesh::TetrahedralMesh& mesh) {
  std::vector<int> unsound = InvertedElements(mesh, mesh.nodes);
  double all = 0, of_unsound = 0;
  for (const auto& element : mesh.tetrahedra.colwise()) {
    all += std::abs(VolumeOf(mesh.nodes, element));
  }
  for (const int element : unsound) {
    of_unsound += std::abs(VolumeOf(mesh.nodes, mesh.tetrahedra.col(element)));
  }
  if (of_unsound <= kUnsound * all) return unsound;
  return InvalidField("mesh", absl::StrCat("element ", unsound.front(),
                                           " is turned over or flat before it is mapped"));
}

// Returns the mesh without some elements.
mesh::TetrahedralMesh Without(const std::vector<int>& elements, const mesh::TetrahedralMesh& mesh) {
  std::vector<int> kept;
  auto next = elements.begin();
  for (int e = 0; e < static_cast<int>(mesh.tetrahedra.cols()); ++e) {
    const bool is_left_out = next != elements.end() && *next == e;
    if (is_left_out) ++next;
    if (!is_left_out) kept.push_back(e);
  }
  mesh::TetrahedralMesh rest = mesh;
  rest.tetrahedra = mesh.tetrahedra(Eigen::all, kept);
  rest.part = mesh.part(kept);
  return rest;
}

}  // namespace

struct VolumeMapper::State {
  const mesh::TetrahedralMesh* mesh = nullptr;
  mesh::CornerMesh corners;
  std::vector<int> outer;
  Eigen::Array3Xi is_fixed;   // 3 × corners
  std::vector<bool> is_free;  // corners
  std::vector<int> unsound;   // elements that are turned over or flat to begin with
  // Those elements that are sound and have a free corner: others have no say in where these go.
  mesh::TetrahedralMesh body_mesh;
  simulator::SolverOptions options;
  std::mutex mutex;  // of the bodies
  std::optional<ElasticBody> body, stiffened;

  // Returns where corners are when the surface is displaced.
  absl::StatusOr<Eigen::Matrix3Xd> Displace(const Eigen::Matrix3Xd& prescribed, bool is_stiffened) {
    const std::scoped_lock lock(mutex);
    std::optional<ElasticBody>& of = is_stiffened ? stiffened : body;
    if (!of) {
      MORTISE_ASSIGN_OR_RETURN(of, ElasticBody::Create(body_mesh, is_fixed, is_stiffened, options));
    }
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd moved, of->Displace(prescribed));
    return (corners.mesh.nodes + moved).eval();
  }

  // Returns where they are after as many steps, each on the shape before. Nothing, where elements
  // are turned over after a step that is not the last.
  absl::StatusOr<std::optional<Eigen::Matrix3Xd>> DisplaceInSteps(
      const Eigen::Matrix3Xd& prescribed, int steps) const {
    simulator::SolverOptions once = options;
    once.loads = 1;
    mesh::TetrahedralMesh moved = body_mesh;
    for (int step = 1; step <= steps; ++step) {
      MORTISE_ASSIGN_OR_RETURN(ElasticBody stage, ElasticBody::Create(moved, is_fixed, true, once));
      MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd displacement,
                               stage.Displace(prescribed / steps));
      moved.nodes += displacement;
      if (step < steps && !InvertedElements(moved, moved.nodes).empty()) return {std::nullopt};
    }
    return {std::move(moved.nodes)};
  }

  // Returns the elements that are turned over at these places and were sound.
  std::vector<int> Inverted(const Eigen::Matrix3Xd& nodes) const {
    const std::vector<int> all = InvertedElements(corners.mesh, nodes);
    std::vector<int> inverted;
    std::set_difference(all.begin(), all.end(), unsound.begin(), unsound.end(),
                        std::back_inserter(inverted));
    return inverted;
  }

  // Elements between nodes of the surface are as the surface wants them.
  bool IsMovable(int element) const {
    for (int k = 0; k < 4; ++k) {
      if (is_free[static_cast<std::size_t>(corners.mesh.tetrahedra(k, element))]) return true;
    }
    return false;
  }
};

VolumeMapper::VolumeMapper(std::unique_ptr<State> state) : state_(std::move(state)) {}
VolumeMapper::~VolumeMapper() = default;

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

absl::StatusOr<std::unique_ptr<const VolumeMapper>> VolumeMapper::Create(
    const mesh::TetrahedralMesh& mesh, std::vector<int> outer, const VolumeMapOptions& options) {
  auto state = std::make_unique<State>();
  state->mesh = &mesh;
  state->corners = mesh::CornersOf(mesh);
  MORTISE_RETURN_IF_ERROR(CheckOuter(mesh, state->corners, outer));
  const Eigen::Index count = state->corners.mesh.nodes.cols();
  state->is_fixed = Eigen::Array3Xi::Zero(3, count);
  state->is_free.assign(static_cast<std::size_t>(count), true);
  for (const int node : outer) {
    const int corner = state->corners.corner_of[static_cast<std::size_t>(node)];
    state->is_fixed.col(corner) = 1;
    state->is_free[static_cast<std::size_t>(corner)] = false;
  }
  state->outer = std::move(outer);
  MORTISE_ASSIGN_OR_RETURN(state->unsound, UnsoundElements(state->corners.mesh));
  std::vector<int> still = state->unsound;
  for (int e = 0; e < static_cast<int>(mesh.tetrahedra.cols()); ++e) {
    if (!state->IsMovable(e)) still.push_back(e);
  }
  std::sort(still.begin(), still.end());
  still.erase(std::unique(still.begin(), still.end()), still.end());
  state->body_mesh = Without(still, state->corners.mesh);
  state->options.memory_limit = options.memory_limit;
  state->options.threads = options.threads;
  state->options.tolerance = kTolerance;
  state->options.loads = kLoads;
  MORTISE_ASSIGN_OR_RETURN(
      state->body, ElasticBody::Create(state->body_mesh, state->is_fixed, false, state->options));
  return std::unique_ptr<const VolumeMapper>(new VolumeMapper(std::move(state)));
}

absl::StatusOr<VolumeMap> VolumeMapper::Map(const Eigen::Matrix3Xd& positions) const {
  if (positions.cols() != static_cast<Eigen::Index>(state_->outer.size()) ||
      !positions.allFinite()) {
    return InvalidField("positions", "they are not finite, or not as many as 'outer'");
  }
  const mesh::TetrahedralMesh& corners = state_->corners.mesh;
  Eigen::Matrix3Xd prescribed = Eigen::Matrix3Xd::Zero(3, corners.nodes.cols());
  for (std::size_t i = 0; i < state_->outer.size(); ++i) {
    const int corner = state_->corners.corner_of[static_cast<std::size_t>(state_->outer[i])];
    prescribed.col(corner) =
        positions.col(static_cast<Eigen::Index>(i)) - corners.nodes.col(corner);
  }
  VolumeMap map;
  MORTISE_ASSIGN_OR_RETURN(Eigen::Matrix3Xd best, state_->Displace(prescribed, false));
  map.solves = 1;
  map.unsound = static_cast<int>(state_->unsound.size());
  map.inverted = state_->Inverted(best);
  map.inverted_at_first = static_cast<int>(map.inverted.size());
  const auto take = [&](const Eigen::Matrix3Xd& nodes) {
    std::vector<int> inverted = state_->Inverted(nodes);
    if (inverted.size() >= map.inverted.size()) return;
    best = nodes;
    map.inverted = std::move(inverted);
  };
  const auto is_done = [&] {
    return std::none_of(map.inverted.begin(), map.inverted.end(),
                        [this](int element) { return state_->IsMovable(element); });
  };
  if (!is_done()) {
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd nodes, state_->Displace(prescribed, true));
    ++map.solves;
    take(nodes);
  }
  for (int steps = 4; steps <= 16 && !is_done(); steps *= 4) {
    MORTISE_ASSIGN_OR_RETURN(const auto nodes, state_->DisplaceInSteps(prescribed, steps));
    map.solves += steps;
    if (nodes) take(*nodes);
  }
  if (!is_done()) {
    const std::size_t before = map.inverted.size();
    Untangle(corners, state_->is_free, best);
    map.inverted = state_->Inverted(best);
    map.untangled = static_cast<int>(before) - static_cast<int>(map.inverted.size());
  }
  for (std::size_t i = 0; i < state_->outer.size(); ++i) {
    const int corner = state_->corners.corner_of[static_cast<std::size_t>(state_->outer[i])];
    best.col(corner) = positions.col(static_cast<Eigen::Index>(i));
  }
  map.nodes = mesh::AtAllNodes(*state_->mesh, state_->corners, best);
  return map;
}

absl::StatusOr<VolumeMap> MapVolume(const mesh::TetrahedralMesh& mesh,
                                    const std::vector<int>& outer,
                                    const Eigen::Matrix3Xd& positions,
                                    const VolumeMapOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(const auto mapper, VolumeMapper::Create(mesh, outer, options));
  return mapper->Map(positions);
}

}  // namespace mortise::interpolator
