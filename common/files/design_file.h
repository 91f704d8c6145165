// Reads the files people write designs in: materials, items and templates as protobuf text, as
// JSON, and items and materials as CSV (docs/catalogue.md has the columns). Every fault of a file
// is found in one pass and has its place. Target mortise_template_codec.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/design/template_validation.h"
#include "common/files/message_checks.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::parametric {

// A message of a file, and where it is there.
template <typename Message>
struct Placed {
  Message message;
  std::string place;                          // "line 12"; empty if not known
  std::map<std::string, std::string> fields;  // field path: "line 12, column 3 (length_mm)"
  // Paths of the fields of which the file says something that cannot be read, as message_checks.h
  // takes them. The findings of the file tell of each.
  UnreadFields unread;
};

struct DesignFile {
  std::vector<Placed<v1::Material>> materials;
  std::vector<Placed<v1::Item>> items;
  std::vector<Placed<v1::Template>> templates;
  // What cannot be read, with places as fields; what could be is above all the same.
  std::vector<FieldViolation> findings;
  std::size_t unlisted = 0;  // findings beyond those, of very many
  // Names, as far as they could be made out, of what is not above because of that.
  std::set<std::string> unread_names;
};

// Returns where `field` of a message is: its own place, that of what it is part of, or that of the
// message.
std::string PlaceOf(const std::string& place, const std::map<std::string, std::string>& fields,
                    const std::string& field);

// Takes "items[" and "]" off "items[3].price", which leaves the 3 and "price". Nothing where
// `field` is of no element of `list`.
std::optional<std::pair<std::size_t, std::string>> ElementOf(const std::string& field,
                                                             const std::string& list);

// Items as CSV, or materials if there is a column "density": the first row names the columns, each
// further row is one of them. Whether they make sense is not looked at, except that numbers are
// numbers and words are known. A finding is also what separates cells but for commas, and a header
// that no row follows.
DesignFile ParseDesignCsv(std::string_view text);

// Returns a TemplateBundle as JSON (proto3 JSON, either form of field names), or a list of items.
// Of a template of which something cannot be read, only the name counts.
DesignFile ParseDesignJson(std::string_view text);

// Returns the file at `path`, by its extension in any case: .csv, .json, or protobuf text. A file
// that cannot be read at all, or has more than 4 MiB, is a finding.
DesignFile ReadDesignFile(const std::filesystem::path& path);

}  // namespace mortise::parametric
