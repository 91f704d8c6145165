#include "services/pareto/discovery/discovery_options.h"

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::pareto {
namespace {

constexpr Eigen::Index kMaxMetrics = 6;
constexpr std::int64_t kMaxEvaluations = 10'000'000;
constexpr int kMaxWindow = 4096;
constexpr int kMaxCells = 10'000;
constexpr int kMaxConstraints = 64;

absl::Status CheckInitialDesigns(const DesignSpace& space, const DiscoveryOptions& options) {
  const Eigen::MatrixXd& designs = options.initial_designs;
  if (designs.cols() == 0) return absl::OkStatus();
  if (designs.cols() >= options.evaluations) {
    return InvalidField("initial_designs", absl::StrCat(designs.cols(), " are as many as the ",
                                                        options.evaluations, " evaluations"));
  }
  if (designs.rows() != space.size()) {
    return InvalidField("initial_designs",
                        absl::StrCat("need ", space.size(), " parameters, not ", designs.rows()));
  }
  for (Eigen::Index i = 0; i < designs.cols(); ++i) {
    if (designs.col(i) != space.Nearest(designs.col(i))) {
      return InvalidField(absl::StrCat("initial_designs[", i, "]"), "is not in the design space");
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(const DiscoveryOptions& options, const DesignSpace& space,
                      Eigen::Index metric_count) {
  if (metric_count < 1 || metric_count > kMaxMetrics) {
    return InvalidField("objectives", absl::StrCat("1 to 6 are possible, not ", metric_count));
  }
  if (options.evaluations < 1 || options.evaluations > kMaxEvaluations) {
    return InvalidField("evaluations", absl::StrCat("must lie between 1 and ", kMaxEvaluations));
  }
  if (options.window < 1 || options.window > kMaxWindow) {
    return InvalidField("window", "must lie between 1 and 4096");
  }
  if (options.cells_per_angle < 0 || options.cells_per_angle > kMaxCells) {
    return InvalidField("cells", "must lie between 1 and 10000, or be 0 for the default");
  }
  if (options.constraints < 0 || options.constraints > kMaxConstraints) {
    return InvalidField("constraints", absl::StrCat("at most ", kMaxConstraints, " are possible"));
  }
  if (options.initial_samples < 0) return InvalidField("initial_samples", "must not be negative");
  return CheckInitialDesigns(space, options);
}

}  // namespace mortise::pareto
