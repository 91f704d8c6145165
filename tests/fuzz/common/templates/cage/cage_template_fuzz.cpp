// Any text given as a cage template is refused or made into a surface, never a crash.
#include <cstdint>
#include <string_view>

#include "common/templates/cage/cage_model.h"
#include "common/templates/cage/codec/cage_template_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::parametric;
  const auto definition =
      ParseCageTemplateText(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
  if (!definition.ok()) return 0;
  (void)FromProto(ToProto(*definition));
  const auto model = CageModel::Create(*definition);
  if (!model.ok()) return 0;
  (void)model->Evaluate(model->Defaults());
  (void)model->Jacobian(model->Defaults());
  (void)model->Volume(model->Defaults());
  return 0;
}
