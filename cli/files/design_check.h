// Designs that were read from files, checked against each other and what the catalog has.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/design/template_validation.h"
#include "common/files/design_file.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::cli {

// A message of a file, and where it comes from.
template <typename Message>
struct ReadDesign {
  std::string file;
  parametric::Placed<Message> placed;

  const Message& message() const { return placed.message; }

  // "bolts.csv: line 3, column 5 (price): items/bolt-m8x40", as far as it is known.
  std::string Place(const std::string& field = "") const {
    const std::string place = parametric::PlaceOf(placed.place, placed.fields, field);
    return absl::StrCat(file, ": ", place, place.empty() ? "" : ": ", placed.message.name());
  }
};

struct Designs {
  std::vector<ReadDesign<v1::Material>> materials;
  std::vector<ReadDesign<v1::Item>> items;
  std::vector<ReadDesign<v1::Template>> templates;
  // Of what the files have besides, but that cannot be read.
  std::set<std::string> unread_names;
};

// What the catalog has, by name.
struct Present {
  std::map<std::string, v1::Material> materials;
  std::map<std::string, v1::Item> items;
};

// What is wrong with a message, under its name and with its place.
template <typename Message>
void AddFindings(const ReadDesign<Message>& read, const std::vector<FieldViolation>& more,
                 std::vector<FieldViolation>& findings) {
  for (const FieldViolation& finding : more) {
    findings.push_back(
        {absl::StrCat(read.Place(finding.field), ".", finding.field), finding.message});
  }
}

// Returns everything that makes no sense, but of shapes, and of what needs the CAD kernel or the
// catalog's assemblies. Templates are not judged by what is at fault itself.
std::vector<FieldViolation> CheckDesigns(const Designs& designs, const Present& present);

}  // namespace mortise::cli
