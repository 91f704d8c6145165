#include "cli/explore/map_page.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/time/time.h"
#include "cli/explore/page_source.h"
#include "cli/explore/surface_pack.h"
#include "common/base/errors.h"
#include "common/pages/number_pack.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;

template <typename Number>
std::span<const Number> SpanOf(const google::protobuf::RepeatedField<Number>& list) {
  return {list.data(), static_cast<std::size_t>(list.size())};
}

absl::Status CheckTree(const v1::MapTree& tree, int metrics) {
  const int elements = tree.coarsest_levels_size(), splines = tree.levels_size();
  const int samples = tree.dimension() > 0 ? tree.positions_size() / tree.dimension() : 0;
  std::int64_t parts = 0;
  for (const int count : tree.sample_counts()) parts += count;
  const bool fits =
      tree.dimension() > 0 && !tree.more() && tree.directions_size() == 2 * elements - 1 &&
      tree.children_size() == tree.directions_size() && tree.cut_off_size() == elements &&
      tree.finest_levels_size() == elements && tree.errors_size() == elements * metrics &&
      tree.centres_size() == splines * tree.dimension() && tree.sample_counts_size() == splines &&
      tree.samples_size() == parts && tree.weights_size() == parts &&
      tree.values_size() == samples * metrics &&
      (tree.coefficients().empty() || tree.coefficients_size() == splines * metrics);
  return fits ? absl::OkStatus() : absl::DataLossError("the tree of the map did not come whole");
}

void PackTree(const v1::MapTree& tree, pages::NumberPack& pack) {
  const std::vector<std::uint8_t> cut_off(tree.cut_off().begin(), tree.cut_off().end());
  pack.Add("directions", SpanOf(tree.directions()));
  pack.Add("children", SpanOf(tree.children()));
  pack.Add("coarsestLevels", SpanOf(tree.coarsest_levels()));
  pack.Add("finestLevels", SpanOf(tree.finest_levels()));
  pack.Add("meshes", SpanOf(tree.meshes()));
  pack.Add("cutOff", std::span<const std::uint8_t>(cut_off));
  pack.Add("errors", SpanOf(tree.errors()));
  pack.Add("levels", SpanOf(tree.levels()));
  pack.Add("centres", SpanOf(tree.centres()));
  pack.Add("sampleCounts", SpanOf(tree.sample_counts()));
  pack.Add("samples", SpanOf(tree.samples()));
  pack.Add("weights", SpanOf(tree.weights()));
  pack.Add("values", SpanOf(tree.values()));
  pack.Add("coefficients", SpanOf(tree.coefficients()));
  pack.Add("shapeErrors", SpanOf(tree.shape_errors()));
  pack.Add("fieldErrors", SpanOf(tree.field_errors()));
}

// The fields of nodes that any sample has, in the map's order.
std::vector<v1::MapShapes::Field> FieldsOf(const v1::DesignMap& map,
                                           const std::vector<ExportedStructure>& structures) {
  std::set<std::pair<std::string, std::string>> sent;
  for (const ExportedStructure& structure : structures) {
    for (const v1::MapExportPart::Sample& sample : structure.samples) {
      for (const v1::MapFieldValues& field : sample.fields()) {
        sent.emplace(field.name(), field.load_case());
      }
    }
  }
  std::vector<v1::MapShapes::Field> fields;
  for (const v1::MapShapes::Field& field : map.shapes().fields()) {
    if (!field.of_elements() && sent.count({field.name(), field.load_case()}) > 0) {
      fields.push_back(field);
    }
  }
  return fields;
}

Json ParametersOf(const v1::DesignMap& map) {
  Json parameters = Json::array();
  for (const v1::MapParameter& parameter : map.parameters()) {
    parameters.push_back({{"name", parameter.name()},
                          {"unit", parameter.unit()},
                          {"minimum", parameter.minimum()},
                          {"maximum", parameter.maximum()},
                          {"whole", parameter.whole()},
                          {"choices", parameter.choices()}});
  }
  return parameters;
}

std::string UnitOf(const v1::DesignMap& map, const std::string& metric) {
  for (const v1::MapMetric& one : map.metrics()) {
    if (one.name() == metric) return one.unit();
  }
  return "";
}

Json VerificationOf(const v1::DesignMap& map) {
  if (!map.has_verification()) return nullptr;
  Json differences = Json::array();
  for (const auto& difference : map.verification().differences()) {
    differences.push_back({{"metric", difference.metric()},
                           {"unit", UnitOf(map, difference.metric())},
                           {"largest", difference.largest()}});
  }
  return {{"points", map.verification().points()}, {"differences", std::move(differences)}};
}

Json FailuresOf(const google::protobuf::RepeatedPtrField<v1::MapFailure>& failures) {
  Json list = Json::array();
  for (const v1::MapFailure& failure : failures) {
    list.push_back({{"count", failure.count()}, {"message", failure.message()}});
  }
  return list;
}

// Returns what the page says of the map.
Json DescriptionOf(const v1::DesignMap& map, const std::vector<v1::MapShapes::Field>& fields,
                   bool with_shapes) {
  const std::string& subject = map.specification().subject();
  Json page = {
      {"name", map.name()},
      {"title", subject.substr(subject.find('/') + 1)},
      {"subject", subject},
      {"revision", map.specification().revision()},
      {"basis", map.specification().basis() == v1::MapSpecification::CUBIC ? "cubic" : "linear"},
      {"created",
       map.has_create_time()
           ? absl::FormatTime("%Y-%m-%d", absl::FromUnixSeconds(map.create_time().seconds()),
                              absl::UTCTimeZone())
           : ""},
      {"evaluations", map.samples() + map.probes()},
      {"elements", map.elements()},
      {"cutOff", map.cut_off_elements()},
      {"shapeless", map.shapeless_elements()},
      {"stale", map.stale()},
      {"parameters", ParametersOf(map)},
      {"verification", VerificationOf(map)}};
  page["fixed"] = Json::array();
  for (const v1::ParameterValue& fixed : map.fixed()) {
    page["fixed"].push_back({{"name", fixed.name()}, {"value", fixed.value()}});
  }
  page["metrics"] = Json::array();
  for (const v1::MapMetric& metric : map.metrics()) {
    page["metrics"].push_back({{"name", metric.name()},
                               {"unit", metric.unit()},
                               {"minimum", metric.minimum()},
                               {"maximum", metric.maximum()}});
  }
  page["failures"] = FailuresOf(map.failures());
  page["unmapped"] = map.shapes().unmapped();
  page["unmappedFailures"] = FailuresOf(map.shapes().unmapped_failures());
  page["fields"] = Json::array();
  for (const v1::MapShapes::Field& field : fields) {
    page["fields"].push_back({{"name", field.name()},
                              {"unit", field.unit()},
                              {"loadCase", field.load_case()},
                              {"components", field.components()},
                              {"minimum", field.minimum()},
                              {"maximum", field.maximum()}});
  }
  if (map.has_shapes() && with_shapes) {
    page["shapes"] = {{"designs", map.shapes().shapes()},
                      {"largestError", map.shapes().largest_error()},
                      {"rounding", map.shapes().rounding()}};
  }
  return page;
}

// Writes packs beside the page, which names them.
class PackWriter {
 public:
  // Returns the name of the element that has it.
  absl::StatusOr<std::string> Write(const pages::NumberPack& pack) {
    const std::string name = absl::StrCat("pack-", count_++);
    MORTISE_ASSIGN_OR_RETURN(const std::string text, pack.Text());
    absl::StrAppend(&elements_, "<script type=\"text/plain\" id=\"", name, "\">", text,
                    "</script>\n");
    return name;
  }
  const std::string& elements() const { return elements_; }

 private:
  int count_ = 0;
  std::string elements_;
};

absl::StatusOr<Json> StructureOf(const v1::DesignMap& map, const ExportedStructure& structure,
                                 const std::vector<v1::MapShapes::Field>& fields,
                                 PackWriter& packs) {
  MORTISE_RETURN_IF_ERROR(CheckTree(structure.tree, map.metrics_size()));
  Json values = Json::array();
  for (const v1::ParameterValue& value : map.structures(structure.structure).values()) {
    values.push_back(value.value());
  }
  pages::NumberPack tree;
  PackTree(structure.tree, tree);
  Json written = {{"values", values}, {"dimension", structure.tree.dimension()}};
  MORTISE_ASSIGN_OR_RETURN(written["pack"], packs.Write(tree));
  written["lists"] = tree.lists();
  if (structure.samples.empty()) return written;
  pages::NumberPack pack;
  MORTISE_ASSIGN_OR_RETURN(Json shapes, PackSurfaces(structure, fields, pack));
  MORTISE_ASSIGN_OR_RETURN(shapes["pack"], packs.Write(pack));
  shapes["lists"] = pack.lists();
  written["shapes"] = std::move(shapes);
  return written;
}

}  // namespace

absl::StatusOr<std::string> MapPage(const v1::DesignMap& map,
                                    const std::vector<ExportedStructure>& structures) {
  const std::vector<v1::MapShapes::Field> fields = FieldsOf(map, structures);
  const bool with_shapes = std::ranges::any_of(
      structures, [](const ExportedStructure& one) { return !one.samples.empty(); });
  Json page = DescriptionOf(map, fields, with_shapes);
  PackWriter packs;
  page["structures"] = Json::array();
  for (const ExportedStructure& structure : structures) {
    MORTISE_ASSIGN_OR_RETURN(Json written, StructureOf(map, structure, fields, packs));
    page["structures"].push_back(std::move(written));
  }
  // Nothing in it can end the element that holds it. Texts of others may be no UTF-8.
  const std::string described = absl::StrReplaceAll(
      page.dump(-1, ' ', false, Json::error_handler_t::replace), {{"<", "\\u003c"}});
  return absl::StrReplaceAll(std::string(PageSource()),
                             {{"@@MAP@@", described}, {"@@PACKS@@", packs.elements()}});
}

}  // namespace mortise::cli
