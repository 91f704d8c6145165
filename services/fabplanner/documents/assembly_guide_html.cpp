#include "services/fabplanner/documents/assembly_guide_html.h"

#include <cmath>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/render/image.h"
#include "services/fabplanner/documents/guide_page_source.h"
#include "services/fabplanner/documents/step_view.h"
#include "services/fabplanner/documents/svg_drawing.h"

namespace mortise::fabplanner {
namespace {

constexpr std::size_t kMostOpenRows = 12;  // of a table of a step; longer ones are folded

std::string Escaped(const std::string& text) { return SvgDrawing::Escape(text); }

std::string ImageOf(const std::string& png) {
  return absl::StrCat("src=\"data:image/png;base64,", absl::Base64Escape(png), "\"");
}

void AppendTable(const GuideTable& table, const std::vector<GuideFastener>& fasteners,
                 std::string* html) {
  const bool has_pictures = !table.rows.empty() && table.rows.front().fastener >= 0;
  absl::StrAppend(html, "<div class=\"scroll\"><table", has_pictures ? " class=\"fasteners\"" : "",
                  "><tr><th></th>", has_pictures ? "<th></th>" : "");
  for (const std::string& column : table.columns) {
    absl::StrAppend(html, "<th>", Escaped(column), "</th>");
  }
  absl::StrAppend(html, "</tr>\n");
  for (const GuideRow& row : table.rows) {
    absl::StrAppend(html, "<tr><td class=\"count\">", row.count, " ×</td>");
    if (has_pictures) {
      absl::StrAppend(html, "<td><img class=\"fastener\" alt=\"\" ",
                      ImageOf(fasteners[static_cast<std::size_t>(row.fastener)].picture), "></td>");
    }
    for (const std::string& cell : row.cells) {
      absl::StrAppend(html, "<td>", Escaped(cell), "</td>");
    }
    absl::StrAppend(html, "</tr>\n");
  }
  absl::StrAppend(html, "</table></div>\n");
}

// A table of the overview, under its heading.
void AppendHeadedTable(const GuideTable& table, const std::vector<GuideFastener>& fasteners,
                       std::string* html) {
  absl::StrAppend(html, "<h3>", Escaped(table.heading), "</h3>\n");
  if (!table.note.empty()) {
    absl::StrAppend(html, "<p class=\"quiet\">", Escaped(table.note), "</p>\n");
  }
  AppendTable(table, fasteners, html);
}

// A table of a step; a long one is there on demand.
void AppendStepTable(const GuideTable& table, const std::vector<GuideFastener>& fasteners,
                     std::string* html) {
  if (!table.heading.empty()) absl::StrAppend(html, "<h3>", Escaped(table.heading), "</h3>\n");
  const bool is_folded = table.rows.size() > kMostOpenRows;
  if (is_folded) {
    absl::StrAppend(html, "<details><summary>", Escaped(table.columns.back()), ": all ",
                    table.rows.size(), " lines</summary>\n");
  }
  AppendTable(table, fasteners, html);
  if (is_folded) absl::StrAppend(html, "</details>\n");
}

void AppendKey(const render::Color& color, const char* meaning, std::string* html) {
  absl::StrAppend(html, "<span class=\"key\" style=\"background:", render::HexColor(color),
                  "\"></span>", meaning);
}

void AppendOverview(const GuideContents& contents, double rounding, std::string* html) {
  absl::StrAppend(
      html, "<header>\n<h1>", Escaped(contents.title),
      "</h1>\n<p class=\"quiet\">Assembly guide. Sizes in millimetres: length × width × "
      "thickness.</p>\n</header>\n<div class=\"overview\">\n<p>",
      Escaped(contents.summary), ". In the pictures ");
  AppendKey(kAddedColor, "is what comes in, ", html);
  AppendKey(kPresentColor, "what is built already, ", html);
  AppendKey(kPegColor, contents.has_ways ? "what holds it together" : "pegs", html);
  absl::StrAppend(html, "; arrows show where things go.</p>\n");
  for (const std::string& note : contents.notes) {
    absl::StrAppend(html, "<p class=\"quiet\">", Escaped(note), "</p>\n");
  }
  absl::StrAppend(html, "<ul class=\"step-links\">");
  for (const GuideStep& step : contents.steps) {
    absl::StrAppend(html, "<li><a href=\"#step-", step.number, "\">", Escaped(step.title),
                    "</a></li>\n");
  }
  absl::StrAppend(html, "</ul>\n");
  for (const GuideTable& table : contents.tables) {
    AppendHeadedTable(table, contents.fasteners, html);
  }
  absl::StrAppend(html, "<p class=\"quiet\">Shapes that can be turned are rounded: no corner is ",
                  "moved by more than ", absl::StrCat(std::ceil(rounding * 1e5) / 100),
                  " mm.</p>\n</div>\n");
}

void AppendStep(const GuideStep& step, const std::string& picture,
                const std::vector<GuideFastener>& fasteners, std::string* html) {
  absl::StrAppend(html, "<section class=\"step\" id=\"step-", step.number, "\" data-step=\"",
                  step.number, "\" aria-labelledby=\"title-", step.number, "\">\n<h2 id=\"title-",
                  step.number, "\">", Escaped(step.title), "</h2>\n<p class=\"instruction\">",
                  Escaped(step.instruction), "</p>\n<div class=\"step-body\">\n<figure>");
  if (!picture.empty()) {
    absl::StrAppend(html, "<img alt=\"Step ", step.number,
                    ": what stands and what comes in\" width=\"900\" height=\"675\" ",
                    ImageOf(picture), ">");
  }
  absl::StrAppend(html,
                  "<figcaption><button type=\"button\" class=\"turn\" hidden>Turn in 3D</button>"
                  "</figcaption></figure>\n<div>\n");
  for (const GuideTable& table : step.tables) AppendStepTable(table, fasteners, html);
  absl::StrAppend(html, "</div>\n</div>\n</section>\n");
}

}  // namespace

std::string AssemblyGuideHtml(const GuideContents& contents,
                              const std::vector<std::string>& pictures, const GuideScene& scene) {
  std::string content;
  AppendOverview(contents, scene.rounding, &content);
  absl::StrAppend(&content, "<main>\n");
  for (std::size_t i = 0; i < contents.steps.size(); ++i) {
    AppendStep(contents.steps[i], i < pictures.size() ? pictures[i] : "", contents.fasteners,
               &content);
  }
  absl::StrAppend(&content, "</main>\n");
  // Nothing in it can end the element that holds it.
  const std::string described = absl::StrReplaceAll(scene.description.dump(), {{"<", "\\u003c"}});
  return absl::StrReplaceAll(std::string(GuidePageSource()),
                             {{"@@TITLE@@", Escaped(contents.title)},
                              {"@@CONTENT@@", content},
                              {"@@SCENE@@", described},
                              {"@@PACK@@", scene.pack}});
}

}  // namespace mortise::fabplanner
