#include "cli/client/requests.h"

#include <grpcpp/grpcpp.h>
#include <grpcpp/impl/codegen/proto_utils.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "absl/types/span.h"
#include "common/base/decimal_number.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/units.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

constexpr double kMinInMegapascal = 1e4;  // Pa

struct Unit {
  absl::string_view name;
  double size;           // of `si`
  absl::string_view si;  // the SI unit of what is said with it
};

constexpr double kInch = 25.4 * kMillimetre;

constexpr Unit kLengths[] = {{"m", 1, "m"},
                             {"cm", 10 * kMillimetre, "m"},
                             {"mm", kMillimetre, "m"},
                             {"in", kInch, "m"},
                             {"\"", kInch, "m"}};
constexpr Unit kAngles[] = {{"deg", M_PI / 180, "rad"}, {"rad", 1, "rad"}};
constexpr Unit kOthersOfMetrics[] = {
    {"kg", 1, "kg"},    {"g", 1e-3, "kg"},          {"Pa", 1, "Pa"},
    {"kPa", 1e3, "Pa"}, {"MPa", kMegapascal, "Pa"}, {"GPa", 1e9, "Pa"},
    {"N", 1, "N"},      {"kN", 1e3, "N"},           {"Hz", 1, "Hz"},
    {"kHz", 1e3, "Hz"}};

using Units = std::vector<Unit>;

Units Together(absl::Span<const Unit> some, absl::Span<const Unit> others) {
  Units all(some.begin(), some.end());
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

Units UnitsOfMetrics() { return Together(kLengths, kOthersOfMetrics); }

// A number as it is said, and the unit behind it, which may be empty.
struct SaidQuantity {
  double number;
  absl::string_view unit;
};

// "1/8", "1 3/4" or "-1/8"; nothing for what has no fraction.
std::optional<double> FractionOf(absl::string_view text) {
  const double sign = absl::ConsumePrefix(&text, "-") ? -1 : 1;
  const std::size_t space = text.rfind(' ');
  const bool has_whole = space != absl::string_view::npos;
  const std::vector<absl::string_view> halves =
      absl::StrSplit(has_whole ? text.substr(space + 1) : text, '/');
  if (halves.size() != 2) return std::nullopt;
  unsigned whole = 0, numerator = 0, denominator = 0;
  const bool are_numbers = (!has_whole || absl::SimpleAtoi(text.substr(0, space), &whole)) &&
                           absl::SimpleAtoi(halves[0], &numerator) &&
                           absl::SimpleAtoi(halves[1], &denominator) && denominator > 0;
  if (!are_numbers) return std::nullopt;
  return sign * (whole + static_cast<double>(numerator) / denominator);
}

// Nothing if the text begins with no number.
std::optional<SaidQuantity> Said(absl::string_view text) {
  const absl::string_view whole = absl::StripAsciiWhitespace(text);
  for (const absl::string_view inch : {"in", "\""}) {
    if (!absl::EndsWith(whole, inch)) continue;
    const absl::string_view before = whole.substr(0, whole.size() - inch.size());
    const auto fraction = FractionOf(absl::StripAsciiWhitespace(before));
    if (fraction) return SaidQuantity{*fraction, inch};
  }
  const auto number = DecimalNumberPrefix(std::string_view(whole.data(), whole.size()));
  if (!number) return std::nullopt;
  return SaidQuantity{number->value, absl::StripAsciiWhitespace(whole.substr(number->length))};
}

std::string NamesOf(absl::Span<const Unit> units) {
  return absl::StrJoin(units, ", ",
                       [](std::string* out, const Unit& unit) { absl::StrAppend(out, unit.name); });
}

// The units that the values of a range, or one value, are said with.
Units UnitsSaid(const std::string& text) {
  Units units;
  for (const absl::string_view value : absl::StrSplit(text, ':')) {
    const std::optional<SaidQuantity> said = Said(value);
    if (!said) continue;
    for (const Unit& unit : UnitsOfMetrics()) {
      if (unit.name == said->unit) units.push_back(unit);
    }
  }
  return units;
}

absl::StatusOr<double> ParseWithUnit(const std::string& text, const std::string& field,
                                     absl::Span<const Unit> units) {
  const std::optional<SaidQuantity> said = Said(text);
  if (!said) return InvalidField(field, absl::StrCat("'", text, "' is not a number"));
  if (said->unit.empty()) return said->number;
  // No unit has digits: 0x10, 1_000 and 1,5 are other notations of numbers.
  if (std::any_of(said->unit.begin(), said->unit.end(),
                  [](unsigned char c) { return absl::ascii_isdigit(c); })) {
    return InvalidField(field, absl::StrCat("'", text, "' is no decimal number, such as 12.5",
                                            units.front().name, "; units: ", NamesOf(units)));
  }
  for (const Unit& unit : units) {
    if (unit.name == said->unit) return said->number * unit.size;
  }
  return InvalidField(
      field, absl::StrCat("'", said->unit, "' is not a unit known here: ", NamesOf(units)));
}

// As ParseWithUnit, of a quantity whose unit can only be one of `units`.
absl::StatusOr<double> ParseKind(const std::string& text, const std::string& field,
                                 absl::string_view kind, absl::Span<const Unit> units,
                                 absl::Span<const Unit> of_others) {
  const std::optional<SaidQuantity> said = Said(text);
  const bool is_of_other = said && std::ranges::any_of(of_others, [&](const Unit& unit) {
                             return unit.name == said->unit;
                           });
  if (!is_of_other) return ParseWithUnit(text, field, units);
  return InvalidField(field,
                      absl::StrCat("'", text, "' is not ", kind, ", which is in ", NamesOf(units)));
}

// What `text` ends with behind its last dot; nothing if it has none.
std::string LastWord(const std::string& text) {
  const std::size_t dot = text.rfind('.');
  return dot == std::string::npos ? "" : text.substr(dot + 1);
}

void CutLastWord(std::string& text) { text.resize(text.rfind('.')); }

v1::Measure::Kind KindOf(const std::string& word) {
  if (word == "size") return v1::Measure::SIZE;
  if (word == "center") return v1::Measure::CENTER;
  if (word == "minimum") return v1::Measure::MINIMUM;
  if (word == "maximum") return v1::Measure::MAXIMUM;
  return v1::Measure::KIND_UNSPECIFIED;
}

v1::Axis AxisOf(const std::string& word) {
  if (word == "x") return v1::X;
  if (word == "y") return v1::Y;
  if (word == "z") return v1::Z;
  return v1::AXIS_UNSPECIFIED;
}

}  // namespace

// Whether a text can only be the name of a choice's value: it begins as no number does.
bool IsNameOfValue(absl::string_view text) {
  return !text.empty() && !DecimalNumberPrefix(std::string_view(text.data(), text.size()));
}

absl::StatusOr<double> ParseQuantity(const std::string& text, const std::string& field) {
  return ParseWithUnit(text, field, Together(kLengths, kAngles));
}

absl::StatusOr<double> ParseLength(const std::string& text, const std::string& field) {
  return ParseKind(text, field, "a length", kLengths, kAngles);
}

absl::StatusOr<double> ParseAngle(const std::string& text, const std::string& field) {
  return ParseKind(text, field, "an angle", kAngles, kLengths);
}

absl::StatusOr<double> ParseMetricValue(const std::string& text, const std::string& field) {
  return ParseWithUnit(text, field, UnitsOfMetrics());
}

absl::Status CheckUnit(const std::string& text, const std::string& unit, const std::string& field) {
  for (const Unit& said : UnitsSaid(text)) {
    if (said.si == unit) continue;
    return InvalidField(field, absl::StrCat("'", said.name, "' is no unit of it: it is in ",
                                            unit.empty() ? "1" : unit));
  }
  return absl::OkStatus();
}

bool HasUnit(const std::string& text) { return !UnitsSaid(text).empty(); }

absl::StatusOr<NamedRange> ParseRange(const std::string& text, const std::string& option,
                                      ValueParser& parse) {
  const std::vector<std::string> halves = absl::StrSplit(text, '=');
  const std::vector<std::string> ends =
      halves.size() == 2 ? absl::StrSplit(halves[1], ':') : std::vector<std::string>();
  if (ends.size() != 2 || halves[0].empty() || (ends[0].empty() && ends[1].empty())) {
    return InvalidField(
        option,
        absl::StrCat("'", text, "' is not of the form NAME=LOW:HIGH, NAME=LOW: or NAME=:HIGH"));
  }
  NamedRange range{halves[0], std::nullopt, std::nullopt};
  const std::string field = absl::StrCat(option, " ", range.name);
  if (!ends[0].empty()) {
    MORTISE_ASSIGN_OR_RETURN(range.low, parse(ends[0], field));
  }
  if (!ends[1].empty()) {
    MORTISE_ASSIGN_OR_RETURN(range.high, parse(ends[1], field));
  }
  return range;
}

absl::StatusOr<v1::Vector3> ParseVector(const std::string& text, const std::string& field) {
  const std::vector<std::string> pieces = absl::StrSplit(text, ',');
  std::vector<double> numbers(pieces.size());
  bool is_vector = pieces.size() == 3;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const absl::string_view piece = absl::StripAsciiWhitespace(pieces[i]);
    const auto number = DecimalNumber(std::string_view(piece.data(), piece.size()));
    is_vector = is_vector && number.has_value();
    numbers[i] = number.value_or(0);
  }
  if (!is_vector) {
    return InvalidField(field, absl::StrCat("'", text, "' is not of the form X, Y, Z"));
  }
  v1::Vector3 vector;
  vector.set_x(numbers[0]);
  vector.set_y(numbers[1]);
  vector.set_z(numbers[2]);
  return vector;
}

absl::StatusOr<std::vector<v1::ParameterValue>> ParseParameters(
    const std::vector<std::string>& assignments) {
  std::vector<v1::ParameterValue> values;
  for (const std::string& assignment : assignments) {
    const std::size_t split = assignment.find('=');
    if (split == std::string::npos || split == 0) {
      return InvalidField("--set",
                          absl::StrCat("'", assignment, "' is not of the form NAME=VALUE"));
    }
    v1::ParameterValue& value = values.emplace_back();
    value.set_name(assignment.substr(0, split));
    const absl::string_view text =
        absl::StripAsciiWhitespace(absl::string_view(assignment).substr(split + 1));
    if (IsNameOfValue(text)) {
      value.set_choice(std::string(text));
      continue;
    }
    MORTISE_ASSIGN_OR_RETURN(const double number,
                             ParseQuantity(std::string(text), "--set " + value.name()));
    value.set_value(number);
  }
  return values;
}

absl::StatusOr<v1::MeasureDemand> ParseDemand(const std::string& text) {
  const std::size_t split = text.rfind('=');
  const std::string source = absl::StrCat("--set ", text);
  std::string name = text.substr(0, split);
  v1::MeasureDemand demand;
  v1::Measure& measure = *demand.mutable_measure();
  measure.set_kind(KindOf(LastWord(name)));
  if (measure.kind() != v1::Measure::KIND_UNSPECIFIED) CutLastWord(name);
  measure.set_axis(AxisOf(LastWord(name)));
  if (split == std::string::npos || measure.axis() == v1::AXIS_UNSPECIFIED) {
    return InvalidField(source,
                        "is not of the form ELEMENT.x=VALUE, with y or z, or such as "
                        "ELEMENT.z.maximum=VALUE");
  }
  CutLastWord(name);
  measure.set_element(name);
  MORTISE_ASSIGN_OR_RETURN(const double value, ParseLength(text.substr(split + 1), source));
  demand.set_value(value);
  return demand;
}

absl::StatusOr<v1::Axis> ParseAxis(const std::string& text, const std::string& field) {
  if (text.empty()) return v1::AXIS_UNSPECIFIED;
  if (text == "x") return v1::X;
  if (text == "y") return v1::Y;
  if (text == "z") return v1::Z;
  return InvalidField(field, absl::StrCat("'", text, "' is none of x, y, z"));
}

std::string ResourceName(const std::string& collection, const std::string& name) {
  return absl::StrContains(name, '/') ? name : absl::StrCat(collection, "/", name);
}

std::string Millimetres(double metres) { return absl::StrFormat("%.6g mm", metres / kMillimetre); }

v1::Metric MetricOf(const std::string& unit, double value) {
  v1::Metric metric;
  metric.set_unit(unit);
  metric.set_value(value);
  return metric;
}

std::string MetricText(const v1::Metric& metric) {
  if (metric.unit() == "m") return absl::StrFormat("%.4g mm", metric.value() / kMillimetre);
  const bool is_stress = metric.unit() == "Pa" && std::abs(metric.value()) >= kMinInMegapascal;
  if (is_stress) return absl::StrFormat("%.4g MPa", metric.value() / kMegapascal);
  return absl::StrFormat("%.5g %s", metric.value(), metric.unit());
}

absl::StatusOr<std::int64_t> Receive(grpc::ClientReader<v1::Chunk>& reader,
                                     const std::filesystem::path& path) {
  std::string bytes;
  std::string digest;
  v1::Chunk chunk;
  bool in_order = true;
  while (reader.Read(&chunk)) {
    if (!chunk.sha256().empty()) digest = chunk.sha256();
    in_order = in_order && chunk.offset() == static_cast<std::int64_t>(bytes.size());
    bytes += chunk.data();
  }
  MORTISE_RETURN_IF_ERROR(rpc::FromGrpc(reader.Finish()));
  if (!in_order || (!digest.empty() && digest != Sha256Hex(bytes))) {
    return absl::DataLossError(absl::StrCat(path.string(), ": what arrived is not what was sent"));
  }
  MORTISE_RETURN_IF_ERROR(WriteFile(path, bytes));
  return static_cast<std::int64_t>(bytes.size());
}

absl::Status FaultsToStatus(const std::string& design,
                            const google::protobuf::RepeatedPtrField<std::string>& faults) {
  if (faults.empty()) return absl::OkStatus();
  return PreconditionFailed(
      "DESIGN_FAULTY",
      absl::StrCat("the design has ", faults.size(),
                   faults.size() == 1 ? " fault: " : " faults; the first: ", faults[0]),
      design);
}

}  // namespace mortise::cli
