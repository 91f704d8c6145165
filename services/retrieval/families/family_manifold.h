// A template's designs as a manifold in the space of a descriptor: M(q) = D(F(q)) (thesis §4.3,
// Figure 4-2).
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "common/templates/template.h"
#include "services/retrieval/cover/function_manifold.h"
#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

// The manifold over the template's parameters within their ranges. The designs with the default's
// structure are described through one choice of points on it, so that the manifold is as smooth as
// its descriptor; those of other structures each by itself. Designs that cannot be made, as sizes
// that no assembly has together, fail. Fails where the default design cannot be made or described.
absl::StatusOr<std::unique_ptr<Manifold>> MakeFamilyManifold(
    std::shared_ptr<const templates::Template> function,
    std::shared_ptr<const Descriptor> descriptor);

}  // namespace mortise::retrieval
