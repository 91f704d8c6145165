#include "common/files/message_checks.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/violation_lists.h"
#include "common/files/template_codec.h"

namespace mortise::parametric {
namespace {

constexpr double kSameSize = 1e-6;  // m
constexpr const char* kDimensions = "dimensions[";
constexpr std::string_view kStockSizes = "stock_sizes[";

// Whether `path` is `field` or lies in it: "price.amount" in "price".
bool LiesIn(std::string_view path, std::string_view field) {
  if (!path.starts_with(field)) return false;
  const std::string_view rest = path.substr(field.size());
  return rest.empty() || rest.front() == '.' || rest.front() == '[';
}

bool IsOneOf(const std::string& field, const UnreadFields& told) {
  return std::any_of(told.begin(), told.end(),
                     [&](const std::string& other) { return LiesIn(field, other); });
}

// How often the item's dimensions have an axis.
long CountOf(Axis axis, const v1::Item& item) {
  return std::count_if(item.dimensions().begin(), item.dimensions().end(),
                       [axis](const v1::ItemDimension& dimension) {
                         return dimension.axis() == static_cast<int>(axis) + v1::X;
                       });
}

// The path that findings of ValidateItem have: "dimensions[X].size" of "dimensions[0].size".
std::string ByAxis(const std::string& field, const v1::Item& item) {
  // There may be thousands of dimensions, each at fault.
  const std::size_t begin = std::string_view(kDimensions).size(), close = field.find(']');
  int index = 0;
  if (!field.starts_with(kDimensions) || close == std::string::npos ||
      !absl::SimpleAtoi(field.substr(begin, close - begin), &index) || index < 0 ||
      index >= item.dimensions_size()) {
    return field;
  }
  const v1::Axis axis = item.dimensions(index).axis();
  if (axis < v1::X || axis > v1::Z) return field;
  return absl::StrCat(kDimensions, v1::Axis_Name(axis), field.substr(close));
}

// Of the dimension of an axis that is missing or there twice, that is what is told.
bool IsOfAmbiguousAxis(const std::string& field, const v1::Item& item) {
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
    const std::string name = v1::Axis_Name(static_cast<v1::Axis>(static_cast<int>(axis) + v1::X));
    if (LiesIn(field, absl::StrCat(kDimensions, name, "]"))) return CountOf(axis, item) != 1;
  }
  return false;
}

// Whether the field is the width of a stock size that is wrong for one kind only. Of what kind the
// item is, nobody knows.
bool IsWidthForKind(const std::string& field, const v1::Item& item, const UnreadFields& told) {
  if (told.count("kind") == 0 || !field.starts_with(kStockSizes) || !field.ends_with(".width")) {
    return false;
  }
  const int index = std::stoi(field.substr(kStockSizes.size()));
  return item.stock_sizes(index).width() >= 0;
}

}  // namespace

std::vector<FieldViolation> ValidateMaterialMessage(const v1::Material& material,
                                                    const UnreadFields& unread) {
  const absl::StatusOr<Material> read = FromProto(material);
  std::vector<FieldViolation> findings;
  for (const FieldViolation& violation : AllViolationsOf(read.status())) {
    findings.push_back({violation.field, violation.message});
  }
  if (read.ok()) findings = ValidateMaterial(*read);
  std::erase_if(findings,
                [&](const FieldViolation& finding) { return IsOneOf(finding.field, unread); });
  return findings;
}

std::vector<FieldViolation> ValidateItemMessage(const v1::Item& item,
                                                const std::vector<Material>& materials,
                                                const UnreadFields& unread) {
  std::vector<FieldViolation> findings;
  Item read = ReadItem(item, findings);
  std::erase_if(findings,
                [&](const FieldViolation& finding) { return IsOneOf(finding.field, unread); });
  UnreadFields told;
  for (const std::string& field : unread) told.insert(ByAxis(field, item));
  for (const FieldViolation& finding : findings) told.insert(ByAxis(finding.field, item));
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
    if (CountOf(axis, item) != 1) {
      read.dimensions[static_cast<std::size_t>(axis)].size = kUnreadNumber;
    }
  }
  for (FieldViolation& finding : ValidateItem(read, materials)) {
    if (IsOneOf(finding.field, told) || IsOfAmbiguousAxis(finding.field, item) ||
        IsWidthForKind(finding.field, item, told)) {
      continue;
    }
    findings.push_back(std::move(finding));
  }
  return findings;
}

std::vector<FieldViolation> CheckShapeOfItem(const v1::Item& item, const v1::Shape& shape,
                                             const UnreadFields& unread) {
  std::vector<FieldViolation> findings;
  const auto is_unread = [&](const std::string& axis) {
    return std::any_of(unread.begin(), unread.end(), [&](const std::string& field) {
      return LiesIn(ByAxis(field, item), absl::StrCat(kDimensions, axis, "]"));
    });
  };
  const double sizes[] = {shape.size().x(), shape.size().y(), shape.size().z()};
  for (const v1::ItemDimension& dimension : item.dimensions()) {
    if (dimension.axis() < v1::X || dimension.axis() > v1::Z) continue;
    const double drawn = sizes[dimension.axis() - v1::X];
    if (dimension.process() != v1::PROCESS_UNSPECIFIED ||
        is_unread(v1::Axis_Name(dimension.axis())) ||
        std::abs(drawn - dimension.size()) <= kSameSize) {
      continue;
    }
    const std::vector<std::string> lengths = ComparedMillimetres({drawn, dimension.size()});
    findings.push_back(
        {"shape",
         absl::StrCat("measures ", lengths[0], " mm along ", v1::Axis_Name(dimension.axis()),
                      ", where the item's size is fixed to ", lengths[1], " mm")});
  }
  return findings;
}

FieldViolation MissingShape(const v1::Item& item) {
  return {"shape", absl::StrCat("there is no shape '", item.shape(), "'")};
}

}  // namespace mortise::parametric
