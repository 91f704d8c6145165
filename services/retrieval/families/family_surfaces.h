// A template's designs as surfaces that are fitted to others.
#pragma once

#include <memory>

#include "common/templates/template.h"
#include "services/retrieval/families/parameter_domain.h"
#include "services/retrieval/fit/family_member.h"

namespace mortise::retrieval {

// Returns the surfaces of all designs of the template within the domain of its parameters. Safe to
// share between threads.
FitFamily SurfacesOf(std::shared_ptr<const templates::Template> function,
                     const ParameterDomain& domain);

}  // namespace mortise::retrieval
