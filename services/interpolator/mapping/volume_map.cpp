#include "services/interpolator/mapping/volume_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
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
constexpr double kUnsound = 1e-3;       // of the volume, that may be turned over to begin with
constexpr std::size_t kHeldBodies = 3;  // that solvers are kept of
constexpr int kLoads = 30;              // that a solver made ready is made for

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

// The body with some components of its corners prescribed.
struct HeldBody {
  Eigen::Array3Xi is_fixed;   // 3 × corners
  std::vector<bool> is_free;  // corners: in all directions
  std::optional<ElasticBody> body, stiffened;
};

struct VolumeMapper::State {
  const mesh::TetrahedralMesh* mesh = nullptr;
  mesh::CornerMesh corners;
  std::vector<int> outer;
  std::vector<int> unsound;         // elements that are turned over or flat to begin with
  mesh::TetrahedralMesh body_mesh;  // the other ones
  simulator::SolverOptions options;
  std::mutex mutex;                            // of what follows
  std::deque<std::shared_ptr<HeldBody>> held;  // the one used last comes first

  int CornerOf(std::size_t i) const {
    return corners.corner_of[static_cast<std::size_t>(outer[i])];
  }

  // Returns the body that is held so, a new one if there is none. The mutex is held.
  std::shared_ptr<HeldBody> Held(const Eigen::Array3Xi& slides) {
    auto wanted = std::make_shared<HeldBody>();
    const Eigen::Index count = corners.mesh.nodes.cols();
    wanted->is_fixed = Eigen::Array3Xi::Zero(3, count);
    wanted->is_free.assign(static_cast<std::size_t>(count), true);
    for (std::size_t i = 0; i < outer.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      wanted->is_fixed.col(CornerOf(i)) = 1;
      if (slides.cols() > 0)
        wanted->is_fixed.col(CornerOf(i)) = (slides.col(column) == 0).cast<int>();
      wanted->is_free[static_cast<std::size_t>(CornerOf(i))] = false;
    }
    const auto known = std::find_if(held.begin(), held.end(), [&](const auto& of) {
      return (of->is_fixed == wanted->is_fixed).all();
    });
    if (known != held.end()) {
      wanted = *known;
      held.erase(known);
    }
    held.push_front(wanted);
    if (held.size() > kHeldBodies) held.pop_back();
    return wanted;
  }

  // Returns where corners are when the surface is displaced. The mutex is held.
  absl::StatusOr<Eigen::Matrix3Xd> Displace(HeldBody& of, const Eigen::Matrix3Xd& prescribed,
                                            bool is_stiffened) const {
    std::optional<ElasticBody>& body = is_stiffened ? of.stiffened : of.body;
    if (!body) {
      MORTISE_ASSIGN_OR_RETURN(body,
                               ElasticBody::Create(body_mesh, of.is_fixed, is_stiffened, options));
    }
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd moved, body->Displace(prescribed));
    return (corners.mesh.nodes + moved).eval();
  }

  // Returns where they are after as many steps, each on the shape before. Nothing, where elements
  // are turned over after a step that is not the last.
  absl::StatusOr<std::optional<Eigen::Matrix3Xd>> DisplaceInSteps(
      const HeldBody& of, const Eigen::Matrix3Xd& prescribed, int steps) const {
    simulator::SolverOptions once = options;
    once.loads = 1;
    mesh::TetrahedralMesh moved = body_mesh;
    for (int step = 1; step <= steps; ++step) {
      MORTISE_ASSIGN_OR_RETURN(ElasticBody stage,
                               ElasticBody::Create(moved, of.is_fixed, true, once));
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
  bool IsMovable(const HeldBody& of, int element) const {
    for (int k = 0; k < 4; ++k) {
      if ((of.is_fixed.col(corners.mesh.tetrahedra(k, element)) == 0).any()) return true;
    }
    return false;
  }
};

// Searches for the shape with the fewest elements turned over.
class VolumeMapping {
 public:
  VolumeMapping(const VolumeMapper::State& state, HeldBody& body,
                const Eigen::Matrix3Xd& prescribed)
      : state_(state), body_(body), prescribed_(prescribed) {
    map_.unsound = static_cast<int>(state.unsound.size());
  }

  // Returns the map without nodes, and `corners` where they are.
  absl::StatusOr<VolumeMap> Run(Eigen::Matrix3Xd& corners) {
    MORTISE_ASSIGN_OR_RETURN(corners, state_.Displace(body_, prescribed_, false));
    map_.solves = 1;
    map_.inverted = state_.Inverted(corners);
    map_.inverted_at_first = static_cast<int>(map_.inverted.size());
    if (!IsDone()) {
      MORTISE_ASSIGN_OR_RETURN(const auto nodes, state_.Displace(body_, prescribed_, true));
      ++map_.solves;
      Take(nodes, corners);
    }
    for (int steps = 4; steps <= 16 && !IsDone(); steps *= 4) {
      MORTISE_ASSIGN_OR_RETURN(const auto nodes, state_.DisplaceInSteps(body_, prescribed_, steps));
      map_.solves += steps;
      if (nodes) Take(*nodes, corners);
    }
    if (!IsDone()) {
      Eigen::Matrix3Xd untangled = corners;
      Untangle(state_.corners.mesh, body_.is_free, untangled);
      const std::size_t before = map_.inverted.size();
      // It raises the least volume around a node, which may cost another element its own.
      Take(untangled, corners);
      map_.untangled = static_cast<int>(before - map_.inverted.size());
    }
    return std::move(map_);
  }

 private:
  bool IsDone() const {
    return std::none_of(map_.inverted.begin(), map_.inverted.end(),
                        [this](int element) { return state_.IsMovable(body_, element); });
  }

  void Take(const Eigen::Matrix3Xd& nodes, Eigen::Matrix3Xd& best) {
    std::vector<int> inverted = state_.Inverted(nodes);
    if (inverted.size() >= map_.inverted.size()) return;
    best = nodes;
    map_.inverted = std::move(inverted);
  }

  const VolumeMapper::State& state_;
  HeldBody& body_;
  const Eigen::Matrix3Xd& prescribed_;
  VolumeMap map_;
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
  MORTISE_ASSIGN_OR_RETURN(state->unsound, UnsoundElements(state->corners.mesh));
  state->body_mesh = Without(state->unsound, state->corners.mesh);
  state->outer = std::move(outer);
  state->options.memory_limit = options.memory_limit;
  state->options.threads = options.threads;
  state->options.tolerance = kTolerance;
  state->options.loads = kLoads;
  return std::unique_ptr<const VolumeMapper>(new VolumeMapper(std::move(state)));
}

absl::StatusOr<VolumeMap> VolumeMapper::Map(const Eigen::Matrix3Xd& positions,
                                            const Eigen::Array3Xi& slides) const {
  State& state = *state_;
  if (positions.cols() != static_cast<Eigen::Index>(state.outer.size()) || !positions.allFinite()) {
    return InvalidField("positions", "they are not finite, or not as many as 'outer'");
  }
  if (slides.cols() != 0 && slides.cols() != positions.cols()) {
    return InvalidField("slides", "they are not as many as 'outer'");
  }
  const std::scoped_lock lock(state.mutex);
  const std::shared_ptr<HeldBody> body = state.Held(slides);
  const Eigen::Matrix3Xd& rest = state.corners.mesh.nodes;
  Eigen::Matrix3Xd goal = rest;
  for (std::size_t i = 0; i < state.outer.size(); ++i) {
    goal.col(state.CornerOf(i)) = positions.col(static_cast<Eigen::Index>(i));
  }
  const Eigen::Matrix3Xd prescribed =
      (body->is_fixed != 0).select((goal - rest).array(), 0.0).matrix();
  Eigen::Matrix3Xd corners;
  MORTISE_ASSIGN_OR_RETURN(VolumeMap map, VolumeMapping(state, *body, prescribed).Run(corners));
  // To the bit, which adding displacements is not.
  corners = (body->is_fixed != 0).select(goal.array(), corners.array()).matrix();
  map.nodes = mesh::AtAllNodes(*state.mesh, state.corners, corners);
  return map;
}

}  // namespace mortise::interpolator
