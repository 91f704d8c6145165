#include "common/fem/problems/modal_analysis.h"

#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/fem/elements/internal_forces.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/elements/supports.h"
#include "common/fem/mechanisms/free_motions.h"

namespace mortise::simulator {
namespace {

// A frequency found beside others counts as lower than the highest of them by more than this share.
constexpr double kLower = 1e-6;

constexpr int kRestarts = 200;

// What of a vector found counts as nothing beside those that are known.
constexpr double kNothing = 1e-6;

// The same of free motions, which are known not to depend on each other: rounding. What only a very
// light body does is little of what a heavy one does as well.
constexpr double kNoMotion = 1e-14;

// Vectors that are held of each free motion: it, its product with the mass and its shape, which
// stay, and its displacement or what is left of it while displacements to hold are chosen.
constexpr double kKeptVectors = 3;
constexpr double kMaxVectors = 4;

// K⁻¹, M and the solutions that are known, on the free displacements in one vector.
class Vibration {
 public:
  Vibration(const Eigen::Array3Xi& fixed, const BlockMatrix& mass, ThreadTeam& team)
      : nodes_(fixed.cols()), mass_(mass), team_(team) {
    for (Eigen::Index k = 0; k < fixed.size(); ++k) {
      if (!fixed.data()[k]) free_.push_back(k);
    }
  }

  Eigen::Index size() const { return static_cast<Eigen::Index>(free_.size()); }
  int solves() const { return solves_; }
  const absl::Status& status() const { return status_; }

  Eigen::Matrix3Xd Expand(const Eigen::VectorXd& vector) const {
    Eigen::Matrix3Xd all = Eigen::Matrix3Xd::Zero(3, nodes_);
    for (Eigen::Index k = 0; k < size(); ++k) all.data()[free_[k]] = vector[k];
    return all;
  }

  Eigen::VectorXd Compress(const Eigen::Matrix3Xd& all) const {
    Eigen::VectorXd vector(size());
    for (Eigen::Index k = 0; k < size(); ++k) vector[k] = all.data()[free_[k]];
    return vector;
  }

  Eigen::VectorXd MultiplyMass(const Eigen::VectorXd& vector) const {
    Eigen::Matrix3Xd product;
    mass_.Multiply(Expand(vector), product, team_);
    return Compress(product);
  }

  // Takes the known vectors' share out of `vector`, twice for the sake of rounding.
  void Deflate(Eigen::VectorXd& vector) const {
    for (int round = 0; round < 2; ++round) {
      for (std::size_t k = 0; k < known_.size(); ++k) {
        vector -= known_[k] * mass_known_[k].dot(vector);
      }
    }
  }

  // Adds to the known vectors what of `vector` is not among them, unless that is nothing: less than
  // `least` of it in the norm of mass.
  void Know(Eigen::VectorXd vector, double least) {
    const double before = std::sqrt(vector.dot(MultiplyMass(vector)));
    Deflate(vector);
    Eigen::VectorXd product = MultiplyMass(vector);
    const double size = std::sqrt(vector.dot(product));
    if (!(size > least * before)) return;
    known_.push_back(vector / size);
    mass_known_.push_back(product / size);
  }

  // All that is known so far moves without deforming. Returns which displacements (3 × nodes),
  // beside those of supports, must be held so that none of it is free: those that it moves most.
  Eigen::Array3Xi HoldKnown() {
    rigid_ = known_.size();
    Eigen::Array3Xi held = Eigen::Array3Xi::Zero(3, nodes_);
    Eigen::MatrixXd moved(static_cast<Eigen::Index>(rigid_), size());
    for (std::size_t k = 0; k < rigid_; ++k) moved.row(k) = known_[k].transpose();
    for (std::size_t k = 0; k < rigid_; ++k) {
      Eigen::Index most = 0;
      moved.colwise().squaredNorm().maxCoeff(&most);
      held.data()[free_[most]] = 1;
      const Eigen::VectorXd direction = moved.col(most).normalized();
      // Without a copy of them all.
      const Eigen::RowVectorXd along = direction.transpose() * moved;
      moved.noalias() -= direction * along;
    }
    return held;
  }

  // Solves with a factor of K with these displacements held from now on.
  void Use(SparseCholesky factor) { factor_ = std::move(factor); }

  Eigen::VectorXd Solve(Eigen::VectorXd load) {
    ++solves_;
    // A load that would move what is free is balanced by inertia.
    for (std::size_t k = 0; k < rigid_; ++k) load -= mass_known_[k] * known_[k].dot(load);
    auto solution = factor_->Solve(Expand(load));
    if (!solution.ok()) {
      status_ = solution.status();
      return Eigen::VectorXd::Zero(size());
    }
    Eigen::VectorXd vector = Compress(*solution);
    Deflate(vector);
    return vector;
  }

  const std::vector<Eigen::VectorXd>& known() const { return known_; }

 private:
  Eigen::Index nodes_;
  const BlockMatrix& mass_;
  std::optional<SparseCholesky> factor_;
  ThreadTeam& team_;
  std::vector<Eigen::Index> free_;
  std::vector<Eigen::VectorXd> known_, mass_known_;  // M-orthonormal, and M times each
  std::size_t rigid_ = 0;  // of these, the first ones, which move without deforming
  int solves_ = 0;
  absl::Status status_;
};

// The two operators as Spectra calls them.
struct SolveOperator {
  using Scalar = double;
  Vibration& vibration;
  Eigen::Index rows() const { return vibration.size(); }
  Eigen::Index cols() const { return vibration.size(); }
  void set_shift(double) {}
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()) =
        vibration.Solve(Eigen::Map<const Eigen::VectorXd>(in, rows()));
  }
};
struct MassOperator {
  using Scalar = double;
  Vibration& vibration;
  Eigen::Index rows() const { return vibration.size(); }
  Eigen::Index cols() const { return vibration.size(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()) =
        vibration.MultiplyMass(Eigen::Map<const Eigen::VectorXd>(in, rows()));
  }
};

struct Pair {
  double eigenvalue;  // ω², 1/s²
  Eigen::VectorXd vector;
};

// A start that no symmetry of the body makes orthogonal to a mode.
Eigen::VectorXd StartVector(Eigen::Index size) {
  Eigen::VectorXd start(size);
  double seed = 0.5;
  for (double& value : start) {
    seed = std::fmod(seed * 997 + 0.618033988749895, 1.0);
    value = seed - 0.5;
  }
  return start;
}

absl::Status NotConverged(int count) {
  return PreconditionFailed("NOT_CONVERGED",
                            absl::StrCat("not all of ", count, " modes were found"), "count");
}

// The `count` lowest pairs beside the known vectors.
absl::StatusOr<std::vector<Pair>> Iterate(Vibration& vibration, int count, double tolerance) {
  const Eigen::Index space = vibration.size() - vibration.known().size();
  const Eigen::Index basis = std::min<Eigen::Index>(space, std::max(2 * count + 1, count + 20));
  SolveOperator solve{vibration};
  MassOperator mass{vibration};
  std::vector<Pair> pairs;
  try {
    Spectra::SymGEigsShiftSolver<SolveOperator, MassOperator, Spectra::GEigsMode::ShiftInvert>
        solver(solve, mass, count, basis, 0);
    Eigen::VectorXd start = StartVector(vibration.size());
    vibration.Deflate(start);
    solver.init(start.data());
    solver.compute(Spectra::SortRule::LargestMagn, kRestarts, tolerance,
                   Spectra::SortRule::SmallestAlge);
    MORTISE_RETURN_IF_ERROR(vibration.status());
    if (solver.info() == Spectra::CompInfo::Successful) {
      const Eigen::VectorXd values = solver.eigenvalues();
      const Eigen::MatrixXd vectors = solver.eigenvectors();
      for (Eigen::Index k = 0; k < values.size(); ++k) pairs.push_back({values[k], vectors.col(k)});
    }
  } catch (const std::exception&) {
    // Its words are about its own matrices.
    MORTISE_RETURN_IF_ERROR(vibration.status());
    return NotConverged(count);
  }
  if (static_cast<int>(pairs.size()) < count) return NotConverged(count);
  return pairs;
}

bool Lower(const Pair& a, const Pair& b) { return a.eigenvalue < b.eigenvalue; }

// Lanczos' method sees one vector of a multiple eigenvalue's space, but for rounding: look again
// beside what was found.
absl::StatusOr<std::vector<Pair>> LowestPairs(Vibration& vibration, int count, double tolerance) {
  MORTISE_ASSIGN_OR_RETURN(std::vector<Pair> pairs, Iterate(vibration, count, tolerance));
  for (const Pair& pair : pairs) vibration.Know(pair.vector, kNothing);
  while (vibration.size() - static_cast<Eigen::Index>(vibration.known().size()) > 2) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<Pair> more, Iterate(vibration, 1, tolerance));
    const double highest = std::max_element(pairs.begin(), pairs.end(), Lower)->eigenvalue;
    if (!(more[0].eigenvalue < (1 - kLower) * highest)) break;
    pairs.push_back(more[0]);
    vibration.Know(more[0].vector, kNothing);
  }
  std::sort(pairs.begin(), pairs.end(), Lower);
  pairs.resize(count);
  return pairs;
}

// The mode of a vector on the free displacements, which is a shape in space and has these elastic
// forces. Rayleigh's quotient is as exact as the shape is twice over, and free of the rounding of
// K.
Mode ModeOf(const Eigen::VectorXd& vector, const Eigen::Matrix3Xd& shape,
            const Eigen::VectorXd& elastic, const Vibration& vibration) {
  const Eigen::VectorXd inertia = vibration.MultiplyMass(vector);
  const double mass = vector.dot(inertia);
  const double squared = vector.dot(elastic) / mass;
  Mode mode;
  mode.frequency = std::sqrt(std::max(squared, 0.0)) / (2 * M_PI);
  mode.shape = shape / std::sqrt(mass);
  mode.residual = (elastic - squared * inertia).norm() / elastic.norm();
  return mode;
}

double TotalMass(const BlockMatrix& mass, const NodeFrames& frames, ThreadTeam& team) {
  Eigen::Matrix3Xd shift = Eigen::Matrix3Xd::Zero(3, mass.nodes()), product;
  shift.row(0).setOnes();
  shift = frames.ToFrames(std::move(shift));
  mass.Multiply(shift, product, team);
  return (shift.array() * product.array()).sum();
}

// Takes what the free motions need of the memory that is left for the factor.
absl::Status MakeRoom(const FreeMotions& free, Eigen::Index nodes, CholeskyOptions& cholesky) {
  const std::string what = absl::StrCat("a structure with ", free.count, " free motions");
  if (free.count > kMaxMotions) return TooLarge(what, absl::StrCat(kMaxMotions, " of them"));
  const double bytes = 3.0 * sizeof(double) * static_cast<double>(nodes) * free.count;
  if (kMaxVectors * bytes > cholesky.memory_limit) {
    return TooLarge(
        absl::StrFormat("%s of %d nodes, %.3g GB,", what, nodes, 1e-9 * kMaxVectors * bytes),
        absl::StrFormat("%.3g GB", 1e-9 * cholesky.memory_limit));
  }
  cholesky.memory_limit -= kKeptVectors * bytes;
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ModalSolution> FindModes(const mesh::TetrahedralMesh& mesh,
                                        const std::vector<Material>& materials,
                                        const std::vector<Support>& supports,
                                        const ModalOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  MORTISE_RETURN_IF_ERROR(CheckMesh(mesh));
  MORTISE_RETURN_IF_ERROR(CheckNodesAreUsed(mesh));
  MORTISE_RETURN_IF_ERROR(CheckModel(mesh, materials, supports));
  MORTISE_ASSIGN_OR_RETURN(const Constraints constraints, CollectConstraints(mesh, supports));
  const NodeFrames& frames = constraints.frames;
  ThreadTeam team(options.threads);
  MORTISE_ASSIGN_OR_RETURN(const BlockMatrix stiffness,
                           AssembleStiffness(mesh, materials, frames, team));
  MORTISE_ASSIGN_OR_RETURN(const BlockMatrix mass,
                           AssembleMass(mesh, materials, frames, stiffness.pattern(), team));
  const FreeMotions free = FindFreeMotions(mesh, constraints);
  CholeskyOptions cholesky = options.cholesky;
  MORTISE_RETURN_IF_ERROR(MakeRoom(free, mesh.nodes.cols(), cholesky));
  Vibration vibration(constraints.fixed, mass, team);
  for (const Eigen::Matrix3Xd& motion : Displacements(free, mesh)) {
    vibration.Know(vibration.Compress(frames.ToFrames(motion)), kNoMotion);
  }
  const Eigen::Index space = vibration.size() - vibration.known().size();
  if (options.count < 1 || options.count >= space - 1) {
    return InvalidField("count", absl::StrCat("must be positive and below ", space - 1,
                                              ", what this mesh can deform by"));
  }
  ModalSolution solution;
  solution.rigid_motions = static_cast<int>(vibration.known().size());
  if (free.count > 0) solution.rigid_motion = MotionText(free, mesh);
  solution.mass = TotalMass(mass, frames, team);
  for (const Eigen::VectorXd& motion : vibration.known()) {
    solution.modes.push_back({0, true, frames.ToSpace(vibration.Expand(motion)), 0});
  }
  MORTISE_ASSIGN_OR_RETURN(
      SparseCholesky factor,
      SparseCholesky::Create(stiffness, constraints.fixed + vibration.HoldKnown(), cholesky));
  vibration.Use(std::move(factor));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Pair> pairs,
                           LowestPairs(vibration, options.count, options.tolerance));
  for (const Pair& pair : pairs) {
    const Eigen::Matrix3Xd shape = frames.ToSpace(vibration.Expand(pair.vector));
    const Eigen::Matrix3Xd elastic = InternalForces(mesh, materials, shape, team);
    solution.modes.push_back(
        ModeOf(pair.vector, shape, vibration.Compress(frames.ToFrames(elastic)), vibration));
  }
  std::stable_sort(solution.modes.begin() + solution.rigid_motions, solution.modes.end(),
                   [](const Mode& a, const Mode& b) { return a.frequency < b.frequency; });
  solution.solves = vibration.solves();
  solution.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return solution;
}

std::string NoteOnRigidMotions(const ModalSolution& solution) {
  if (solution.rigid_motions == 0) return "";
  return absl::StrCat(solution.rigid_motions,
                      solution.rigid_motions == 1 ? " mode at 0 Hz moves" : " modes at 0 Hz move",
                      " something without deforming it: ", solution.rigid_motion);
}

}  // namespace mortise::simulator
