#include "services/retrieval/families/described_designs.h"

#include <utility>

#include "common/base/errors.h"
#include "services/retrieval/families/design_surface.h"

namespace mortise::retrieval {
namespace {

// As covers of solids make no more (family_cover.cpp), by far: no other is kept.
constexpr std::size_t kMaxKept = 4096;

std::string KeyOf(const Eigen::VectorXd& q) {
  return {reinterpret_cast<const char*>(q.data()),
          static_cast<std::size_t>(q.size()) * sizeof(double)};
}

}  // namespace

DescribedDesigns::DescribedDesigns(std::shared_ptr<const templates::Template> function,
                                   std::vector<std::shared_ptr<const Descriptor>> descriptors)
    : function_(std::move(function)), descriptors_(std::move(descriptors)) {}

std::shared_ptr<const DescribedDesign> DescribedDesigns::Make(const Eigen::VectorXd& q) const {
  auto described = std::make_shared<DescribedDesign>();
  absl::StatusOr<parametric::EvaluatedDesign> design = function_->Evaluate(q);
  if (!design.ok()) {
    described->vectors.assign(descriptors_.size(), design.status());
    return described;
  }
  const mesh::SurfaceMesh surface = DesignSurface(*design);
  for (const auto& descriptor : descriptors_) {
    described->vectors.push_back(descriptor->Describe(surface));
  }
  if (design->structure) described->structure = *std::move(design->structure);
  return described;
}

std::shared_ptr<const DescribedDesign> DescribedDesigns::At(const Eigen::VectorXd& q) {
  const std::string key = KeyOf(q);
  {
    const std::lock_guard lock(mutex_);
    const auto found = known_.find(key);
    if (found != known_.end()) return found->second;
  }
  std::shared_ptr<const DescribedDesign> described = Make(q);
  const std::lock_guard lock(mutex_);
  ++made_;
  if (known_.size() < kMaxKept) known_.emplace(key, described);
  return described;
}

long DescribedDesigns::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

}  // namespace mortise::retrieval
