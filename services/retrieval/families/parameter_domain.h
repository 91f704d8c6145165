// Which parameters a template may have.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/templates/template.h"
#include "services/retrieval/cover/manifold.h"

namespace mortise::retrieval {

// The box of the parameters (K), and what is feasible of it as far as that is known beforehand.
struct ParameterDomain {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  std::vector<bool> whole;  // which take whole numbers alone; choices among them
  // Template::LimitsAmongParameters, each a little within, so that rounding decides nothing; no
  // rows where nothing is known.
  LinearConstraints cuts;
};

// Returns the domain of a template's parameters. Fails as LimitsAmongParameters. It takes up to
// seconds for assemblies of hundreds of parts.
absl::StatusOr<ParameterDomain> DomainOf(const templates::Template& design_template);

// A domain that is found when it is first asked for, and kept. Safe to share between threads.
class KeptDomain {
 public:
  explicit KeptDomain(std::shared_ptr<const templates::Template> design_template)
      : design_template_(std::move(design_template)) {}

  // As DomainOf.
  const absl::StatusOr<ParameterDomain>& Get() const;

 private:
  std::shared_ptr<const templates::Template> design_template_;
  mutable std::once_flag found_;
  mutable absl::StatusOr<ParameterDomain> domain_ = absl::UnknownError("has not been found");
};

}  // namespace mortise::retrieval
