// One design in a canonical mesh, for tests and benches.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "services/interpolator/shapes/bring_into.h"

namespace mortise::interpolator {

inline absl::StatusOr<BroughtShape> Brought(const fields::DesignFields& design,
                                            const CanonicalMesh& mesh) {
  return PreparedMesh(std::make_shared<const CanonicalMesh>(mesh)).Bring(design);
}

}  // namespace mortise::interpolator
