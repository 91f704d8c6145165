// Fronts in the store.
#pragma once

#include "common/resources/collection.h"
#include "mortise/v1/pareto.pb.h"

namespace mortise::pareto {

// Records hold mortise.v1.Front by the front's id, which is that of the operation that found it.
inline constexpr resources::Collection<v1::Front> kFronts{
    .names = "fronts", .kind = "fronts", .event = "front"};

}  // namespace mortise::pareto
