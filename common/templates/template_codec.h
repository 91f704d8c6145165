// Makes templates of any kind from the messages of mortise/v1/template.proto. Target
// mortise_templates; only adapters use it.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/templates/template.h"
#include "mortise/v1/template.pb.h"

namespace mortise::templates {

// The parametrisation of an assembly, or of the sub-tree below a group of it: made now, as
// parametric::Parametrize does, or before.
using Parametrization = std::shared_ptr<const parametric::ParametricAssembly>;
using Parametrize = std::function<absl::StatusOr<Parametrization>(
    const v1::AssemblyBundle& bundle, const std::function<bool()>& is_given_up,
    const std::string& group)>;

// Compiles a completed bundle for evaluation. INVALID_ARGUMENT naming all fields at fault, as the
// template's message has them ("parts[2].item", "cad.features[3].fillet.radius", "assembly.group",
// "assembly.handles[0].measure"); FAILED_PRECONDITION as ParametricAssembly::Create. Takes up to
// seconds for assemblies of hundreds of parts.
absl::StatusOr<std::shared_ptr<const Template>> Compile(
    const v1::TemplateBundle& bundle, const Parametrize& parametrize = parametric::Parametrize);

// How much of its design space a template is tried at before it is accepted.
enum class Trial {
  kDefaults,  // of CAD templates, no more than can be seen without making a solid
  kThorough,  // and the ends of every parameter, or twelve corners where there are more than six;
              // of parts as ValidateTemplate, of cages as ValidateCageTemplate in any case
};

// Fills in what the service says of a template (title, description and parameters of a kind, the
// handles of an assembly where there are none, the digest), and checks all of it. The bundle has
// the items, materials and assembly that it uses. INVALID_ARGUMENT with every finding; fields as
// Compile. CANCELLED as soon as `is_given_up`, which is asked before each design that is tried.
absl::Status FillAndCheck(
    v1::TemplateBundle& bundle, Trial trial,
    const std::function<bool()>& is_given_up = [] { return false; },
    const Parametrize& parametrize = parametric::Parametrize);

// Returns what a template names itself, not what its assembly does: items/{id}, materials/{id}.
std::set<std::string> ItemsOf(const v1::Template& message);
std::set<std::string> MaterialsOf(const v1::Template& message);

// Returns the template without what it is made of; its kind can still be told.
v1::Template SummaryOf(v1::Template message);

}  // namespace mortise::templates
