// Small CAD templates for tests, written as files are.
#pragma once

#include <string>

#include "absl/strings/str_cat.h"
#include "common/templates/features/codec/cad_template_codec.h"
#include "common/templates/features/feature_model.h"

namespace mortise::cad {

// A template around features and parameters given as text.
inline std::string TemplateText(const std::string& parameters, const std::string& features) {
  return absl::StrCat("name: 'templates/test' title: 'Test' material: 'materials/steel' ",
                      parameters.empty() ? "parameters { name: 'unused' unit: 'm' minimum: 0 "
                                           "maximum: 1 default_value: 0.5 } "
                                         : parameters,
                      features);
}

// "parameters { name: … }" in metres.
inline std::string Range(const std::string& name, double minimum, double maximum, double value) {
  return absl::StrCat("parameters { name: '", name, "' unit: 'm' minimum: ", minimum,
                      " maximum: ", maximum, " default_value: ", value, " } ");
}

// A block of 0.1 × 0.06 × 0.02 m on the XY plane around the origin: "block.outline.right", …
inline std::string BlockText() {
  return "features { name: 'block_sketch' sketch { profiles { name: 'outline' rectangle { width: "
         "'0.1' height: '0.06' } } } } "
         "features { name: 'block' extrude { sketch: 'block_sketch' to: '0.02' } } ";
}

inline constexpr double kBlockVolume = 0.1 * 0.06 * 0.02;

// The model of a template's text.
inline absl::StatusOr<FeatureModel> ModelOf(const std::string& text) {
  auto definition = ParseCadTemplateText(text, "test");
  if (!definition.ok()) return definition.status();
  return FeatureModel::Create(*std::move(definition));
}

inline absl::StatusOr<RegeneratedModel> SolidOf(const std::string& parameters,
                                                const std::string& features) {
  auto model = ModelOf(TemplateText(parameters, features));
  if (!model.ok()) return model.status();
  return model->Regenerate(model->Defaults());
}

}  // namespace mortise::cad
