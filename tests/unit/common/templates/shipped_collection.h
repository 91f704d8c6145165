// Bundles of what ships, as the catalog would freeze them.
#pragma once

#include <string>

#include "common/files/collection.h"
#include "mortise/v1/template.pb.h"

namespace mortise::templates {

const parametric::Collection& ShippedCollection();

// The template of designs/ or cad_templates/ with this name, and all that ships.
v1::TemplateBundle ShippedTemplate(const std::string& name);

// A template of the shipped assembly of this name, and all that ships; it has no handles yet.
v1::TemplateBundle ShippedAssembly(const std::string& name);

}  // namespace mortise::templates
