// A template's designs as surfaces that are fitted to others.
#pragma once

#include <memory>

#include "common/templates/template.h"
#include "services/retrieval/fit/family_member.h"

namespace mortise::retrieval {

// The surfaces of all designs of the template within the ranges of its parameters. Safe to share
// between threads.
FitFamily SurfacesOf(std::shared_ptr<const templates::Template> function);

}  // namespace mortise::retrieval
