// Samples of a box, or of what cuts leave of it.
#include "services/retrieval/cover/function_manifold.h"

#include <cmath>
#include <utility>

#include "common/assembly/polyhedra/hit_and_run.h"
#include "common/base/errors.h"
#include "common/base/random.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

}  // namespace

FunctionManifold::FunctionManifold(ManifoldFunctions functions)
    : functions_(std::move(functions)),
      constraints_(
          BothConstraints(BoxConstraints(functions_.lower, functions_.upper), functions_.cuts)) {}

absl::StatusOr<std::vector<VectorXd>> FunctionManifold::Sample(int count,
                                                               std::uint64_t seed) const {
  if (functions_.cuts.bounds.size() > 0) {
    MORTISE_ASSIGN_OR_RETURN(
        std::vector<VectorXd> samples,
        parametric::SamplePolyhedron(constraints_.normals, constraints_.bounds, count, seed));
    for (VectorXd& q : samples) q = Rounded(std::move(q));
    return samples;
  }
  Random random(seed);
  std::vector<VectorXd> samples;
  for (int i = 0; i < count; ++i) {
    VectorXd& q = samples.emplace_back(functions_.lower.size());
    for (double& value : q) value = random.Uniform();
    q = Rounded(functions_.lower + q.cwiseProduct(functions_.upper - functions_.lower));
  }
  return samples;
}

absl::StatusOr<VectorXd> FunctionManifold::Evaluate(const VectorXd& q) const {
  return functions_.evaluate(Rounded(q));
}

int FunctionManifold::Structure(const VectorXd& q) const {
  return functions_.structure ? functions_.structure(Rounded(q)) : 0;
}

absl::StatusOr<Derivatives> FunctionManifold::DerivativesAt(const VectorXd& q) const {
  return functions_.derivatives ? functions_.derivatives(Rounded(q)) : Manifold::DerivativesAt(q);
}

VectorXd FunctionManifold::Rounded(VectorXd q) const {
  for (std::size_t i = 0; i < functions_.whole.size(); ++i) {
    double& value = q(static_cast<Eigen::Index>(i));
    if (functions_.whole[i]) value = std::round(value);
  }
  return q;
}

}  // namespace mortise::retrieval
