// Excises a node from a working model (thesis §5.4).
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

// Returns the design drawn as it is now without what is below `node`, which names a group, a part
// or the parts of a row as SubTreeOf says. With it go all connecting parts of connections one of
// whose principals goes, joints that move nothing any more, and groups that nothing is in. What
// relationships there were with it are gone when the rest is parametrised.
//
// INVALID_ARGUMENT, "node", where nothing is called so; FAILED_PRECONDITION, NOTHING_LEFT, where no
// principal part would be left.
absl::StatusOr<parametric::Assembly> WithoutNode(const Design& design, const std::string& node);

}  // namespace mortise::composer
