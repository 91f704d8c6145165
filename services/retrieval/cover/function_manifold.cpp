// Samples of a box, kept where the cuts allow them.
#include "services/retrieval/cover/function_manifold.h"

#include "common/base/errors.h"
#include "common/base/random.h"

namespace mortise::retrieval {
namespace {

using Eigen::VectorXd;

constexpr long kTriesPerSample = 10'000;

LinearConstraints Joined(const LinearConstraints& box, const LinearConstraints& cuts) {
  if (cuts.bounds.size() == 0) return box;
  LinearConstraints all;
  all.normals.resize(box.normals.rows() + cuts.normals.rows(), box.normals.cols());
  all.normals << box.normals, cuts.normals;
  all.bounds.resize(box.bounds.size() + cuts.bounds.size());
  all.bounds << box.bounds, cuts.bounds;
  return all;
}

}  // namespace

FunctionManifold::FunctionManifold(ManifoldFunctions functions)
    : functions_(std::move(functions)),
      constraints_(Joined(BoxConstraints(functions_.lower, functions_.upper), functions_.cuts)) {}

absl::StatusOr<std::vector<VectorXd>> FunctionManifold::Sample(int count,
                                                               std::uint64_t seed) const {
  Random random(seed);
  std::vector<VectorXd> samples;
  for (long tries = kTriesPerSample * count; static_cast<int>(samples.size()) < count; --tries) {
    if (tries == 0) {
      return PreconditionFailed("FEASIBLE_SET_THIN", "hardly anything in the box is feasible");
    }
    VectorXd q(functions_.lower.size());
    for (double& value : q) value = random.Uniform();
    q = functions_.lower + q.cwiseProduct(functions_.upper - functions_.lower);
    const bool fits = functions_.cuts.bounds.size() == 0 ||
                      (functions_.cuts.normals * q - functions_.cuts.bounds).maxCoeff() <= 0;
    if (fits) samples.push_back(std::move(q));
  }
  return samples;
}

absl::StatusOr<VectorXd> FunctionManifold::Evaluate(const VectorXd& q) const {
  return functions_.evaluate(q);
}

int FunctionManifold::Structure(const VectorXd& q) const {
  return functions_.structure ? functions_.structure(q) : 0;
}

absl::StatusOr<Derivatives> FunctionManifold::DerivativesAt(const VectorXd& q) const {
  return functions_.derivatives ? functions_.derivatives(q) : Manifold::DerivativesAt(q);
}

}  // namespace mortise::retrieval
