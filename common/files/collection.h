// Reads collections from disk: materials, items, templates and assemblies as files people write
// (collection/ in the repository). Target mortise_template_codec.
//
//   materials.textproto, items/*.textproto     each a mortise.v1.TemplateBundle
//   items/*.csv, items/*.json                  items in the forms of design_file.h
//   designs/<name>/template.textproto          each a mortise.v1.Template
//   assemblies/*.textproto                     each a mortise.v1.Assembly (assembly_codec.h)
//   cad_templates/*.textproto                  each a mortise.v1.CadTemplate
//   cage_templates/*.textproto                 each a mortise.v1.CageTemplate
//   shapes/*.shape                             each a mortise.v1.Shape, read from the drawing
//                                              shapes/*.step, which items and parts name
//   categories.csv                             the category of templates by name, as their label
//                                              "category"; assemblies have theirs in their files
//   versions.csv                               a number and a digest for each version that shipped
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_definition.h"
#include "mortise/v1/assembly.pb.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::parametric {

// Everything in a collection, in the order of file names, not yet validated.
struct Collection {
  // Goes up whenever what ships changes, so that it is known which of two collections is newer: the
  // last one in versions.csv. 0, which says nothing, without that file, and where the digest beside
  // the number is not that of the content, as in a copy that somebody has changed.
  int64_t number = 0;
  std::vector<v1::Material> materials;
  std::vector<v1::Item> items;
  std::vector<v1::Template> templates;  // of designs/, cad_templates/ and cage_templates/, in turn
  std::vector<v1::Assembly> assemblies;
  // Those that items and parts of assemblies name, each once. In the files they are named by the
  // path of a drawing beside; here, as everywhere, by their content.
  std::vector<v1::Shape> shapes;
};

// Parses one file's text. INVALID_ARGUMENT naming `origin` with every line and column at fault;
// RESOURCE_EXHAUSTED past 4 MiB.
absl::StatusOr<v1::Template> ParseTemplateText(std::string_view text, const std::string& origin);
// Returns the text of a CadTemplate or CageTemplate, as a template of that kind.
absl::StatusOr<v1::Template> ParseCadTemplateText(std::string_view text, const std::string& origin);
absl::StatusOr<v1::Template> ParseCageTemplateMessage(std::string_view text,
                                                      const std::string& origin);
absl::StatusOr<v1::TemplateBundle> ParseBundleText(std::string_view text,
                                                   const std::string& origin);
absl::StatusOr<v1::Assembly> ParseAssemblyText(std::string_view text, const std::string& origin);

// Reads a folder. NOT_FOUND if it does not exist; INVALID_ARGUMENT naming each fault of the first
// file that has any: shapes that are missing or damaged with the item and the path, in versions.csv
// numbers that do not go up.
absl::StatusOr<Collection> ReadCollection(const std::filesystem::path& folder);

// Returns the digest of all that a collection brings, 64 hexadecimal digits: whatever its files are
// called and however they are written.
std::string ContentDigest(const Collection& collection);

// Returns the template of `collection` with this name and what it uses, as structs. NOT_FOUND;
// INVALID_ARGUMENT naming the field where a message cannot be converted.
absl::StatusOr<TemplateBundle> BundleOf(const Collection& collection, const std::string& name);

// Returns the definition with those of `items` and `materials` that it names, each once, in order
// of name. What is missing is left out; ValidateTemplate reports it.
TemplateBundle MakeBundle(TemplateDefinition definition, const std::vector<Item>& items,
                          const std::vector<Material>& materials);

}  // namespace mortise::parametric
