// Any text given as an assembly file is refused or parametrised, and what was parametrised has
// random designs that can be looked at; never a crash.
#include <cstdint>
#include <string_view>
#include <utility>

#include "common/assembly/codec/assembly_codec.h"
#include "common/assembly/parametric_assembly.h"
#include "common/files/collection.h"

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
  auto assembly = FromProto(*message, {board, sheet});
  // Many parts take long by design; the rest is the same code.
  if (!assembly.ok() || assembly->parts.size() > 20) return 0;
  const auto made = ParametricAssembly::Create(*std::move(assembly));
  if (!made.ok()) return 0;
  (void)made->AdjustableSizes();
  const auto designs = made->Sample(2, 1);
  if (!designs.ok()) return 0;
  for (const Eigen::VectorXd& q : *designs) (void)made->FaultsAt(q);
  return 0;
}
