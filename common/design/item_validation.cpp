// Checks of items.
#include <chrono>
#include <cmath>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/names/offered_names.h"
#include "common/design/field_checks.h"
#include "common/design/template_validation.h"
#include "common/expressions/identifier.h"

namespace mortise::parametric {
namespace {

constexpr double kMaxDimension = 100;  // m; nothing sold for joinery is larger
constexpr double kSameSize = 1e-9;     // m
constexpr std::size_t kMaxMeasures = 32;
constexpr std::size_t kMaxStockSizes = 64;
constexpr std::size_t kMaxMoreSuppliers = 16;
constexpr const char* kAxisFields[] = {"X", "Y", "Z"};
constexpr const char* kAxisNames[] = {"length", "width", "thickness"};

// YYYY-MM-DD, a day that the calendar has.
bool IsDate(const std::string& text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
  for (const int i : {0, 1, 2, 3, 5, 6, 8, 9}) {
    if (text[static_cast<std::size_t>(i)] < '0' || text[static_cast<std::size_t>(i)] > '9') {
      return false;
    }
  }
  return std::chrono::year_month_day(
             std::chrono::year(std::stoi(text.substr(0, 4))),
             std::chrono::month(static_cast<unsigned>(std::stoi(text.substr(5, 2)))),
             std::chrono::day(static_cast<unsigned>(std::stoi(text.substr(8, 2)))))
      .ok();
}

bool IsCurrency(const std::string& text) {
  if (text.size() != 3) return false;
  for (const char c : text) {
    if (c < 'A' || c > 'Z') return false;
  }
  return true;
}

// Whether both are known, and are not the same.
bool Differ(double a, double b) { return std::abs(a - b) > kSameSize; }

void CheckNotHuge(const std::string& field, double size, std::vector<FieldViolation>& findings) {
  if (size > kMaxDimension) {
    findings.push_back(
        {field, absl::StrCat("is more than ", kMaxDimension, " m; sizes are in metres")});
  }
}

void CheckDimension(const std::string& field, const ItemDimension& dimension,
                    std::vector<FieldViolation>& findings) {
  CheckPositive(absl::StrCat(field, ".size"), dimension.size, findings);
  CheckNotHuge(absl::StrCat(field, ".size"), dimension.size, findings);
  CheckNotNegative(absl::StrCat(field, ".nominal"), dimension.nominal, findings);
  CheckNotHuge(absl::StrCat(field, ".nominal"), dimension.nominal, findings);
  if (!dimension.name.empty() && !IsMeasureName(dimension.name)) {
    findings.push_back({absl::StrCat(field, ".name"),
                        "must be 1 to 63 lower-case letters, digits and underscores, beginning "
                        "with a letter"});
  }
  if (dimension.process == Process::kNone) {
    if (dimension.minimum == 0 && dimension.maximum == 0) return;
    findings.push_back({absl::StrCat(field, ".process"),
                        "is missing, though a range is given; a fixed dimension has none"});
  }
  CheckPositive(absl::StrCat(field, ".minimum"), dimension.minimum, findings);
  CheckPositive(absl::StrCat(field, ".maximum"), dimension.maximum, findings);
  if (dimension.maximum > 0 && dimension.maximum < dimension.minimum) {
    findings.push_back({absl::StrCat(field, ".maximum"), "is less than the minimum"});
  }
  if (dimension.size > 0 && dimension.maximum > dimension.size) {
    findings.push_back(
        {absl::StrCat(field, ".maximum"),
         absl::StrCat("is more than the size of the stock, ", dimension.size, " m")});
  }
}

std::string NameOf(const Item& item, std::size_t axis) {
  const std::string& name = item.dimensions[axis].name;
  return name.empty() ? kAxisNames[axis] : name;
}

// Dimensions of one name are one dimension; what is round has one diameter.
void CheckDimensions(const Item& item, std::vector<FieldViolation>& findings) {
  for (std::size_t i = 0; i < 3; ++i) {
    CheckDimension(absl::StrCat("dimensions[", kAxisFields[i], "]"), item.dimensions[i], findings);
  }
  for (std::size_t i = 1; i < 3; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (NameOf(item, i) != NameOf(item, j)) continue;
      if (!Differ(item.dimensions[i].size, item.dimensions[j].size)) continue;
      findings.push_back({absl::StrCat("dimensions[", kAxisFields[i], "].size"),
                          absl::StrCat("differs from that of ", kAxisFields[j],
                                       ", though both are '", NameOf(item, i), "'")});
    }
  }
  const bool round = item.kind == ItemKind::kDowel || item.kind == ItemKind::kThreadedRod;
  if (round && Differ(item.dimensions[1].size, item.dimensions[2].size)) {
    findings.push_back({"dimensions[Z].size", "it is round: Y and Z must be its diameter"});
  }
}

// What is wrong in itself is named before what is only missing.
void CheckMeasure(const std::string& field, const ItemMeasure& measure,
                  std::vector<FieldViolation>& findings) {
  CheckNotNegative(absl::StrCat(field, ".minimum"), measure.minimum, findings);
  CheckNotNegative(absl::StrCat(field, ".maximum"), measure.maximum, findings);
  CheckPositive(absl::StrCat(field, ".size"), measure.size, findings);
  CheckNotHuge(absl::StrCat(field, ".size"), measure.size, findings);
  if (measure.size > 0 && measure.minimum > measure.size) {
    findings.push_back({absl::StrCat(field, ".minimum"), "is more than the size"});
  }
  if (measure.maximum > 0 && measure.maximum < measure.size) {
    findings.push_back({absl::StrCat(field, ".maximum"), "is less than the size"});
  }
  if (!IsMeasureName(measure.name)) {
    findings.push_back({absl::StrCat(field, ".name"),
                        "must be 1 to 63 lower-case letters, digits and underscores, beginning "
                        "with a letter"});
  }
}

template <typename Entry, typename Check>
void CheckList(const std::string& field, const std::vector<Entry>& entries, std::size_t most,
               Check check, std::vector<FieldViolation>& findings) {
  if (entries.size() > most) {
    findings.push_back(
        {field, absl::StrCat("has ", entries.size(), " entries; at most ", most, " are accepted")});
    return;
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    check(absl::StrCat(field, "[", i, "]"), entries[i], findings);
  }
}

void CheckMeasures(const Item& item, std::vector<FieldViolation>& findings) {
  CheckList("measures", item.measures, kMaxMeasures, CheckMeasure, findings);
  if (item.measures.size() > kMaxMeasures) return;
  std::set<std::string> names;
  for (std::size_t i = 0; i < 3; ++i) names.insert(NameOf(item, i));
  for (std::size_t i = 0; i < item.measures.size(); ++i) {
    const std::string& name = item.measures[i].name;
    if (!IsMeasureName(name) || names.insert(name).second) continue;
    findings.push_back({absl::StrCat("measures[", i, "].name"),
                        absl::StrCat("'", name, "' is another dimension of the item already")});
  }
}

void CheckStockSize(const std::string& field, const StockSize& stock,
                    std::vector<FieldViolation>& findings) {
  CheckNotNegative(absl::StrCat(field, ".width"), stock.width, findings);
  CheckNotNegative(absl::StrCat(field, ".price"), stock.price.value_or(0), findings);
  CheckPositive(absl::StrCat(field, ".length"), stock.length, findings);
  CheckNotHuge(absl::StrCat(field, ".length"), stock.length, findings);
  CheckNotHuge(absl::StrCat(field, ".width"), stock.width, findings);
}

// Plans cut the stock that `dimensions` describe, so it must be one that is sold.
void CheckStockSizes(const Item& item, std::vector<FieldViolation>& findings) {
  const std::size_t before = findings.size();
  CheckList("stock_sizes", item.stock_sizes, kMaxStockSizes, CheckStockSize, findings);
  if (item.stock_sizes.empty() || item.stock_sizes.size() > kMaxStockSizes) return;
  const bool is_sound = findings.size() == before;
  const bool sheet = item.kind == ItemKind::kSheet;
  for (std::size_t i = 0; i < item.stock_sizes.size(); ++i) {
    const double width = item.stock_sizes[i].width;
    if (sheet ? width != 0 : !(width > 0)) continue;
    findings.push_back({absl::StrCat("stock_sizes[", i, "].width"),
                        sheet ? "is missing: a sheet has a width"
                              : "must be 0: only sheets are sold by length and width"});
  }
  if (!is_sound) return;
  for (const StockSize& stock : item.stock_sizes) {
    if (!Differ(stock.length, item.dimensions[0].size) &&
        (!sheet || !Differ(stock.width, item.dimensions[1].size))) {
      return;
    }
  }
  findings.push_back({"stock_sizes", "do not contain the size of `dimensions`"});
}

void CheckSupplierLink(const std::string& field, const SupplierLink& link,
                       std::vector<FieldViolation>& findings) {
  CheckText(absl::StrCat(field, ".supplier"), link.supplier, findings);
  CheckLink(absl::StrCat(field, ".url"), link.url, findings);
  CheckText(absl::StrCat(field, ".number"), link.number, findings);
  if (link.supplier.empty()) {
    findings.push_back({absl::StrCat(field, ".supplier"), "is missing: say who sells it"});
  }
}

void CheckSuppliers(const Item& item, std::vector<FieldViolation>& findings) {
  CheckText("supplier", item.supplier, findings);
  CheckLink("supplier_url", item.supplier_url, findings);
  CheckText("supplier_number", item.supplier_number, findings);
  CheckList("more_suppliers", item.more_suppliers, kMaxMoreSuppliers, CheckSupplierLink, findings);
}

void CheckPrice(const Item& item, std::vector<FieldViolation>& findings) {
  CheckNotNegative("price.amount", item.price.amount, findings);
  if (!IsCurrency(item.price.currency)) {
    findings.push_back({"price.currency", "must be a three-letter ISO 4217 code, such as EUR"});
  }
  if (!IsDate(item.price_date)) {
    findings.push_back({"price_date", "must be a date, YYYY-MM-DD"});
  }
}

}  // namespace

std::vector<FieldViolation> ValidateItem(const Item& item, const std::vector<Material>& materials) {
  std::vector<FieldViolation> findings;
  CheckResourceName(item.name, "items", findings);
  CheckTitle("title", item.title, findings);
  CheckText("standard", item.standard, findings);
  CheckText("designation", item.designation, findings);
  CheckSuppliers(item, findings);
  if (FindMaterial(materials, item.material) == nullptr) {
    findings.push_back(
        {"material", absl::StrCat("there is no material '", item.material, "'",
                                  NamesOffered(item.material, materials, &Material::name))});
  }
  CheckDimensions(item, findings);
  CheckMeasures(item, findings);
  CheckStockSizes(item, findings);
  const Axis grain = item.grain_axis.value_or(Axis::kX);
  if (grain == item.radial_axis.value_or(Axis::kZ)) {
    findings.push_back({item.radial_axis ? "radial_axis" : "grain_axis",
                        "L and R cannot lie along the same axis; unspecified, they lie along X and "
                        "Z"});
  }
  CheckPrice(item, findings);
  return findings;
}

}  // namespace mortise::parametric
