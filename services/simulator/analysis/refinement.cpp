#include "services/simulator/analysis/refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "services/simulator/analysis/mesh_analysis.h"

namespace mortise::simulator {
namespace {

// How many elements RefineMesh adds for each that the sizes take at least: elements have half the
// volume that they may have, and those beside small ones are smaller than asked.
constexpr double kAddedForEach = 2.5;
// The largest element's edge over the mean one's.
constexpr double kMaxToMean = 1.25;
constexpr double kWorthwhile = 1.2;  // a mesh with fewer times as many elements changes nothing

}  // namespace

void Refinement::GiveUp(const std::string& reason) {
  shortfall_ = absl::StrFormat("the error is %.2g %%, not %.2g %%, after %d meshes: %s",
                               100 * steps_.back().relative_error, 100 * options_.wanted_error,
                               steps_.size(), reason);
}

std::optional<mesh::TetrahedralMesh> Refinement::Stop(const std::string& reason) {
  GiveUp(reason);
  return std::nullopt;
}

bool Refinement::Affords(const mesh::TetrahedralMesh& mesh, double elements) const {
  if (elements > options_.mesh.element_limit) return false;
  const double nodes = elements * static_cast<double>(mesh.nodes.cols()) /
                       static_cast<double>(mesh.tetrahedra.cols());
  return CheckMemory(static_cast<Eigen::Index>(nodes), static_cast<Eigen::Index>(elements), 1,
                     options_.memory_limit)
      .ok();
}

absl::StatusOr<std::optional<mesh::TetrahedralMesh>> Refinement::Next(
    const mesh::TetrahedralMesh& mesh, std::span<const ErrorEstimate> estimates) {
  const double wanted = options_.wanted_error;
  if (!(wanted >= 0.001 && wanted <= 1)) {
    return InvalidField("wanted_error", "must be within 0.001 to 1");
  }
  RefinementStep step{static_cast<int>(mesh.tetrahedra.cols()), static_cast<int>(mesh.nodes.cols()),
                      0};
  Eigen::VectorXd sizes;
  for (const ErrorEstimate& estimate : estimates) {
    step.relative_error = std::max(step.relative_error, estimate.relative);
    if (estimate.relative <= wanted) continue;
    const Eigen::VectorXd own = kMaxToMean * ElementSizes(mesh, estimate, wanted);
    sizes = sizes.size() == 0 ? own : sizes.cwiseMin(own).eval();
  }
  steps_.push_back(step);
  if (sizes.size() == 0) return std::nullopt;
  if (static_cast<int>(steps_.size()) > options_.most_rounds) return Stop("no more are tried");
  const auto expected = [&] {
    return step.elements + kAddedForEach * (mesh::EstimateRefinement(mesh, sizes) - step.elements);
  };
  bool is_limited = false;  // to fewer elements than the accuracy takes
  while (!is_limited || expected() >= kWorthwhile * step.elements) {
    if (!Affords(mesh, expected())) {
      sizes *= 1.1;
      is_limited = true;
      continue;
    }
    absl::StatusOr<mesh::TetrahedralMesh> finer = mesh::RefineMesh(mesh, sizes, options_.mesh);
    const bool is_too_large =
        absl::IsResourceExhausted(finer.status()) ||
        (finer.ok() && !Affords(*finer, static_cast<double>(finer->tetrahedra.cols())));
    if (!is_too_large) {
      if (!finer.ok()) return Stop(std::string(finer.status().message()));
      return std::optional<mesh::TetrahedralMesh>(*std::move(finer));
    }
    sizes *= 1.2;
    is_limited = true;
  }
  return Stop("a finer one would go beyond the limits of memory or elements");
}

}  // namespace mortise::simulator
