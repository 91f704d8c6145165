// A template's designs as a manifold in the space of a descriptor: M(q) = D(F(q)) (thesis §4.3,
// Figure 4-2).
#pragma once

#include <cstddef>
#include <memory>

#include "absl/status/statusor.h"
#include "common/templates/template.h"
#include "services/retrieval/cover/function_manifold.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/families/described_designs.h"

namespace mortise::retrieval {

// Returns the manifold over all parameters with which the template has a design. The box of their
// ranges is cut by what the template knows of limits among them (Template::LimitsAmongParameters):
// for an assembly that leaves the shadow of its FeasibleSet on the lengths that are its parameters,
// so that each point of it is z that can be chosen, distances to the boundary (thesis 4.5) are
// those of the feasible set, and what a primitive stores is the template's own parameters. The
// parameters of an assembly are sizes, linear in z; what they leave open of z the template chooses
// (F(q) is the design nearest to the drawn one), and a search could not ask for it.
//
// Designs of one structure are described through one choice of points on one of them, so that the
// manifold is as smooth as its descriptor; the structures that some of 256 samples have are known
// beforehand, and designs of others are described each by itself, as are those of templates whose
// designs are meshed anew each time.
//
// Where a descriptor differentiates exactly, so does the manifold: by the velocities of the
// vertices, which are differences that are exact where vertices are linear or quadratic in the
// parameters, as those of assemblies are.
//
// Designs that cannot be made fail. Fails itself where the default design cannot be made or
// described.
//
// `shared`: where designs are meshed anew each time, they come from there, and are made once for
// all descriptors; `place` is that of this descriptor among them. It changes nothing of the
// manifold.
absl::StatusOr<std::unique_ptr<Manifold>> MakeFamilyManifold(
    std::shared_ptr<const templates::Template> function,
    std::shared_ptr<const Descriptor> descriptor,
    std::shared_ptr<DescribedDesigns> shared = nullptr, std::size_t place = 0);

}  // namespace mortise::retrieval
