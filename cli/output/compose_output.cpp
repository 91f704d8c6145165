#include "cli/output/compose_output.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/requests.h"

namespace mortise::cli {
namespace {

constexpr std::size_t kMostNamed = 5;

// "900 x 300 x 1800 mm".
std::string SizeText(const v1::Vector3& minimum, const v1::Vector3& maximum) {
  return absl::StrFormat("%.4g x %.4g x %.4g mm", 1000 * (maximum.x() - minimum.x()),
                         1000 * (maximum.y() - minimum.y()), 1000 * (maximum.z() - minimum.z()));
}

// m, in millimetres to a nanometre: what rounding has left of 0 is 0.
double ToMillimetres(double metres) { return std::round(1e9 * metres) / 1e6; }

std::string PlaceText(const v1::Vector3& minimum) {
  return absl::StrFormat("%.4g, %.4g, %.4g mm", ToMillimetres(minimum.x()),
                         ToMillimetres(minimum.y()), ToMillimetres(minimum.z()));
}

std::string OriginText(const v1::ModelComponent& component) {
  std::string turns;
  for (const int axis : component.turns()) {
    absl::StrAppend(&turns, absl::AsciiStrToLower(v1::Axis_Name(axis)));
  }
  return absl::StrCat(component.template_(), component.group().empty() ? "" : ", ",
                      component.group(), turns.empty() ? "" : ", turned ", turns);
}

std::string PartsText(const v1::Model& model, const std::string& component) {
  const auto is_its = [&](const v1::ModelPart& part) { return part.component() == component; };
  const auto parts = std::count_if(model.parts().begin(), model.parts().end(), is_its);
  return absl::StrCat(parts);
}

// What is named besides the first: " with 'back', 'bottom' and 3 more".
std::string OthersText(const std::vector<std::string>& others) {
  if (others.empty()) return "";
  const auto named = static_cast<std::ptrdiff_t>(std::min(others.size(), kMostNamed));
  return absl::StrCat(
      " with '", absl::StrJoin(others.begin(), others.begin() + named, "', '"), "'",
      others.size() > kMostNamed ? absl::StrCat(" and ", others.size() - kMostNamed, " more") : "");
}

}  // namespace

void PrintModel(const v1::Model& model, Output& output) {
  output.Line(absl::StrCat(model.name(), ", revision ", model.revision(), ": ", model.last_step(),
                           model.title().empty() ? "" : absl::StrCat(" (", model.title(), ")")));
  std::vector<std::vector<std::string>> rows;
  for (const v1::ModelComponent& component : model.components()) {
    rows.push_back({component.id(), OriginText(component),
                    absl::AsciiStrToLower(v1::ModelComponent::State_Name(component.state())),
                    PartsText(model, component.id()),
                    SizeText(component.minimum(), component.maximum()),
                    PlaceText(component.minimum())});
  }
  output.Table({"component", "of", "state", "parts", "size", "from"}, rows);
  PrintWarnings(model, output);
  output.DocumentOf(model);
}

void PrintWarnings(const v1::Model& model, const Output& output) {
  for (const v1::ModelWarning& warning : model.warnings()) {
    if (warning.elements().empty()) {
      output.Line(absl::StrCat("warning: ", warning.component(), ": ", warning.text()));
      continue;
    }
    const std::string others =
        OthersText({warning.elements().begin() + 1, warning.elements().end()});
    output.Line(absl::StrCat("warning: '", warning.element(), "' of ", warning.component(), others,
                             ": ", warning.text()));
  }
}

void PrintComponent(const v1::Model& model, const std::string& component, const Output& output) {
  for (const v1::ModelComponent& each : model.components()) {
    if (each.id() != component) continue;
    for (const v1::SnapAlignment& alignment : each.alignments()) {
      output.Line(absl::StrCat("  ", alignment.text()));
    }
    for (const v1::ModelConnection& connection : each.connections()) {
      output.Line(absl::StrFormat(
          "  %s: as %s of %s, %d parts%s", absl::StrJoin(connection.principals(), " with "),
          connection.copy_of(), connection.source(), connection.parts_size(),
          connection.moved_by() > 0 ? ", moved by " + Millimetres(connection.moved_by()) : ""));
    }
  }
}

void PrintPreview(const v1::DragPreview& preview, Output& output) {
  output.Line(absl::StrCat("revision ", preview.revision(),
                           ", not changed: ", Millimetres(preview.value()), " gives ",
                           Millimetres(preview.reached())));
  std::vector<std::vector<std::string>> rows;
  for (const v1::MovedPart& part : preview.moved()) {
    rows.push_back({part.name(), "moves", SizeText(part.minimum(), part.maximum()),
                    PlaceText(part.minimum())});
  }
  for (const v1::ModelPart& part : preview.added()) {
    rows.push_back({part.name(), "comes", SizeText(part.minimum(), part.maximum()),
                    PlaceText(part.minimum())});
  }
  for (const std::string& name : preview.removed()) rows.push_back({name, "goes", "", ""});
  output.Table({"part", "", "size", "from"}, rows);
  output.DocumentOf(preview);
}

}  // namespace mortise::cli
