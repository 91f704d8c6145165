// Says which parts of a model stand for those that a connection of a component's original design
// holds (thesis §5.6.1).
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/composer/connecting/candidate.h"
#include "services/composer/connecting/linked_parts.h"

namespace mortise::composer {

// Returns a connection of the original with the component's parts for those inside of it, and for
// those outside the linked parts of the body whose boxes are nearest, of the same material, or of
// any where they only touch; nothing if it is all inside, or outside, or nothing stands for some
// principals: these are `missing`. `fitted` are the original's principal parts where they would be
// in the model (FitOriginal), by name.
std::optional<Candidate> BindOriginal(
    const CollectionConnection& connection, const BothSides& sides,
    const std::vector<LinkedPair>& linked,
    const std::map<std::string, const PrincipalPart*>& fitted,
    const std::function<bool(const std::string& item, const std::string& other)>& same_material,
    std::set<std::string>& missing);

}  // namespace mortise::composer
