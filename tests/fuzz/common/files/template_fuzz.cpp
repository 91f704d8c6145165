// Any text given as a template file is refused or evaluated, never a crash.
#include <cstdint>
#include <string_view>

#include "common/design/evaluation.h"
#include "common/design/template_validation.h"
#include "common/files/collection.h"
#include "common/files/template_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::parametric;
  const auto message =
      ParseTemplateText(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
  if (!message.ok()) return 0;
  auto definition = FromProto(*message);
  // Validation of large templates takes long by design; the rest is the same code.
  if (!definition.ok() || definition->parts.size() > 12) return 0;
  Material wood;
  wood.name = "materials/wood";
  wood.density = 400;
  wood.youngs_modulus = 1e10;
  wood.poissons_ratio = 0.3;
  wood.strength = 1e7;
  Item board;
  board.name = "items/board";
  board.kind = ItemKind::kBoard;
  board.material = wood.name;
  board.dimensions.fill({10, Process::kChopSaw, 0.001, 10});
  Item sheet = board;
  sheet.name = "items/sheet";
  sheet.kind = ItemKind::kSheet;
  Item dowel;
  dowel.name = "items/dowel";
  dowel.kind = ItemKind::kDowel;
  dowel.material = wood.name;
  dowel.dimensions = {{{0.035}, {0.008}, {0.008}}};
  const TemplateBundle bundle = MakeBundle(*std::move(definition), {board, sheet, dowel}, {wood});
  (void)ValidateTemplate(bundle);
  const auto function = TemplateFunction::Create(bundle);
  if (function.ok()) (void)function->Evaluate(function->Defaults());
  return 0;
}
