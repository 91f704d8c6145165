// What becomes of the annotations of an assembly when its drawing is imported again without any. A
// drawing says nothing of items and roles, and whoever exports it anew from CAD means the same
// design; so what the revision before says of parts is kept for those that are there still.
#pragma once

#include <string>
#include <vector>

#include "common/cad/step/step_assembly.h"
#include "common/design/template_definition.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::catalog {

// The one part that an annotation means if nothing is to be kept: all that no other annotation
// names.
inline constexpr char kAllOtherParts[] = "*";

// Whether annotations say nothing of parts, groups and joints, so that those of the revision before
// are kept.
bool KeepFormer(const v1::AssemblyAnnotations& annotations);

// Returns annotations without the one that says that nothing is to be kept: its only part is
// kAllOtherParts, it says nothing else, and it is the only one.
v1::AssemblyAnnotations WithoutDropping(v1::AssemblyAnnotations annotations);

struct KeptAnnotations {
  v1::AssemblyAnnotations annotations;
  std::vector<std::string> notes;  // for people: what was kept, and what fits nothing any more
};

// Returns `asked`, for which KeepFormer is true, with what `before` says of parts of the drawing,
// by their names: items and how they lie in the parts, roles, titles, priorities, prominent planes;
// its groups where those are not the drawing's, and its joints. What does not fit the drawing any
// more is left out, and the notes say why: parts that are not there, items that are not among
// `items` or do not fit. What was left out of the design before is not known, and is a part like
// any other. A title, a description, external ids and labels that are not given stay; the tolerance
// of the search for contacts is not known any more.
KeptAnnotations KeepAnnotations(const v1::Assembly& before, const cad::StepAssembly& drawing,
                                const v1::AssemblyAnnotations& asked,
                                const std::vector<parametric::Item>& items);

}  // namespace mortise::catalog
