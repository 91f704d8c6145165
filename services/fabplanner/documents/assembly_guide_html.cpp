#include "services/fabplanner/documents/assembly_guide_html.h"

#include <map>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "services/fabplanner/documents/svg_drawing.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

constexpr char kStyle[] = R"(
body{font:16px/1.5 Helvetica,Arial,sans-serif;color:#222;max-width:1000px;margin:2em auto;
padding:0 1em}
h1{margin-bottom:.2em}h2{border-top:2px solid #222;padding-top:.6em;margin-top:2em}
section{break-inside:avoid}
img{width:100%;max-width:900px;border:1px solid #ddd}
table{border-collapse:collapse;margin:.6em 0}
th,td{text-align:left;padding:.2em 1.2em .2em 0;border-bottom:1px solid #ddd;vertical-align:top}
.columns{display:flex;flex-wrap:wrap;gap:0 3em}
.quiet{color:#666}.count{color:#666;text-align:right;padding-right:.6em}.key{display:inline-block;width:.9em;height:.9em;border:1px solid #333;
vertical-align:-.1em;margin:0 .3em 0 1em}
@media print{h2{break-before:page}}
)";

std::string Escape(const std::string& text) { return SvgDrawing::Escape(text); }

std::string ItemTitle(const Items& items, const std::string& name) {
  const auto found = items.find(name);
  return found == items.end() || found->second.title.empty() ? name : found->second.title;
}

// Rows of a table, each with how often it occurs, in order of appearance.
class CountedRows {
 public:
  void Add(const std::string& row, int count = 1) {
    if ((counts_[row] += count) == count) order_.push_back(row);
  }
  bool empty() const { return order_.empty(); }
  void Append(const std::string& heading, std::string* html) const {
    if (order_.empty()) return;
    absl::StrAppend(html, "<table><tr><th></th>", heading, "</tr>\n");
    for (const std::string& row : order_) {
      absl::StrAppend(html, "<tr><td class=\"count\">", counts_.at(row), " ×</td>", row, "</tr>\n");
    }
    absl::StrAppend(html, "</table>\n");
  }

 private:
  std::map<std::string, int> counts_;
  std::vector<std::string> order_;
};

std::string Cells(const std::vector<std::string>& texts) {
  std::string cells;
  for (const std::string& text : texts) absl::StrAppend(&cells, "<td>", text, "</td>");
  return cells;
}

void AppendParts(const FabricationPlan& plan, const Design& design, const Items& items,
                 std::string* html) {
  CountedRows cut, bought, drawn;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const Part& part = design.parts[i];
    const PlannedPart& planned = plan.parts[i];
    const std::string title = Escape(TitleOf(part)), of = Escape(ItemTitle(items, part.item));
    std::string remark = Escape(EndsText(planned.ends));
    if (!planned.handwork.empty()) {
      absl::StrAppend(&remark, remark.empty() ? "" : "; ", Escape(planned.handwork));
    }
    if (!planned.drawings.empty()) {
      absl::StrAppend(&remark, " <span class=\"quiet\">", planned.drawings.front(), "</span>");
    }
    if (planned.making == Making::kBought) {
      bought.Add(Cells({title, of}));
    } else if (planned.making == Making::kToDrawing) {
      drawn.Add(Cells({title, Escape(part.material), SizeText(planned.size), remark}));
    } else {
      cut.Add(Cells({title, of, SizeText(planned.size), remark}));
    }
  }
  if (!cut.empty()) absl::StrAppend(html, "<h3>Parts that are cut</h3>\n");
  cut.Append("<th>Part</th><th>Made of</th><th>Size</th><th></th>", html);
  if (!drawn.empty()) absl::StrAppend(html, "<h3>Parts made to drawing</h3>\n");
  drawn.Append("<th>Part</th><th>Material</th><th>Size</th><th></th>", html);
  if (!bought.empty()) absl::StrAppend(html, "<h3>Parts that are bought</h3>\n");
  bought.Append("<th>Part</th><th>Item</th>", html);
}

void AppendHoles(const FabricationPlan& plan, const std::map<std::string, const Part*>& parts,
                 std::string* html) {
  constexpr const char* kFor[] = {"for a peg or pin", "for a screw", "to pass through",
                                  "with a thread"};
  CountedRows rows;
  for (const Hole& hole : plan.holes) {
    const auto part = parts.find(hole.part);
    rows.Add(Cells({part == parts.end() ? Escape(hole.part) : Escape(TitleOf(*part->second)),
                    absl::StrCat("diameter ", Millimetres(hole.diameter), " mm"),
                    hole.through ? "through" : absl::StrCat(Millimetres(hole.depth), " mm deep"),
                    kFor[static_cast<int>(hole.kind)]}));
  }
  if (rows.empty()) return;
  absl::StrAppend(html,
                  "<h3>Holes</h3>\n<p>Where each is: <span class=\"quiet\">holes.csv</span>."
                  "</p>\n");
  rows.Append("<th>Part</th><th>Drill</th><th>Depth</th><th></th>", html);
}

void AppendOverview(const FabricationPlan& plan, const Design& design, const Items& items,
                    const std::map<std::string, const Part*>& parts, std::string* html) {
  const bool has_ways = !plan.steps.empty() && !plan.steps.front().moves.empty();
  absl::StrAppend(html, "<p>", design.parts.size(),
                  design.parts.size() == 1 ? " part, " : " parts, ");
  if (plan.pegs > 0) absl::StrAppend(html, plan.pegs / plan.quantity, " pegs, ");
  absl::StrAppend(html, plan.steps.size(), plan.steps.size() == 1 ? " step" : " steps");
  if (plan.quantity > 1) absl::StrAppend(html, "; make ", plan.quantity, " of them");
  absl::StrAppend(html,
                  ". In the pictures <span class=\"key\" style=\"background:#f2a847\"></span>is "
                  "what comes in, <span class=\"key\" style=\"background:#dbdbd9\"></span>what is "
                  "built already, <span class=\"key\" style=\"background:#994d1a\"></span>",
                  has_ways ? "what holds it together" : "pegs",
                  "; arrows show where things go.</p>\n");
  if (has_ways) {
    absl::StrAppend(
        html,
        "<p class=\"quiet\">Each part comes in by a straight movement along an axis that "
        "was found to be free. Not checked: whether a tool reaches every screw, how "
        "hinges and the like come in, movements that turn.</p>\n");
  }
  AppendParts(plan, design, items, html);
  AppendHoles(plan, parts, html);
}

void AppendStep(const AssemblyStep& step, const std::map<std::string, const Part*>& parts,
                const Items& items, const std::string& picture, std::string* html) {
  const auto title = [&](const std::string& name) {
    const auto found = parts.find(name);
    return Escape(found == parts.end() ? name : TitleOf(*found->second));
  };
  absl::StrAppend(html, "<section id=\"step-", step.number, "\">\n<h2>Step ", step.number,
                  step.subassembly.empty() ? "" : ": ", Escape(step.subassembly), "</h2>\n<p>",
                  Escape(step.instruction), "</p>\n");
  if (!picture.empty()) {
    absl::StrAppend(html, "<img alt=\"Step ", step.number, "\" src=\"data:image/png;base64,",
                    absl::Base64Escape(picture), "\">\n");
  }
  absl::StrAppend(html, "<div class=\"columns\">\n");
  CountedRows added;
  for (const std::string& name : step.added_parts) {
    const auto found = parts.find(name);
    added.Add(Cells({title(name), found == parts.end() ? "" : SizeText(found->second->size)}));
  }
  added.Append("<th>Added part</th><th>Size</th>", html);
  CountedRows joints;
  for (const StepConnection& connection : step.connections) {
    const std::string between = step.moves.empty() ? absl::StrCat(title(connection.part), " – ",
                                                                  title(connection.other_part))
                                                   : Escape(connection.name);
    joints.Add(Cells({Escape(ItemTitle(items, connection.item)), between}), connection.pegs);
  }
  joints.Append(step.moves.empty() ? "<th>Pegs</th><th>Joint</th>" : "<th>Item</th><th>Holds</th>",
                html);
  absl::StrAppend(html, "</div>\n</section>\n");
}

}  // namespace

std::string AssemblyGuideHtml(const FabricationPlan& plan, const Design& design, const Items& items,
                              const std::string& title, const std::vector<std::string>& pictures) {
  std::map<std::string, const Part*> parts;
  for (const Part& part : design.parts) parts[part.name] = &part;
  std::string html = absl::StrCat(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "name=\"viewport\" content=\"width=device-width\">\n<title>",
      Escape(title), ": assembly guide</title>\n<style>", kStyle, "</style>\n</head>\n<body>\n<h1>",
      Escape(title),
      "</h1>\n<p class=\"quiet\">Assembly guide. Sizes in millimetres: length × "
      "width × thickness.</p>\n");
  AppendOverview(plan, design, items, parts, &html);
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    AppendStep(plan.steps[i], parts, items, i < pictures.size() ? pictures[i] : "", &html);
  }
  absl::StrAppend(&html, "</body>\n</html>\n");
  return html;
}

}  // namespace mortise::fabplanner
