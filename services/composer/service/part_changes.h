// What differs between two states of the parts of a design.
#pragma once

#include <vector>

#include "mortise/v1/composer.pb.h"

namespace mortise::composer {

// Adds to a preview the parts that lie elsewhere after than before, by more than a nanometre, that
// are there only after, and that were there only before. Names are distinct. O(parts).
void AddChanges(const std::vector<v1::ModelPart>& before, const std::vector<v1::ModelPart>& after,
                v1::DragPreview* preview);

}  // namespace mortise::composer
