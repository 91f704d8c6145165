// Any design that a catalog might answer, as text proto: planning refuses it or makes a plan in
// which every part that is cut is cut once and every part comes in once, and whose files can be
// drawn.
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>

#include "services/fabplanner/documents/layout_svg.h"
#include "services/fabplanner/documents/plan_csv.h"
#include "services/fabplanner/planning/planning.h"
#include "services/fabplanner/service/design_codec.h"
#include "services/fabplanner/shop_floor/plan_codec.h"
#include "services/fabplanner/shop_floor/work_order.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace {

namespace fabplanner = mortise::fabplanner;

void CheckPlan(const fabplanner::Design& design, const fabplanner::FabricationPlan& plan) {
  const std::vector<fabplanner::Cut> cuts = fabplanner::CutsFor(plan);
  std::map<std::string, int> cut;
  for (const fabplanner::Cut& one : cuts) ++cut[one.part];
  std::map<std::string, int> added;
  for (const fabplanner::AssemblyStep& step : plan.steps) {
    for (const std::string& part : step.added_parts) ++added[part];
    for (const std::string& part : step.connectors) ++added[part];
  }
  for (const fabplanner::PlannedPart& part : plan.parts) {
    const bool is_cut =
        part.making == fabplanner::Making::kCrosscut || part.making == fabplanner::Making::kOutline;
    if (cut[part.part] != (is_cut ? 1 : 0) || added[part.part] != 1) std::abort();
  }
  fabplanner::CutListCsv(plan);
  fabplanner::BillCsv(plan);
  fabplanner::PartsCsv(plan, design);
  fabplanner::HolesCsv(plan, design);
  fabplanner::BoardsSvg(plan);
  fabplanner::SheetsSvg(plan);
  const mortise::v1::Plan message = fabplanner::ToProto(plan, design);
  if (fabplanner::CutsFor(fabplanner::CuttingPlanFrom(message)).size() != cuts.size()) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  google::protobuf::TextFormat::Parser parser;
  parser.SetRecursionLimit(20);
  mortise::v1::EvaluatedDesign message;
  class Silence : public google::protobuf::io::ErrorCollector {
    void AddError(int, google::protobuf::io::ColumnNumber, const std::string&) override {}
  } silence;
  parser.RecordErrorsTo(&silence);
  if (!parser.ParseFromString(std::string(reinterpret_cast<const char*>(data), size), &message) ||
      message.parts_size() > 30) {
    return 0;
  }
  const auto design = fabplanner::DesignFrom(message);
  if (!design.ok()) return 0;
  const auto plan = fabplanner::MakePlan(*design, fabplanner::ExampleItems(), 1);
  if (plan.ok()) CheckPlan(*design, *plan);
  return 0;
}
