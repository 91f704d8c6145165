#include "tests/unit/services/composer/scripts/composed_drawing.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "services/composer/records/drawing.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::composer {
namespace {

// The drawing of a design that ships, read once. `design` with or without "assemblies/" before it,
// and with "_" or "-" in it.
absl::StatusOr<const Drawing*> ShippedDrawing(const std::string& design) {
  static auto* const drawings = new std::map<std::string, Drawing>();
  std::string name = absl::StrCat("assemblies/", design.substr(design.find('/') + 1));
  std::replace(name.begin(), name.end(), '_', '-');
  const auto known = drawings->find(name);
  if (known != drawings->end()) return &known->second;
  v1::AssemblyBundle bundle;
  const parametric::Collection& ships = parametric::WhatShips();
  for (const v1::Assembly& assembly : ships.assemblies) {
    if (assembly.name() == name) *bundle.mutable_assembly() = assembly;
  }
  bundle.mutable_items()->Assign(ships.items.begin(), ships.items.end());
  bundle.mutable_materials()->Assign(ships.materials.begin(), ships.materials.end());
  bundle.mutable_shapes()->Assign(ships.shapes.begin(), ships.shapes.end());
  KeepWhatIsUsed(&bundle);
  MORTISE_ASSIGN_OR_RETURN(Drawing read, ReadDrawing(bundle));
  return &drawings->emplace(name, std::move(read)).first->second;
}

absl::StatusOr<CopiedFrom> CopyOf(const ShippedOrigin& origin) {
  MORTISE_ASSIGN_OR_RETURN(const Drawing* const drawing, ShippedDrawing(origin.design));
  return CopiedFrom{drawing, origin.name};
}

}  // namespace

absl::StatusOr<v1::TemplateBundle> ComposedTemplate(const ComposedBody& body,
                                                    const std::string& id) {
  MORTISE_ASSIGN_OR_RETURN(const Redrawn redrawn, Redraw(body.design));
  std::vector<CopiedFrom> parts, joints;
  for (const std::string& drawn_as : redrawn.drawn_as) {
    MORTISE_ASSIGN_OR_RETURN(parts.emplace_back(), CopyOf(body.parts.at(drawn_as)));
  }
  for (const parametric::Joint& joint : redrawn.assembly.joints) {
    MORTISE_ASSIGN_OR_RETURN(joints.emplace_back(), CopyOf(body.joints.at(joint.name)));
  }
  MORTISE_ASSIGN_OR_RETURN(
      Drawing drawing, DrawAnew(absl::StrCat("assemblies/", id), redrawn.assembly, parts, joints));
  v1::TemplateBundle bundle;
  *bundle.mutable_assembly() = std::move(*drawing.bundle.mutable_assembly());
  *bundle.mutable_items() = std::move(*drawing.bundle.mutable_items());
  *bundle.mutable_materials() = std::move(*drawing.bundle.mutable_materials());
  *bundle.mutable_shapes() = std::move(*drawing.bundle.mutable_shapes());
  bundle.mutable_assembly()->set_title(id);
  bundle.mutable_template_()->set_name(absl::StrCat("templates/", id));
  bundle.mutable_template_()->mutable_assembly()->set_assembly(bundle.assembly().name());
  return bundle;
}

}  // namespace mortise::composer
