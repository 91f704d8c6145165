// Designs of one template as several descriptors describe them, each made once.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/templates/template.h"
#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

// A design, by each of the descriptors.
struct DescribedDesign {
  std::vector<absl::StatusOr<Eigen::VectorXd>>
      vectors;  // fails where it cannot be made or described
  parametric::Structure structure = {};
};

// For templates whose designs take much longer to make than to describe, as solids do: covers of a
// family by several descriptors begin with the same designs, and what each made is described by
// all. What comes of it is what describing each by itself gives. Thread safe.
class DescribedDesigns {
 public:
  DescribedDesigns(std::shared_ptr<const templates::Template> function,
                   std::vector<std::shared_ptr<const Descriptor>> descriptors);

  // Returns the design at q; vectors are in the order of the descriptors.
  std::shared_ptr<const DescribedDesign> At(const Eigen::VectorXd& q);

  // Returns how many designs were made.
  long made() const;

 private:
  std::shared_ptr<const DescribedDesign> Make(const Eigen::VectorXd& q) const;

  const std::shared_ptr<const templates::Template> function_;
  const std::vector<std::shared_ptr<const Descriptor>> descriptors_;
  mutable std::mutex mutex_;
  // By the bytes of q; guarded by mutex_, as is `made_`.
  std::unordered_map<std::string, std::shared_ptr<const DescribedDesign>> known_;
  long made_ = 0;
};

}  // namespace mortise::retrieval
