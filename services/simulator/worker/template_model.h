// Makes the model that is analysed of a template at given parameters.
#pragma once

#include "absl/status/statusor.h"
#include "common/templates/template.h"
#include "services/simulator/analysis/design_analysis.h"

namespace mortise::simulator {

// Whether, and how, a model's parts are fused to one surface.
struct Joining {
  bool is_wanted = true;
  double element_size = 0;  // m, of the mesh to be made of it; 0 for mesh::DefaultElementSize
  bool control_variables = false;  // whether those of a solid are wanted
};

// Fuses the parts of `design`, which is `function` at `parameters`, looks up what they are made of,
// and turns its boundary conditions into supports and loads. Parts with shapes are their exact
// solids where the template has them, else their triangles. Wood has its grain along the axis that
// the part's item says; where there is no item it is taken as isotropic. What only connects parts
// is left out: they are bonded where they touch. Without `joining.is_wanted` the parts are not
// fused, which may take a second, and there is no surface. What is round gets triangles for
// elements of the size (cad::FuseOptions). Control variables are those of a design that is one
// solid; where the kernel cannot find them there are none.
//
// Fails as cad::FuseAssembly and Template::Solids do; FAILED_PRECONDITION, NO_MATERIAL, naming a
// part of which nobody says what it is made of; NO_CONDUCTIVITY, naming the material of a part that
// is heated, where it says nothing of heat; INVALID_ARGUMENT naming the design's field where a
// part is missing; RESOURCE_EXHAUSTED for solids with more faces together than the kernel fuses in
// reasonable time.
absl::StatusOr<DesignModel> MakeDesignModel(const templates::Template& function,
                                            const Eigen::VectorXd& parameters,
                                            const parametric::EvaluatedDesign& design,
                                            const Joining& joining = {});

// Returns OfferedMetrics, with the currency of the template's items as the unit of the cost.
std::vector<MetricDescription> MetricsOf(const templates::Template& function);

// Returns the failure of an analysis of `design`. Where a part is free to move (RIGID_MOTION), and
// what connects it to others was left out, it says so.
absl::Status WithLeftOutParts(const absl::Status& failure,
                              const parametric::EvaluatedDesign& design);

}  // namespace mortise::simulator
