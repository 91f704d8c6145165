// Checks of materials and items.
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/identifiers.h"
#include "common/parametric/template_validation.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxText = 1000;     // bytes
constexpr double kLargestDimension = 100;  // m; nothing sold for joinery is larger
constexpr const char* kAxisFields[] = {"X", "Y", "Z"};

void CheckResourceName(const std::string& name, const std::string& collection,
                       std::vector<Finding>& findings) {
  if (!ParseResourceName(name, collection, "name").ok()) {
    findings.push_back({"name", absl::StrCat("must be '", collection,
                                             "/' and 1 to 63 lower-case letters, digits and "
                                             "hyphens")});
  }
}

void CheckText(const std::string& field, const std::string& text, std::vector<Finding>& findings) {
  if (text.size() > kMaxText) {
    findings.push_back({field, absl::StrCat("is longer than ", kMaxText, " bytes")});
  }
}

// People click on links: only what leads to a page is one.
void CheckLink(const std::string& field, const std::string& link, std::vector<Finding>& findings) {
  if (link.empty() || link.starts_with("https://") || link.starts_with("http://")) return;
  findings.push_back({field, "must begin with https:// or http://"});
}

void CheckPositive(const std::string& field, double value, std::vector<Finding>& findings) {
  if (!(value > 0) || !std::isfinite(value)) {
    findings.push_back({field, "must be a finite number greater than 0"});
  }
}

void CheckNotNegative(const std::string& field, double value, std::vector<Finding>& findings) {
  if (!(value >= 0) || !std::isfinite(value)) {
    findings.push_back({field, "must be a finite number, at least 0"});
  }
}

// YYYY-MM-DD with a month and day that exist in some year.
bool IsDate(const std::string& text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
  for (const int i : {0, 1, 2, 3, 5, 6, 8, 9}) {
    if (text[static_cast<std::size_t>(i)] < '0' || text[static_cast<std::size_t>(i)] > '9') {
      return false;
    }
  }
  const int month = (text[5] - '0') * 10 + text[6] - '0';
  const int day = (text[8] - '0') * 10 + text[9] - '0';
  return month >= 1 && month <= 12 && day >= 1 && day <= 31;
}

bool IsCurrency(const std::string& text) {
  if (text.size() != 3) return false;
  for (const char c : text) {
    if (c < 'A' || c > 'Z') return false;
  }
  return true;
}

void CheckDimension(const std::string& field, const ItemDimension& dimension,
                    std::vector<Finding>& findings) {
  const std::size_t before = findings.size();
  CheckPositive(absl::StrCat(field, ".size"), dimension.size, findings);
  if (dimension.size > kLargestDimension) {
    findings.push_back(
        {absl::StrCat(field, ".size"),
         absl::StrCat("is more than ", kLargestDimension, " m; sizes are in metres")});
  }
  if (dimension.process == Process::kNone) {
    if (dimension.minimum != 0 || dimension.maximum != 0) {
      findings.push_back({absl::StrCat(field, ".process"),
                          "is missing, though a range is given; a fixed dimension has none"});
    }
    return;
  }
  CheckPositive(absl::StrCat(field, ".minimum"), dimension.minimum, findings);
  CheckPositive(absl::StrCat(field, ".maximum"), dimension.maximum, findings);
  if (findings.size() > before) return;
  if (dimension.maximum < dimension.minimum) {
    findings.push_back({absl::StrCat(field, ".maximum"), "is less than the minimum"});
  }
  if (dimension.maximum > dimension.size) {
    findings.push_back(
        {absl::StrCat(field, ".maximum"),
         absl::StrCat("is more than the size of the stock, ", dimension.size, " m")});
  }
}

}  // namespace

std::vector<Finding> ValidateMaterial(const Material& material) {
  std::vector<Finding> findings;
  CheckResourceName(material.name, "materials", findings);
  CheckText("title", material.title, findings);
  CheckPositive("density", material.density, findings);
  CheckPositive("youngs_modulus", material.youngs_modulus, findings);
  CheckPositive("strength", material.strength, findings);
  CheckNotNegative("thermal_conductivity", material.thermal_conductivity, findings);
  CheckNotNegative("thermal_expansion", material.thermal_expansion, findings);
  if (!(material.poissons_ratio > -1 && material.poissons_ratio < 0.5)) {
    findings.push_back({"poissons_ratio", "must lie between -1 and 0.5, ends excluded"});
  }
  return findings;
}

std::vector<Finding> ValidateItem(const Item& item, const std::vector<Material>& materials) {
  std::vector<Finding> findings;
  CheckResourceName(item.name, "items", findings);
  CheckText("title", item.title, findings);
  CheckText("supplier", item.supplier, findings);
  CheckText("supplier_url", item.supplier_url, findings);
  CheckLink("supplier_url", item.supplier_url, findings);
  CheckText("supplier_number", item.supplier_number, findings);
  if (FindMaterial(materials, item.material) == nullptr) {
    findings.push_back({"material", absl::StrCat("there is no material '", item.material, "'")});
  }
  for (std::size_t i = 0; i < 3; ++i) {
    CheckDimension(absl::StrCat("dimensions[", kAxisFields[i], "]"), item.dimensions[i], findings);
  }
  if (item.kind == ItemKind::kDowel &&
      std::abs(item.dimensions[1].size - item.dimensions[2].size) > 1e-9) {
    findings.push_back({"dimensions[Z].size", "a dowel is round: Y and Z must be its diameter"});
  }
  CheckNotNegative("price.amount", item.price.amount, findings);
  if (!IsCurrency(item.price.currency)) {
    findings.push_back({"price.currency", "must be a three-letter ISO 4217 code, such as EUR"});
  }
  if (!IsDate(item.price_date)) {
    findings.push_back({"price_date", "must be a date, YYYY-MM-DD"});
  }
  return findings;
}

}  // namespace mortise::parametric
