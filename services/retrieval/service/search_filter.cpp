#include "services/retrieval/service/search_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "services/retrieval/catalog/template_names.h"

namespace mortise::retrieval {
namespace {

constexpr int kMaxCategories = 100;
constexpr int kMaxMaterials = 100;
constexpr int kMaxItems = 10'000;

// The sizes that are not 0.
absl::Status ReadSize(const v1::Vector3& size, const std::string& field, Eigen::Vector3d* bounds) {
  absl::Status status;
  const std::pair<const char*, double> axes[] = {{"x", size.x()}, {"y", size.y()}, {"z", size.z()}};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto& [name, value] = axes[axis];
    if (!std::isfinite(value) || value < 0) {
      status = CombineViolations(
          status, InvalidField(absl::StrCat(field, ".", name), "must be finite, 0 or more"));
    }
    if (value > 0) (*bounds)[axis] = value;
  }
  return status;
}

absl::Status ReadMaterials(const v1::DesignFilter& filter, DesignFilter* design) {
  if (filter.materials().empty()) return absl::OkStatus();
  if (filter.materials_size() > kMaxMaterials) {
    return InvalidField("materials", absl::StrCat("has more than ", kMaxMaterials));
  }
  design->materials.emplace(filter.materials().begin(), filter.materials().end());
  absl::Status status;
  for (int i = 0; i < filter.materials_size(); ++i) {
    status = CombineViolations(status, ParseResourceName(filter.materials(i), "materials",
                                                         absl::StrCat("materials[", i, "]"))
                                           .status());
  }
  return status;
}

// Whether a text may be a code of ISO 4217.
bool IsCurrency(const std::string& text) {
  return text.size() == 3 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

absl::Status ReadPrice(const v1::DesignFilter& filter, DesignFilter* design) {
  if (!filter.has_max_price()) return absl::OkStatus();
  const v1::Money& price = filter.max_price();
  absl::Status status;
  if (!std::isfinite(price.amount()) || price.amount() < 0) {
    status = InvalidField("max_price.amount", "must be finite, 0 or more");
  }
  if (!IsCurrency(price.currency())) {
    status = CombineViolations(
        status,
        InvalidField("max_price.currency", "must be three capital letters, such as \"EUR\""));
  }
  design->max_price = parametric::Cost{.amount = price.amount(), .currency = price.currency()};
  return status;
}

absl::Status ReadItems(const v1::DesignFilter& filter, DesignFilter* design) {
  if (filter.items().empty()) return absl::OkStatus();
  if (filter.items_size() > kMaxItems) {
    return InvalidField("items", absl::StrCat("has more than ", kMaxItems));
  }
  design->items.emplace();
  absl::Status status;
  for (int i = 0; i < filter.items_size(); ++i) {
    const v1::AvailableItem& each = filter.items(i);
    const std::string field = absl::StrCat("items[", i, "]");
    status = CombineViolations(
        status, ParseResourceName(each.item(), "items", absl::StrCat(field, ".item")).status());
    if (each.has_quantity() && (!std::isfinite(each.quantity()) || each.quantity() < 0)) {
      status = CombineViolations(
          status, InvalidField(absl::StrCat(field, ".quantity"), "must be finite, 0 or more"));
    }
    const double quantity =
        each.has_quantity() ? each.quantity() : std::numeric_limits<double>::infinity();
    if (!design->items->emplace(each.item(), quantity).second) {
      status =
          CombineViolations(status, InvalidField(absl::StrCat(field, ".item"), "is there twice"));
    }
  }
  return status;
}

absl::StatusOr<DesignFilter> ReadDesignFilter(const v1::DesignFilter& filter) {
  DesignFilter design;
  absl::Status status = ReadSize(filter.min_size(), "min_size", &design.min_size);
  status = CombineViolations(status, ReadSize(filter.max_size(), "max_size", &design.max_size));
  if (status.ok() && (design.min_size.array() > design.max_size.array()).any()) {
    status = InvalidField("max_size", "is below the least size");
  }
  status = CombineViolations(status, ReadMaterials(filter, &design));
  status = CombineViolations(status, ReadPrice(filter, &design));
  status = CombineViolations(status, ReadItems(filter, &design));
  if (!status.ok()) return UnderField("design_filter", status);
  return design;
}

}  // namespace

absl::StatusOr<SearchFilter> ReadSearchFilter(const v1::SearchShapesRequest& request) {
  SearchFilter filter;
  absl::Status status = CheckTemplateNames(request.templates());
  if (!request.templates().empty()) {
    filter.templates.emplace(request.templates().begin(), request.templates().end());
  }
  if (request.has_filter()) {
    const absl::StatusOr<resources::ResourceFilter> read = resources::ResourceFilter::Of(request);
    if (read.ok()) filter.resources.emplace(*read);
    status = CombineViolations(status, read.status());
  }
  if (request.categories_size() > kMaxCategories) {
    status = CombineViolations(
        status, InvalidField("categories", absl::StrCat("has more than ", kMaxCategories)));
  }
  filter.categories.insert(request.categories().begin(), request.categories().end());
  absl::StatusOr<DesignFilter> design = ReadDesignFilter(request.design_filter());
  MORTISE_RETURN_IF_ERROR(CombineViolations(status, design.status()));
  filter.design = *std::move(design);
  return filter;
}

bool MayBeFound(const SearchFilter& filter, const v1::ShapeIndex::Family& family) {
  if (filter.templates && !filter.templates->contains(family.template_())) return false;
  if (filter.resources && !filter.resources->Matches(family)) return false;
  if (!filter.categories.empty()) {
    const auto category = family.labels().find(kCategoryLabel);
    if (category == family.labels().end() || !filter.categories.contains(category->second)) {
      return false;
    }
  }
  return MayMeet(filter.design, {family.items().begin(), family.items().end()},
                 {family.materials().begin(), family.materials().end()});
}

}  // namespace mortise::retrieval
