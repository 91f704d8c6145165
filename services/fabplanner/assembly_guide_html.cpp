#include "services/fabplanner/assembly_guide_html.h"

#include <map>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "services/fabplanner/dimension_text.h"
#include "services/fabplanner/svg_drawing.h"

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
.quiet{color:#666}.key{display:inline-block;width:.9em;height:.9em;border:1px solid #333;
vertical-align:-.1em;margin:0 .3em 0 1em}
@media print{h2{break-before:page}}
)";

std::string Escape(const std::string& text) { return SvgDrawing::Escape(text); }

std::string TitleOf(const Part& part) { return part.title.empty() ? part.name : part.title; }

std::string ItemTitle(const Items& items, const std::string& name) {
  const auto found = items.find(name);
  return found == items.end() || found->second.title.empty() ? name : found->second.title;
}

void AppendOverview(const FabricationPlan& plan, const Design& design, const Items& items,
                    std::string* html) {
  absl::StrAppend(html, "<p>", design.parts.size(), " parts, ", design.pegs.size(), " pegs, ",
                  plan.steps.size(), plan.steps.size() == 1 ? " step" : " steps");
  if (plan.quantity > 1) absl::StrAppend(html, "; make ", plan.quantity, " of them");
  absl::StrAppend(html,
                  ". In the pictures <span class=\"key\" style=\"background:#f2a847\"></span>is "
                  "what comes in, <span class=\"key\" style=\"background:#dbdbd9\"></span>what is "
                  "built already, <span class=\"key\" style=\"background:#994d1a\"></span>pegs; "
                  "arrows show where things go.</p>\n<h3>Parts</h3>\n<table><tr><th>Part</th>"
                  "<th>Made of</th><th>Size</th></tr>\n");
  for (const Part& part : design.parts) {
    absl::StrAppend(html, "<tr><td>", Escape(TitleOf(part)), " <span class=\"quiet\">",
                    Escape(part.name), "</span></td><td>", Escape(ItemTitle(items, part.item)),
                    "</td><td>", SizeText(part.size), "</td></tr>\n");
  }
  absl::StrAppend(html, "</table>\n");
}

void AppendStep(const AssemblyStep& step, const std::map<std::string, const Part*>& parts,
                const Items& items, const std::string& picture, std::string* html) {
  const auto title = [&](const std::string& name) {
    const auto found = parts.find(name);
    return Escape(found == parts.end() ? name : TitleOf(*found->second));
  };
  absl::StrAppend(html, "<section id=\"step-", step.number, "\">\n<h2>Step ", step.number,
                  "</h2>\n<p>", Escape(step.instruction), "</p>\n");
  if (!picture.empty()) {
    absl::StrAppend(html, "<img alt=\"Step ", step.number, "\" src=\"data:image/png;base64,",
                    absl::Base64Escape(picture), "\">\n");
  }
  absl::StrAppend(html, "<div class=\"columns\">\n");
  if (!step.added_parts.empty()) {
    absl::StrAppend(html, "<table><tr><th>Added part</th><th>Size</th></tr>\n");
    for (const std::string& name : step.added_parts) {
      const auto found = parts.find(name);
      absl::StrAppend(html, "<tr><td>", title(name), "</td><td>",
                      found == parts.end() ? "" : SizeText(found->second->size), "</td></tr>\n");
    }
    absl::StrAppend(html, "</table>\n");
  }
  if (!step.connections.empty()) {
    absl::StrAppend(html, "<table><tr><th>Joint</th><th>Pegs</th></tr>\n");
    for (const StepConnection& connection : step.connections) {
      absl::StrAppend(html, "<tr><td>", title(connection.part), " – ", title(connection.other_part),
                      "</td><td>", connection.pegs, " × ",
                      Escape(ItemTitle(items, connection.item)), "</td></tr>\n");
    }
    absl::StrAppend(html, "</table>\n");
  }
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
  AppendOverview(plan, design, items, &html);
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    AppendStep(plan.steps[i], parts, items, i < pictures.size() ? pictures[i] : "", &html);
  }
  absl::StrAppend(&html, "</body>\n</html>\n");
  return html;
}

}  // namespace mortise::fabplanner
