#include "services/catalog/service/template_placing.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/violation_lists.h"
#include "common/resources/resource_tags.h"
#include "services/catalog/records/bundle_records.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/service/template_reading.h"

namespace mortise::catalog {
namespace {

using HeightFields = google::protobuf::RepeatedPtrField<v1::HeightField>;

constexpr int kMaxHeightFields = 10;
constexpr std::size_t kMaxTitleBytes = 200;

std::string At(int index) { return absl::StrCat("height_fields[", index, "]"); }

// Which of the fields has the name; -1 if none.
int IndexOf(const HeightFields& fields, const std::string& name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const v1::HeightField& field) {
    return field.name() == name;
  });
  return found == fields.end() ? -1 : static_cast<int>(found - fields.begin());
}

// What the template asks for by no such name, and names that are there twice.
absl::Status CheckNames(const HeightFields& known, const HeightFields& given) {
  if (known.empty()) return InvalidField("name", "is no template that stands on ground");
  if (given.empty() || given.size() > kMaxHeightFields) {
    return InvalidField("height_fields", absl::StrCat("must be 1 to ", kMaxHeightFields));
  }
  std::vector<FieldViolation> violations;
  std::set<std::string> seen;
  for (int i = 0; i < given.size(); ++i) {
    const std::string name = given[i].name().substr(0, 80);
    if (IndexOf(known, given[i].name()) < 0) {
      const std::string names =
          absl::StrJoin(known, "', '", [](std::string* text, const v1::HeightField& field) {
            absl::StrAppend(text, field.name());
          });
      violations.push_back({At(i) + ".name", absl::StrCat("the template has no ground '", name,
                                                          "'; it has '", names, "'")});
    } else if (!seen.insert(given[i].name()).second) {
      violations.push_back({At(i) + ".name", absl::StrCat("'", name, "' is there twice")});
    }
  }
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

// Says what is wrong with the template on its ground in terms of the request, which gave no more
// than the ground.
absl::Status InRequest(const absl::Status& faults, const HeightFields& of_template,
                       const HeightFields& given) {
  std::vector<FieldViolation> violations = AllViolationsOf(faults);
  if (violations.empty()) return faults;
  // The title is made of that of the ground, of which the same is told.
  std::erase_if(violations, [](const FieldViolation& fault) { return fault.field == "title"; });
  const std::string ground = given.size() == 1 ? At(0) : "height_fields";
  for (FieldViolation& violation : violations) {
    bool is_told = violation.field == "height_fields";
    for (int i = 0; i < of_template.size() && !is_told; ++i) {
      if (!violation.field.starts_with(At(i))) continue;
      const int index = IndexOf(given, of_template[i].name());
      violation.field = absl::StrCat(index < 0 ? "height_fields" : At(index),
                                     violation.field.substr(At(i).size()));
      is_told = true;
    }
    if (is_told) continue;
    violation.message = absl::StrCat("of ", violation.field, ": ", violation.message);
    violation.field = ground;
  }
  return InvalidFields(violations);
}

// What people call the ground.
std::string TitleOf(const HeightFields& given) {
  return absl::StrJoin(given, " and ", [](std::string* text, const v1::HeightField& field) {
    absl::StrAppend(text, field.title().empty() ? field.name() : field.title());
  });
}

// At most as many bytes, of whole characters.
std::string Shortened(std::string text) {
  if (text.size() <= kMaxTitleBytes) return text;
  std::size_t end = kMaxTitleBytes;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
  return text;
}

// Writes on a template what it was placed of; `origin` has that template's name and title.
void NameOrigin(const v1::Template& origin, const HeightFields& given, v1::Template& placed) {
  placed.set_placed_template(origin.name());
  placed.set_placed_template_revision(origin.revision());
  placed.set_title(Shortened(absl::StrCat(origin.title(), " on ", TitleOf(given))));
}

// The template itself, or what it was placed of.
absl::StatusOr<v1::Template> OriginOf(const Catalog& catalog, const v1::Template& message) {
  if (message.placed_template().empty()) return message;
  MORTISE_ASSIGN_OR_RETURN(
      v1::TemplateBundle bundle,
      FindBundle(catalog, message.placed_template(), message.placed_template_revision()));
  return std::move(*bundle.mutable_template_());
}

}  // namespace

absl::StatusOr<v1::TemplateBundle> PlaceOn(const Catalog& catalog,
                                           const v1::PlaceTemplateRequest& asked,
                                           const std::function<bool()>& is_given_up) {
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                           FindBundle(catalog, asked.name(), asked.revision()));
  v1::Template& placed = *bundle.mutable_template_();
  MORTISE_RETURN_IF_ERROR(CheckNames(placed.height_fields(), asked.height_fields()));
  MORTISE_ASSIGN_OR_RETURN(const v1::Template origin, OriginOf(catalog, placed));
  HeightFields& fields = *placed.mutable_height_fields();
  for (const v1::HeightField& given : asked.height_fields()) {
    *fields.Mutable(IndexOf(fields, given.name())) = given;
  }
  ClearWhatTheServiceSays(&placed);
  resources::ClearTags(&placed);
  NameOrigin(origin, asked.height_fields(), placed);
  const absl::Status checked =
      templates::FillAndCheck(bundle, templates::Trial::kThorough, is_given_up);
  MORTISE_RETURN_IF_ERROR(InRequest(checked, fields, asked.height_fields()));
  placed.set_name(PlacedName(origin.name(), fields));
  return bundle;
}

}  // namespace mortise::catalog
