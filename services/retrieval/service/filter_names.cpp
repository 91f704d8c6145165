#include "services/retrieval/service/filter_names.h"

#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/base/violation_lists.h"

namespace mortise::retrieval {
namespace {

constexpr int kMaxLackingShown = 5;
constexpr int kMaxOffered = 20;  // names for which others are looked for that are like them

// What the index knows by name.
struct KnownNames {
  std::set<std::string> templates, categories, materials, items;
};

KnownNames NamesOf(const v1::ShapeIndex& index) {
  KnownNames known;
  for (const v1::ShapeIndex::Family& family : index.families()) {
    known.templates.insert(family.template_());
    known.materials.insert(family.materials().begin(), family.materials().end());
    known.items.insert(family.items().begin(), family.items().end());
    const auto category = family.labels().find(kCategoryLabel);
    if (category != family.labels().end()) known.categories.insert(category->second);
  }
  return known;
}

// A name with the field that has it.
struct Named {
  std::string field;
  std::string name;
};

using List = std::function<absl::StatusOr<std::set<std::string>>()>;

// Whether all are in `known`, or else in what `list` tells. `kind`: "material".
absl::Status CheckNames(const std::vector<Named>& named, std::set<std::string> known,
                        const std::string& kind, const List& list) {
  std::vector<Named> unknown;
  for (const Named& each : named) {
    if (!known.contains(each.name)) unknown.push_back(each);
  }
  if (unknown.empty()) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(std::set<std::string> there, list());
  known.merge(there);
  std::vector<std::string> ids;
  for (const std::string& name : known) ids.push_back(name.substr(name.find('/') + 1));
  absl::Status status;
  int told = 0;
  for (const Named& each : unknown) {
    if (known.contains(each.name)) continue;
    const std::string id = each.name.substr(each.name.find('/') + 1);
    const std::string offered = ++told > kMaxOffered ? "" : NamesOffered(id, ids);
    status = CombineViolations(
        status,
        InvalidField(each.field, absl::StrCat("there is no ", kind, " '", id, "'", offered)));
  }
  return status;
}

template <typename Names>
std::vector<Named> NamedBy(const Names& names, const std::string& field) {
  std::vector<Named> named;
  for (const std::string& name : names) {
    named.push_back({absl::StrCat(field, "[", named.size(), "]"), name});
  }
  return named;
}

std::set<std::string> SetOf(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

// "3 are of the categories" for each part of the filter that the index tells about.
std::vector<std::string> CountFamilies(const SearchFilter& filter, const v1::ShapeIndex& index) {
  std::vector<std::string> counts;
  const auto count = [&](const SearchFilter& part, const char* what) {
    int met = 0;
    for (const v1::ShapeIndex::Family& family : index.families()) {
      if (family.fault().empty() && MayBeFound(part, family)) ++met;
    }
    counts.push_back(absl::StrCat(met, " ", what));
  };
  if (filter.templates) count({.templates = filter.templates}, "of the templates named");
  if (filter.resources) {
    count({.resources = filter.resources}, "with the external ids, labels, creator and time");
  }
  if (!filter.categories.empty()) count({.categories = filter.categories}, "of the categories");
  const auto count_design = [&](DesignFilter part, const char* what) {
    count({.design = std::move(part)}, what);
  };
  if (filter.design.materials) {
    count_design({.materials = filter.design.materials}, "with any of the materials");
  }
  if (filter.design.items) {
    count_design({.items = filter.design.items}, "with any of the items");
  }
  return counts;
}

std::vector<std::string> CountDesigns(const DesignFilter& filter, const FilterTally& tally) {
  std::vector<std::string> counts;
  if (!IsEmpty({.min_size = filter.min_size, .max_size = filter.max_size})) {
    counts.push_back(absl::StrCat(tally.of_size, " of the size"));
  }
  if (filter.materials) {
    counts.push_back(absl::StrCat(tally.of_materials, " of the materials alone"));
  }
  if (filter.max_price) counts.push_back(absl::StrCat(tally.of_price, " of the price"));
  if (filter.items) {
    counts.push_back(absl::StrCat(tally.of_items, " to be built from the items"));
  }
  return counts;
}

// "The nearest that lacks nothing but items, templates/table, takes 8 of items/dowel-8x35 (there
// are 0)."
std::string LackingText(const FilterTally& tally) {
  std::vector<std::string> texts;
  for (const LackingItem& each : tally.lacking) {
    if (static_cast<int>(texts.size()) == kMaxLackingShown) {
      texts.emplace_back("more");
      break;
    }
    texts.push_back(
        absl::StrFormat("%.4g of %s (there are %.4g)", each.taken, each.item, each.there));
  }
  return absl::StrCat(" The nearest that lacks nothing but items, ", tally.lacking_template,
                      ", takes ", absl::StrJoin(texts, ", "), ".");
}

}  // namespace

absl::Status CheckFilterNames(const v1::SearchShapesRequest& request, const v1::ShapeIndex& index,
                              const TemplateSource& templates, const rpc::Origin& origin) {
  const KnownNames known = NamesOf(index);
  std::vector<Named> items;
  for (const v1::AvailableItem& each : request.design_filter().items()) {
    items.push_back({absl::StrCat("design_filter.items[", items.size(), "].item"), each.item()});
  }
  const auto of_templates = [&](bool names) -> absl::StatusOr<std::set<std::string>> {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::Template> listed, templates.List({}, origin));
    std::set<std::string> found;
    for (const v1::Template& each : listed) {
      if (names) found.insert(each.name());
      const auto category = each.labels().find(kCategoryLabel);
      if (!names && category != each.labels().end()) found.insert(category->second);
    }
    return found;
  };
  absl::Status status = CheckNames(NamedBy(request.templates(), "templates"), known.templates,
                                   "template", [&] { return of_templates(true); });
  status = CombineViolations(
      status, CheckNames(NamedBy(request.categories(), "categories"), known.categories, "category",
                         [&] { return of_templates(false); }));
  status = CombineViolations(
      status,
      CheckNames(NamedBy(request.design_filter().materials(), "design_filter.materials"),
                 known.materials, "material", [&]() -> absl::StatusOr<std::set<std::string>> {
                   MORTISE_ASSIGN_OR_RETURN(const auto names, templates.MaterialNames(origin));
                   return SetOf(names);
                 }));
  return CombineViolations(
      status,
      CheckNames(items, known.items, "item", [&]() -> absl::StatusOr<std::set<std::string>> {
        MORTISE_ASSIGN_OR_RETURN(const auto names, templates.ItemNames(origin));
        return SetOf(names);
      }));
}

std::string WhyNothingIsFound(const SearchFilter& filter, const v1::ShapeIndex& index,
                              const FilterTally& tally, int looked_at) {
  const std::vector<std::string> families = CountFamilies(filter, index);
  std::string text = absl::StrCat("Nothing is left of the ", index.family_count(),
                                  " templates and sub-trees of the index",
                                  families.empty() ? "." : ", of which there are ",
                                  absl::StrJoin(families, ", "), families.empty() ? "" : ".");
  if (looked_at > 0) {
    absl::StrAppend(&text, " Of ", looked_at, " designs that were looked at there are ",
                    absl::StrJoin(CountDesigns(filter.design, tally), ", "), ".");
  }
  if (!tally.lacking.empty()) text += LackingText(tally);
  return text;
}

}  // namespace mortise::retrieval
