#include "cli/output/map_output.h"

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/requests.h"
#include "cli/files/map_points.h"

namespace mortise::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string Text(const std::string& unit, double value) {
  return MetricText(MetricOf(unit, value));
}

const v1::MapParameter* FindParameter(const v1::DesignMap& map, const std::string& name) {
  for (const v1::MapParameter& parameter : map.parameters()) {
    if (parameter.name() == name) return &parameter;
  }
  return nullptr;
}

// "length 1.4, material oak".
std::string ValuesText(const v1::DesignMap& map,
                       const google::protobuf::RepeatedPtrField<v1::ParameterValue>& values) {
  return absl::StrJoin(values, ", ", [&](std::string* out, const v1::ParameterValue& value) {
    const v1::MapParameter* const parameter = FindParameter(map, value.name());
    absl::StrAppend(out, value.name(), " ",
                    parameter == nullptr ? absl::StrFormat("%.6g", value.value())
                                         : ParameterText(*parameter, value.value()));
  });
}

void PrintParameters(const v1::DesignMap& map, const Output& output) {
  Rows rows;
  for (const v1::MapParameter& parameter : map.parameters()) {
    rows.push_back({parameter.name(), RangeText(parameter)});
  }
  output.Table({"parameter", "values"}, rows);
  if (!map.fixed().empty()) output.Line("  fixed: " + ValuesText(map, map.fixed()));
}

// What is taken for chance, of a metric, the shape or a field.
template <typename Message>
std::string NoiseText(const std::string& floor, const Message& of) {
  if (of.noise_estimated()) return absl::StrCat("about ", floor);
  return of.noise_floor() > 0 ? floor : "none";
}

void PrintMetrics(const v1::DesignMap& map, const Output& output) {
  Rows rows;
  for (const v1::MapMetric& metric : map.metrics()) {
    rows.push_back({metric.name(), Text(metric.unit(), metric.minimum()),
                    Text(metric.unit(), metric.maximum()),
                    Text(metric.unit(), metric.largest_error()),
                    Text(metric.unit(), metric.mean_error()),
                    NoiseText(Text(metric.unit(), metric.noise_floor()), metric)});
  }
  if (rows.empty()) return;
  output.Table({"metric", "from", "to", "off at most", "off in the mean", "noise"}, rows);
}

// A field with its load case.
std::string FieldText(const std::string& name, const std::string& load_case) {
  return load_case.empty() ? name : absl::StrCat(name, ", ", load_case);
}

void PrintShapes(const v1::DesignMap& map, const Output& output) {
  if (!map.has_shapes()) return;
  const v1::MapShapes& shapes = map.shapes();
  output.Line(absl::StrFormat(
      "  shapes: %d in %d %s of up to %d nodes, %d triangles and %d tetrahedra, %.3g MB on disk",
      shapes.shapes(), shapes.meshes(), shapes.meshes() == 1 ? "mesh" : "meshes", shapes.nodes(),
      shapes.triangles(), shapes.tetrahedra(), static_cast<double>(shapes.bytes()) / 1e6));
  if (shapes.inverted_tetrahedra() > 0 || shapes.unmapped() > 0) {
    output.Line(absl::StrFormat("  %d tetrahedra are turned over, %d designs are in no mesh",
                                shapes.inverted_tetrahedra(), shapes.unmapped()));
  }
  Rows rows = {{"shape", "", Text("m", shapes.size()), Text("m", shapes.largest_error()),
                Text("m", shapes.largest_99_error()), Text("m", shapes.mean_error()),
                NoiseText(absl::StrFormat("%.3g of its size", shapes.noise_floor()), shapes)}};
  for (const v1::MapShapes::Field& field : shapes.fields()) {
    rows.push_back({FieldText(field.name(), field.load_case()), Text(field.unit(), field.minimum()),
                    Text(field.unit(), field.maximum()), Text(field.unit(), field.largest_error()),
                    Text(field.unit(), field.largest_99_error()),
                    Text(field.unit(), field.mean_error()),
                    NoiseText(absl::StrFormat("%.3g of its range", field.noise_floor()), field)});
  }
  output.Table({"of shapes", "from", "to", "off at most", "99 of 100", "off in the mean", "noise"},
               rows);
}

void PrintShapeDifferences(const v1::MapVerification& verification, const Output& output) {
  Rows rows;
  for (const v1::MapVerification::ShapeDifference& difference : verification.shapes()) {
    rows.push_back({difference.field().empty()
                        ? "shape, of its size"
                        : FieldText(difference.field(), difference.load_case()) + ", of its range",
                    absl::StrFormat("%.3g", difference.largest()),
                    absl::StrFormat("%.3g", difference.largest_99()),
                    absl::StrFormat("%.3g", difference.mean())});
  }
  if (!rows.empty()) output.Table({"of shapes", "off at most", "99 of 100", "in the mean"}, rows);
}

void PrintStructures(const v1::DesignMap& map, const Output& output) {
  if (map.structures_size() < 2) return;
  Rows rows;
  for (const v1::MapStructure& structure : map.structures()) {
    rows.push_back({ValuesText(map, structure.values()), absl::StrCat(structure.samples()),
                    absl::StrCat(structure.probes()), absl::StrCat(structure.elements()),
                    absl::StrCat(structure.cut_off_elements()),
                    absl::StrCat(structure.shapeless_elements()),
                    absl::AsciiStrToLower(structure.stop_reason())});
  }
  std::vector<std::string> titles = {"structure", "samples",  "probes",    "elements",
                                     "cut off",   "no shape", "stopped by"};
  if (!map.has_shapes()) {
    constexpr std::ptrdiff_t kNoShape = 5;
    titles.erase(titles.begin() + kNoShape);
    for (std::vector<std::string>& row : rows) row.erase(row.begin() + kNoShape);
  }
  output.Table(titles, rows);
}

void PrintUnmapped(const v1::DesignMap& map, const Output& output) {
  for (const v1::MapFailure& failure : map.shapes().unmapped_failures()) {
    output.Line(absl::StrFormat("  %d times a design was not brought into a mesh, %s: %s",
                                failure.count(), failure.reason(), failure.message()));
  }
}

void PrintFailures(const v1::DesignMap& map, const Output& output) {
  for (const v1::MapFailure& failure : map.failures()) {
    std::vector<std::string> design;
    for (int i = 0; i < failure.parameters_size() && i < map.parameters_size(); ++i) {
      const v1::MapParameter& parameter = map.parameters(i);
      design.push_back(
          absl::StrCat(parameter.name(), " ", ParameterText(parameter, failure.parameters(i))));
    }
    output.Line(absl::StrFormat("  %d failed with %s, such as at %s: %s", failure.count(),
                                failure.reason(), absl::StrJoin(design, ", "), failure.message()));
  }
  if (map.cut_off_elements() > 0) {
    output.Line(absl::StrFormat("  %d of %d elements have no values, as %s there",
                                map.cut_off_elements(), map.elements(), WhyNoValues(map)));
  }
  if (map.shapeless_elements() > 0) {
    output.Line(absl::StrFormat("  %d of %d elements have metrics and no shapes, as %s there",
                                map.shapeless_elements(), map.elements(), kWhyNoShape));
  }
}

void PrintGradients(const v1::DesignMap& map, const v1::EvaluateMapResponse& answer,
                    const Output& output) {
  const std::size_t metrics = static_cast<std::size_t>(answer.metrics_size());
  const std::size_t parameters = static_cast<std::size_t>(map.parameters_size());
  Rows rows;
  for (std::size_t k = 0; k < static_cast<std::size_t>(answer.gradients_size()); ++k) {
    const int metric = static_cast<int>(k / parameters % metrics);
    const v1::MapParameter& parameter = map.parameters(static_cast<int>(k % parameters));
    rows.push_back(
        {absl::StrCat(k / parameters / metrics + 1), answer.metrics(metric), parameter.name(),
         absl::StrFormat("%.5g %s per %s", answer.gradients(static_cast<int>(k)),
                         answer.units(metric), parameter.unit().empty() ? "1" : parameter.unit())});
  }
  if (!rows.empty()) output.Table({"point", "metric", "parameter", "gradient"}, rows);
}

}  // namespace

std::string WhyNoValues(const v1::DesignMap& map) {
  // Maps that earlier versions built have no metrics either where they have no shapes.
  const bool is_of_shapes = map.shapes().unmapped() > 0 && map.shapeless_elements() == 0;
  if (!is_of_shapes) return "evaluations failed";
  if (map.failures().empty()) return kWhyNoShape;
  return absl::StrCat("evaluations failed or ", kWhyNoShape);
}

void PrintMap(const v1::DesignMap& map, const Output& output) {
  output.Line(absl::StrFormat(
      "%s of %s at revision %d: %d samples and %d probes (%d failed), %d elements, stopped by %s",
      map.name(), map.specification().subject(), map.specification().revision(), map.samples(),
      map.probes(), map.failed_evaluations(), map.elements(),
      absl::AsciiStrToLower(map.stop_reason())));
  PrintStale(map, output);
  PrintParameters(map, output);
  PrintMetrics(map, output);
  PrintShapes(map, output);
  PrintStructures(map, output);
  PrintUnmapped(map, output);
  PrintFailures(map, output);
  PrintVerification(map, output);
}

void PrintStale(const v1::DesignMap& map, const Output& output) {
  if (!map.stale()) return;
  output.Line(absl::StrFormat("  of revision %d: %s has a newer one by now, or is gone",
                              map.specification().revision(), map.specification().subject()));
}

void PrintVerification(const v1::DesignMap& map, const Output& output) {
  if (!map.has_verification()) return;
  const v1::MapVerification& verification = map.verification();
  output.Line(absl::StrFormat("verified at %d designs (%d failed, %d without values in the map)",
                              verification.points(), verification.failed(),
                              verification.uncovered()));
  if (verification.shapeless() > 0) {
    output.Line(absl::StrFormat("  the map has no shape of %d of them: their metrics are compared",
                                verification.shapeless()));
  }
  if (verification.unmapped() > 0) {
    output.Line(
        absl::StrFormat("  %d of them could not be brought into the map's mesh: their shapes are "
                        "compared, no fields",
                        verification.unmapped()));
  }
  Rows rows;
  for (const v1::MapVerification::Difference& difference : verification.differences()) {
    std::string unit;
    for (const v1::MapMetric& metric : map.metrics()) {
      if (metric.name() == difference.metric()) unit = metric.unit();
    }
    rows.push_back({difference.metric(), Text(unit, difference.largest()),
                    Text(unit, difference.largest_99()), Text(unit, difference.mean())});
  }
  if (!rows.empty()) output.Table({"metric", "off at most", "99 of 100", "in the mean"}, rows);
  PrintShapeDifferences(verification, output);
}

void PrintPoints(const v1::DesignMap& map, const std::vector<double>& points,
                 const v1::EvaluateMapResponse& answer, const Output& output) {
  const std::set<int> uncovered(answer.uncovered().begin(), answer.uncovered().end());
  const std::size_t parameters = static_cast<std::size_t>(map.parameters_size());
  std::vector<std::string> titles = {"point"};
  for (const v1::MapParameter& parameter : map.parameters()) titles.push_back(parameter.name());
  titles.insert(titles.end(), answer.metrics().begin(), answer.metrics().end());
  Rows rows;
  for (std::size_t i = 0; i < points.size() / parameters; ++i) {
    const int point = static_cast<int>(i);
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(absl::StrCat(point + 1));
    for (std::size_t k = 0; k < parameters; ++k) {
      row.push_back(ParameterText(map.parameters(static_cast<int>(k)), points[i * parameters + k]));
    }
    for (int k = 0; k < answer.metrics_size(); ++k) {
      const int at = point * answer.metrics_size() + k;
      row.push_back(uncovered.count(point) > 0
                        ? "none"
                        : absl::StrCat(Text(answer.units(k), answer.values(at)), " ± ",
                                       Text(answer.units(k), answer.errors(at))));
    }
  }
  output.Table(titles, rows);
  if (!uncovered.empty()) {
    output.Line(
        absl::StrCat(uncovered.size(), " without values: they lie where ", WhyNoValues(map)));
  }
  PrintGradients(map, answer, output);
}

}  // namespace mortise::cli
