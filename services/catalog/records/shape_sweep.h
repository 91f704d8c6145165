// Removes shapes that nothing refers to any more.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/store.h"

namespace mortise::catalog {

// How long a shape stays that nothing refers to: who imports one needs a while to import what has
// it.
inline constexpr absl::Duration kUnusedShapeLife = absl::Hours(1);

// Removes the shapes that no revision of a template, assembly or item names and that were last
// imported more than kUnusedShapeLife before the store's time ("shape.deleted"); returns their
// names. What is removed is settled in one write transaction, so that an import that runs meanwhile
// comes either before it, and its shape stays, or after it, and finds none.
absl::StatusOr<std::vector<std::string>> SweepShapes(store::Store& store);

}  // namespace mortise::catalog
