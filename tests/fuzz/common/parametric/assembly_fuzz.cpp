// Any text given as an assembly file is refused or parametrised, never a crash.
#include <cstdint>
#include <string_view>

#include "common/parametric/assembly_codec.h"
#include "common/parametric/collection.h"
#include "common/parametric/element.h"
#include "common/parametric/relationship.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::parametric;
  const auto message =
      ParseAssemblyText(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
  if (!message.ok()) return 0;
  Item board;
  board.name = "items/board";
  board.kind = ItemKind::kBoard;
  board.dimensions = {{{2.4, Process::kChopSaw, 0.04, 2.4}, {0.09}, {0.04}}};
  Item sheet = board;
  sheet.name = "items/sheet";
  sheet.dimensions = {
      {{2.5, Process::kJigsaw, 0.05, 2.5}, {1.25, Process::kJigsaw, 0.05, 1.25}, {0.018}}};
  const auto assembly = FromProto(*message, {board, sheet});
  // Many parts take long by design; the rest is the same code.
  if (!assembly.ok() || assembly->parts.size() > 20) return 0;
  const std::vector<Element> elements = MakeElements(*assembly, 1e-6);
  (void)FindRelationships(*assembly, elements, {}, 1e-6);
  return 0;
}
