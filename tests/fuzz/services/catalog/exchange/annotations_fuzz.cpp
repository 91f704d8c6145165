// Any text given as annotations of a STEP file is refused or makes an assembly, never a crash.
#include <cstdint>
#include <string_view>

#include "common/assembly/codec/assembly_codec.h"
#include "common/messages/proto_text.h"
#include "services/catalog/exchange/assembly_import.h"

namespace {

mortise::cad::StepAssembly Drawing() {
  mortise::cad::StepAssembly drawing;
  drawing.name = "frame";
  drawing.groups = {{"frame", -1}, {"left", 0}, {"upper", 1}};
  drawing.products = {{"post", {}, {}}, {"rail", {}, {}}};
  for (int i = 0; i < 4; ++i) {
    mortise::cad::StepPart part;
    part.name = i % 2 == 0 ? "post " + std::to_string(i) : "rail " + std::to_string(i);
    part.drawn_name = i % 2 == 0 ? "post" : "rail";
    part.group = i % 3;
    part.product = i % 2;
    part.minimum = Eigen::Vector3d(0.1 * i, 0, 0);
    part.maximum = part.minimum + Eigen::Vector3d(0.1, 0.09, 0.04);
    part.volume = 0.1 * 0.09 * 0.04;
    part.is_box = i != 3;
    drawing.parts.push_back(part);
  }
  drawing.leaves = {{"skin", "skin", "skin", 2, true}};
  return drawing;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise;
  v1::AssemblyAnnotations annotations;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (!parametric::ParseProtoText(text, "fuzz", annotations).ok()) return 0;
  parametric::Item board;
  board.name = "items/board";
  board.kind = parametric::ItemKind::kBoard;
  board.dimensions = {{{2.4, parametric::Process::kChopSaw, 0.04, 2.4}, {0.09}, {0.04}}};
  const catalog::DrawnAssembly drawn = catalog::MakeAssembly(Drawing(), annotations, {board});
  (void)catalog::AtRequest(drawn, annotations,
                           parametric::FromProto(drawn.assembly, {board}).status());
  return 0;
}
