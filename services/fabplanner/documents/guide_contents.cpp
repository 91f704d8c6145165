#include "services/fabplanner/documents/guide_contents.h"

#include <map>
#include <unordered_map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "services/fabplanner/documents/fastener_picture.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

using PartsByName = std::unordered_map<std::string, const Part*>;

std::string ItemTitleOf(const Items& items, const std::string& name) {
  const auto found = items.find(name);
  return found == items.end() || found->second.title.empty() ? name : found->second.title;
}

// Rows of a table, each with how often it occurs, in order of appearance.
class CountedRows {
 public:
  void Add(std::vector<std::string> cells, int count = 1, int fastener = -1) {
    const auto [place, is_new] = places_.emplace(absl::StrJoin(cells, "\x1f"), rows_.size());
    if (is_new) rows_.push_back({0, std::move(cells), fastener});
    rows_[place->second].count += count;
  }

  // Adds the table, if it has rows.
  void AppendTo(std::string heading, std::string note, std::vector<std::string> columns,
                std::vector<GuideTable>* tables) {
    if (rows_.empty()) return;
    tables->push_back({std::move(heading), std::move(note), std::move(columns), std::move(rows_)});
  }

 private:
  std::map<std::string, std::size_t> places_;
  std::vector<GuideRow> rows_;
};

void AppendParts(const FabricationPlan& plan, const Design& design, const Items& items,
                 std::vector<GuideTable>* tables) {
  CountedRows cut, bought, drawn;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const Part& part = design.parts[i];
    const PlannedPart& planned = plan.parts[i];
    const std::string title = TitleOf(part), of = ItemTitleOf(items, part.item);
    std::vector<std::string> remarks;
    if (!AreSquare(planned.ends)) remarks.push_back(EndsText(planned.ends));
    if (!planned.handwork.empty()) remarks.push_back(planned.handwork);
    if (!planned.drawings.empty()) remarks.push_back(planned.drawings.front());
    const std::string remark = absl::StrJoin(remarks, "; ");
    if (planned.making == Making::kBought) {
      bought.Add({title, of});
    } else if (planned.making == Making::kToDrawing) {
      drawn.Add({title, part.material, SizeText(planned.size), remark});
    } else {
      cut.Add({title, of, SizeText(planned.size), remark});
    }
  }
  cut.AppendTo("Parts that are cut", "", {"Part", "Made of", "Size", ""}, tables);
  drawn.AppendTo("Parts made to drawing", "", {"Part", "Material", "Size", ""}, tables);
  bought.AppendTo("Parts that are bought", "", {"Part", "Item"}, tables);
}

std::string TitleIn(const PartsByName& parts, const std::string& name) {
  const auto found = parts.find(name);
  return found == parts.end() ? name : TitleOf(*found->second);
}

void AppendHoles(const FabricationPlan& plan, const PartsByName& parts,
                 std::vector<GuideTable>* tables) {
  constexpr const char* kFor[] = {"for a peg or pin", "for a screw", "to pass through",
                                  "with a thread"};
  CountedRows rows;
  for (const Hole& hole : plan.holes) {
    rows.Add({TitleIn(parts, hole.part),
              absl::StrCat("diameter ", Millimetres(hole.diameter), " mm"),
              hole.through ? "through" : absl::StrCat(Millimetres(hole.depth), " mm deep"),
              kFor[static_cast<int>(hole.kind)]});
  }
  rows.AppendTo("Holes", "Where each is: holes.csv.", {"Part", "Drill", "Depth", ""}, tables);
}

// Fasteners that are alike, each drawn once.
class FastenerKinds {
 public:
  explicit FastenerKinds(const Items& items) : items_(items) {}

  absl::StatusOr<int> Of(const Part& part) {
    std::string title = part.item.empty() ? TitleOf(part) : ItemTitleOf(items_, part.item);
    if (part.process == CutProcess::kChopSaw) {
      absl::StrAppend(&title, ", cut to ", Millimetres(part.size.x()), " mm");
    }
    return Find(title, [&] { return FastenerPicture(part); });
  }

  absl::StatusOr<int> Of(const Peg& peg) {
    return Find(ItemTitleOf(items_, peg.item), [&] { return FastenerPicture(peg); });
  }

  std::vector<GuideFastener> Take() { return std::move(kinds_); }
  const std::string& TitleOfKind(int kind) const {
    return kinds_[static_cast<std::size_t>(kind)].title;
  }

 private:
  template <class Draw>
  absl::StatusOr<int> Find(const std::string& title, Draw draw) {
    const auto found = places_.find(title);
    if (found != places_.end()) return found->second;
    MORTISE_ASSIGN_OR_RETURN(std::string picture, draw());
    const int place = static_cast<int>(kinds_.size());
    kinds_.push_back({title, std::move(picture)});
    places_.emplace(title, place);
    return place;
  }

  const Items& items_;
  std::map<std::string, int> places_;
  std::vector<GuideFastener> kinds_;
};

class StepWriter {
 public:
  StepWriter(const Design& design, const Items& items, const PartsByName& parts)
      : items_(items), parts_(parts), kinds_(items) {
    for (const Peg& peg : design.pegs) pegs_.emplace(peg.connection, &peg);
  }

  absl::StatusOr<GuideStep> Write(const AssemblyStep& step) {
    GuideStep written;
    written.number = step.number;
    written.title =
        absl::StrCat("Step ", step.number, step.subassembly.empty() ? "" : ": ", step.subassembly);
    written.instruction = step.instruction;
    CountedRows fasteners, added;
    MORTISE_RETURN_IF_ERROR(CountFasteners(step, &fasteners));
    fasteners.AppendTo("Fasteners", "", {"Item"}, &written.tables);
    for (const std::string& name : step.added_parts) {
      const auto found = parts_.find(name);
      added.Add(
          {TitleIn(parts_, name), found == parts_.end() ? "" : SizeText(found->second->size)});
    }
    added.AppendTo("", "", {"Added part", "Size"}, &written.tables);
    AppendJoints(step, &written.tables);
    return written;
  }

  std::vector<GuideFastener> TakeFasteners() { return kinds_.Take(); }

 private:
  absl::Status CountFasteners(const AssemblyStep& step, CountedRows* rows) {
    for (const std::string& name : step.connectors) {
      const auto part = parts_.find(name);
      if (part == parts_.end()) continue;
      MORTISE_ASSIGN_OR_RETURN(const int kind, kinds_.Of(*part->second));
      rows->Add({kinds_.TitleOfKind(kind)}, 1, kind);
    }
    if (!step.moves.empty()) return absl::OkStatus();
    for (const StepConnection& connection : step.connections) {
      const auto peg = pegs_.find(connection.name);
      if (peg == pegs_.end()) continue;
      MORTISE_ASSIGN_OR_RETURN(const int kind, kinds_.Of(*peg->second));
      rows->Add({kinds_.TitleOfKind(kind)}, connection.pegs, kind);
    }
    return absl::OkStatus();
  }

  void AppendJoints(const AssemblyStep& step, std::vector<GuideTable>* tables) const {
    const bool is_pegged = step.moves.empty();
    CountedRows joints;
    for (const StepConnection& connection : step.connections) {
      const std::string between = is_pegged ? absl::StrCat(TitleIn(parts_, connection.part), " – ",
                                                           TitleIn(parts_, connection.other_part))
                                            : connection.name;
      joints.Add({ItemTitleOf(items_, connection.item), between}, connection.pegs);
    }
    joints.AppendTo("", "",
                    is_pegged ? std::vector<std::string>{"Pegs", "Joint"}
                              : std::vector<std::string>{"Item", "Holds"},
                    tables);
  }

  const Items& items_;
  const PartsByName& parts_;
  FastenerKinds kinds_;
  std::unordered_map<std::string, const Peg*> pegs_;  // one of each connection
};

std::string SummaryOf(const FabricationPlan& plan, const Design& design) {
  std::string summary =
      absl::StrCat(design.parts.size(), design.parts.size() == 1 ? " part, " : " parts, ");
  if (plan.pegs > 0) absl::StrAppend(&summary, plan.pegs / plan.quantity, " pegs, ");
  absl::StrAppend(&summary, plan.steps.size(), plan.steps.size() == 1 ? " step" : " steps");
  if (plan.quantity > 1) absl::StrAppend(&summary, "; make ", plan.quantity, " of them");
  return summary;
}

}  // namespace

absl::StatusOr<GuideContents> ContentsOf(const FabricationPlan& plan, const Design& design,
                                         const Items& items, const std::string& title) {
  PartsByName parts;
  for (const Part& part : design.parts) parts[part.name] = &part;
  GuideContents contents;
  contents.title = title;
  contents.summary = SummaryOf(plan, design);
  contents.has_ways = !plan.steps.empty() && !plan.steps.front().moves.empty();
  if (contents.has_ways) {
    contents.notes.push_back(
        "Each part comes in by a straight movement along an axis that was found to be free. Not "
        "checked: whether a tool reaches every screw, how hinges and the like come in, movements "
        "that turn.");
  }
  AppendParts(plan, design, items, &contents.tables);
  AppendHoles(plan, parts, &contents.tables);
  StepWriter writer(design, items, parts);
  for (const AssemblyStep& step : plan.steps) {
    MORTISE_ASSIGN_OR_RETURN(contents.steps.emplace_back(), writer.Write(step));
  }
  contents.fasteners = writer.TakeFasteners();
  return contents;
}

}  // namespace mortise::fabplanner
