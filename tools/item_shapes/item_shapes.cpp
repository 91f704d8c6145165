#include "tools/item_shapes/item_shapes.h"

#include <algorithm>
#include <regex>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/cad/step/step_reader.h"
#include "common/cad/step/step_writer.h"
#include "common/files/csv_table.h"
#include "common/templates/features/codec/cad_template_codec.h"
#include "common/templates/features/feature_model.h"
#include "services/catalog/exchange/shape_import.h"

namespace mortise::catalog {
namespace {

constexpr double kNarrow = 1e-9;

// "diameter=0.05; width=0.019"
absl::StatusOr<std::vector<parametric::NamedValue>> ParseDimensions(const std::string& text) {
  std::vector<parametric::NamedValue> dimensions;
  for (const absl::string_view part : absl::StrSplit(text, ';', absl::SkipWhitespace())) {
    const std::vector<std::string> sides = absl::StrSplit(part, '=');
    if (sides.size() != 2) return InvalidField("", "must be name=value, with semicolons between");
    MORTISE_ASSIGN_OR_RETURN(const double value, parametric::ParseCsvNumber(sides[1]));
    dimensions.push_back({std::string(absl::StripAsciiWhitespace(sides[0])), value});
  }
  return dimensions;
}

// The drawing with one value for each parameter, in a range as narrow as a template may have: how
// far its dimensions may be changed together is not asked, since the list says which there are.
absl::Status SetDimensions(const std::vector<parametric::NamedValue>& dimensions,
                           cad::CadTemplate& drawing) {
  for (const parametric::NamedValue& dimension : dimensions) {
    const auto parameter =
        std::find_if(drawing.parameters.begin(), drawing.parameters.end(),
                     [&](const auto& known) { return known.name == dimension.name; });
    if (parameter == drawing.parameters.end()) {
      return InvalidField(dimension.name, absl::StrCat("is no parameter of ", drawing.name));
    }
    parameter->default_value = dimension.value;
  }
  for (parametric::Parameter& parameter : drawing.parameters) {
    parameter.minimum = parameter.default_value - kNarrow;
    parameter.maximum = parameter.default_value + kNarrow;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<ItemShape>> ReadShapeList(const std::filesystem::path& folder) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(folder / "shapes.csv"));
  const parametric::CsvTable table = parametric::ParseCsv(text);
  std::vector<FieldViolation> findings = table.findings;
  std::vector<ItemShape> shapes;
  for (std::size_t i = 1; i < table.rows.size(); ++i) {
    const parametric::CsvRow& row = table.rows[i];
    if (row.size() != 3) {
      findings.push_back({parametric::PlaceOf(row[0]), "must have shape, drawing and dimensions"});
      continue;
    }
    auto dimensions = ParseDimensions(row[2].text);
    if (!dimensions.ok()) {
      findings.push_back({parametric::PlaceOf(row[2]), std::string(dimensions.status().message())});
      continue;
    }
    shapes.push_back({row[0].text, row[1].text, *std::move(dimensions)});
  }
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  return shapes;
}

absl::StatusOr<cad::Solid> DrawSolid(const std::filesystem::path& folder, const ItemShape& shape) {
  const std::filesystem::path file = folder / (shape.drawing + ".textproto");
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file));
  MORTISE_ASSIGN_OR_RETURN(cad::CadTemplate drawing,
                           cad::ParseCadTemplateText(text, file.string()));
  MORTISE_RETURN_IF_ERROR(SetDimensions(shape.dimensions, drawing));
  MORTISE_ASSIGN_OR_RETURN(const cad::FeatureModel model,
                           cad::FeatureModel::Create(std::move(drawing)));
  MORTISE_ASSIGN_OR_RETURN(const cad::RegeneratedModel drawn, model.Regenerate(model.Defaults()));
  return drawn.solid;
}

absl::StatusOr<std::string> DrawStep(const std::filesystem::path& folder, const ItemShape& shape) {
  MORTISE_ASSIGN_OR_RETURN(const cad::Solid solid, DrawSolid(folder, shape));
  MORTISE_ASSIGN_OR_RETURN(const std::string step, cad::WriteStep(shape.name, {{solid}}));
  // The kernel writes when; what has not changed is to stay the same file.
  static const std::regex kTime("'[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9:]{8}'");
  return std::regex_replace(step, kTime, "'2026-01-15T00:00:00'",
                            std::regex_constants::format_first_only);
}

absl::StatusOr<v1::Shape> ShapeOfFile(const std::string& step) {
  MORTISE_ASSIGN_OR_RETURN(const cad::StepAssembly drawing, cad::ReadStep(step));
  MORTISE_ASSIGN_OR_RETURN(const mesh::DrawnShape shape, ShapeOfStep(drawing));
  v1::Shape message = parametric::ToProto(shape);
  message.set_name(parametric::NameOf(message));
  return message;
}

}  // namespace mortise::catalog
