// Tells what a template lacks to be analysed by finite elements as it is.
#pragma once

#include <string>
#include <vector>

#include "mortise/v1/template.pb.h"

namespace mortise::templates {

// Returns what is missing of "supports", "loads" and "materials", in this order: something that
// holds it, something that loads it (heat makes both unnecessary), and a material for every part
// that bears. Nothing is computed: what a design lacks at some parameters only is not seen.
std::vector<std::string> AnalysisLacks(const v1::TemplateBundle& bundle);

}  // namespace mortise::templates
