// Bodies of models that random scripts make of what ships, as messages: what the catalog would keep
// if they were saved.
#pragma once

#include "absl/status/statusor.h"
#include "mortise/v1/template.pb.h"
#include "tests/unit/services/composer/scripts/random_script.h"

namespace mortise::composer {

// Returns a template of the body, as it is now, with everything that it is made of. Its handles are
// not filled in yet (templates::FillAndCheck). Shapes of its own are in it as they are, which the
// service has the catalog read from a file. Fails as DrawAnew.
absl::StatusOr<v1::TemplateBundle> ComposedTemplate(const ComposedBody& body,
                                                    const std::string& id);

}  // namespace mortise::composer
