// Applies features that change a body where references point: fillet, chamfer, draft, shell.
// Private to this folder: it brings Open CASCADE's headers.
#pragma once

#include <gp_Ax3.hxx>
#include <string>

#include "absl/status/status.h"
#include "common/templates/features/feature_numbers.h"
#include "common/templates/features/named_body.h"

namespace mortise::cad {

// Fail with INVALID_ARGUMENT naming the field ("fillet.edges[0]", "fillet.radius") of references
// that mean nothing and of sizes that the kernel cannot make.
absl::Status ApplyFillet(const Fillet& fillet, const std::string& feature, const Numbers& numbers,
                         ModelState& state);
absl::Status ApplyChamfer(const Chamfer& chamfer, const std::string& feature,
                          const Numbers& numbers, ModelState& state);
absl::Status ApplyDraft(const Draft& draft, const std::string& feature, const Numbers& numbers,
                        ModelState& state);
absl::Status ApplyShell(const Shell& shell, const std::string& feature, const Numbers& numbers,
                        ModelState& state);

// The plane of a single plane face, its direction out of the material. INVALID_ARGUMENT naming
// `field` if the reference means nothing or a face that is not plane; several faces must lie in one
// plane.
struct FaceFrame {
  std::size_t body = 0;
  gp_Ax3 frame;
};
absl::StatusOr<FaceFrame> FrameOfFace(const ModelState& state, const std::string& reference,
                                      const std::string& field);

}  // namespace mortise::cad
