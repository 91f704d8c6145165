// Any text given as a CAD template is refused or made into a solid, never a crash.
#include <cstdint>
#include <string_view>

#include "common/templates/features/codec/cad_template_codec.h"
#include "common/templates/features/feature_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::cad;
  const auto definition =
      ParseCadTemplateText(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
  // Many features take long by design; the rest is the same code.
  if (!definition.ok() || definition->features.size() > 4) return 0;
  (void)FromProto(ToProto(*definition));
  const auto model = FeatureModel::Create(*definition);
  if (!model.ok()) return 0;
  for (const Feature& feature : definition->features) {
    if (std::holds_alternative<LinearPattern>(feature.kind) ||
        std::holds_alternative<CircularPattern>(feature.kind)) {
      return 0;
    }
  }
  (void)model->Regenerate(model->Defaults());
  return 0;
}
