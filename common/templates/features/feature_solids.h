// Makes the solids that features add to or take from bodies, each face named by what it comes from.
// Private to this folder: it brings Open CASCADE's headers. Lengths in the kernel are in
// millimetres.
#pragma once

#include <gp_Ax3.hxx>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/templates/features/named_body.h"
#include "common/templates/features/sketch_faces.h"

namespace mortise::cad {

// Returns one solid a region of the sketch. INVALID_ARGUMENT naming the field ("extrude.to").
absl::StatusOr<std::vector<NamedBody>> MakeExtrusion(const Extrude& extrude,
                                                     const std::string& feature,
                                                     const BuiltSketch& sketch,
                                                     const Numbers& numbers);
absl::StatusOr<std::vector<NamedBody>> MakeRevolution(const Revolve& revolve,
                                                      const std::string& feature,
                                                      const BuiltSketch& sketch,
                                                      const Numbers& numbers);
absl::StatusOr<std::vector<NamedBody>> MakeSweep(const Sweep& sweep, const std::string& feature,
                                                 const BuiltSketch& sketch,
                                                 const BuiltSketch& path);

// Returns what a drill takes away. `entry` lies in the face, its Z pointing out of the material;
// `reach` (mm) goes through everything.
absl::StatusOr<NamedBody> MakeDrill(const Hole& hole, const std::string& feature,
                                    const gp_Ax3& entry, double reach, const Numbers& numbers);

}  // namespace mortise::cad
