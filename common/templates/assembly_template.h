// Makes an assembly that parametrises itself (thesis §3.4, §3.5) a Template: each parameter is a
// length of the design that may be asked for, and F(q) is the feasible design nearest to the drawn
// one that has all of them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "common/templates/template.h"

namespace mortise::templates {

// A parameter, and the length of the assembly that it is. Its default is the drawn length.
struct AssemblyHandle {
  std::string parameter;  // identifier
  parametric::Measure measure;
  std::string title = {};
  double minimum = 0;  // m; both 0 for all that the assembly allows by itself
  double maximum = 0;  // m
  double step = 0;     // m, what a workshop can set; 0 for none
};

struct AssemblyTemplate {
  std::vector<AssemblyHandle> handles;
  std::vector<parametric::BoundaryCondition> boundary_conditions;  // on faces of its parts
  std::string reference_temperature;  // expression, K; empty if there is no thermal stress
};

// Returns handles for sizes that can be chosen independently of each other and say all that sizes
// say: of the principal elements, the largest first, each that those before leave open. Parameters
// are named "<element>_<x, y or z>" in the letters of identifiers. No more than `limit`.
absl::StatusOr<std::vector<AssemblyHandle>> IndependentSizes(
    const parametric::ParametricAssembly& assembly, std::size_t limit);

// `head` says what the catalog knows; its parameters are made of the handles here.
// INVALID_ARGUMENT naming "assembly.handles[i]", "boundary_conditions[i]" or
// "reference_temperature", all at once, where one means nothing: no handles, elements that there
// are not, lengths that cannot change, names that are no identifiers or given twice, ranges without
// the drawn length or beyond what the assembly allows, conditions on parts that there are not as
// drawn, expressions that cannot be read.
absl::StatusOr<std::shared_ptr<const Template>> MakeAssemblyTemplate(
    TemplateHead head, std::shared_ptr<const parametric::ParametricAssembly> assembly,
    AssemblyTemplate definition);

}  // namespace mortise::templates
