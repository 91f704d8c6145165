// Walks the folders of a collection.
#include "common/files/collection.h"

#include <algorithm>
#include <map>
#include <set>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/design/template_validation.h"
#include "common/files/collection_shapes.h"
#include "common/files/csv_table.h"
#include "common/files/design_file.h"
#include "common/files/template_codec.h"
#include "common/messages/proto_text.h"

namespace mortise::parametric {
namespace {

namespace fs = std::filesystem;

bool IsDesignFile(const fs::path& path) {
  const std::string extension = LowerCaseExtension(path);
  return extension == ".textproto" || extension == ".csv" || extension == ".json";
}

absl::StatusOr<std::vector<fs::path>> FilesUnder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::exists(folder, error)) return files;
  for (auto entry = fs::recursive_directory_iterator(folder, error);
       !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (entry->is_regular_file(error) && IsDesignFile(entry->path())) {
      files.push_back(entry->path());
    }
  }
  if (error) return StorageFailed(folder.string(), error.message());
  std::sort(files.begin(), files.end());
  return files;
}

absl::Status AppendBundle(const fs::path& file, CollectionShapes& shapes, Collection& collection) {
  DesignFile read = ReadDesignFile(file);
  for (Placed<v1::Item>& item : read.items) {
    const absl::Status resolved = shapes.Resolve(file, *item.message.mutable_shape());
    if (resolved.ok()) continue;
    read.findings.push_back({absl::StrCat(PlaceOf(item.place, item.fields, "shape"), ": ",
                                          item.message.name(), ".shape"),
                             std::string(resolved.message())});
  }
  for (FieldViolation& finding : read.findings) {
    finding.field = absl::StrCat(file.string(), finding.field.empty() ? "" : ": ", finding.field);
  }
  MORTISE_RETURN_IF_ERROR(ToStatus(read.findings));
  for (auto& material : read.materials) collection.materials.push_back(std::move(material.message));
  for (auto& item : read.items) collection.items.push_back(std::move(item.message));
  return absl::OkStatus();
}

// The shapes of an assembly's parts that have their own.
absl::Status ResolveShapes(const fs::path& file, CollectionShapes& shapes, v1::Assembly& assembly) {
  std::vector<FieldViolation> findings;
  for (int i = 0; i < assembly.parts_size(); ++i) {
    const absl::Status resolved = shapes.Resolve(file, *assembly.mutable_parts(i)->mutable_shape());
    if (resolved.ok()) continue;
    findings.push_back(
        {absl::StrCat(file.string(), ": parts[", i, "].shape"), std::string(resolved.message())});
  }
  return ToStatus(findings);
}

using ParseTemplate = absl::StatusOr<v1::Template> (*)(std::string_view, const std::string&);

// Templates of one kind, from the texts of a folder.
absl::Status AppendTemplates(const fs::path& folder, ParseTemplate parse, Collection& collection) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<fs::path> files, FilesUnder(folder));
  for (const fs::path& file : files) {
    if (LowerCaseExtension(file) != ".textproto") continue;
    MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxTextBytes));
    MORTISE_ASSIGN_OR_RETURN(v1::Template message, parse(text, file.string()));
    collection.templates.push_back(std::move(message));
  }
  return absl::OkStatus();
}

// A number and the digest of the content that it stands for.
struct Version {
  int64_t number = 0;
  std::string digest;
};

// The last row of versions.csv.
absl::StatusOr<Version> ReadVersion(const fs::path& file) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxTextBytes));
  const CsvTable table = ParseCsv(text);
  std::vector<FieldViolation> findings = table.findings;
  Version version;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const CsvRow& row = table.rows[i];
    if (row.size() != 2 || (i == 0 && (row[0].text != "number" || row[1].text != "digest"))) {
      findings.push_back({PlaceOf(row[0]), "must be a table of 'number' and 'digest'"});
      break;
    }
    if (i == 0) continue;
    int64_t number = 0;
    if (!absl::SimpleAtoi(row[0].text, &number) || number <= version.number) {
      findings.push_back({PlaceOf(row[0]), "must be a whole number above those before"});
      continue;
    }
    version = {number, row[1].text};
  }
  for (FieldViolation& finding : findings) {
    finding.field = absl::StrCat(file.string(), ": ", finding.field);
  }
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  return version;
}

// Gives templates the categories of a file. What the collection does not have, as a
// part of one, is passed over.
absl::Status LabelCategories(const fs::path& file, Collection& collection) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxTextBytes));
  CsvTable table = ParseCsv(text);
  std::vector<FieldViolation>& findings = table.findings;
  std::map<std::string, std::string> categories;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const CsvRow& row = table.rows[i];
    if (row.size() != 2 || (i == 0 && (row[0].text != "name" || row[1].text != "category"))) {
      findings.push_back({PlaceOf(row[0]), "must be a table of 'name' and 'category'"});
      break;
    }
    if (i > 0 && !categories.emplace(row[0].text, row[1].text).second) {
      findings.push_back({PlaceOf(row[0]), "has a category already"});
    }
  }
  for (FieldViolation& finding : findings) {
    finding.field = absl::StrCat(file.string(), ": ", finding.field);
  }
  MORTISE_RETURN_IF_ERROR(ToStatus(findings));
  for (v1::Template& message : collection.templates) {
    const auto category = categories.find(message.name());
    if (category != categories.end()) {
      (*message.mutable_labels())["category"] = category->second;
    }
  }
  return absl::OkStatus();
}

template <typename Messages>
void AddDigests(const Messages& messages, std::vector<std::string>& digests) {
  for (const auto& message : messages) {
    digests.push_back(absl::StrCat(message.name(), " ", Sha256Hex(message.SerializeAsString())));
  }
}

}  // namespace

absl::StatusOr<v1::Template> ParseTemplateText(std::string_view text, const std::string& origin) {
  v1::Template message;
  MORTISE_RETURN_IF_ERROR(ParseProtoText(text, origin, message));
  return message;
}

absl::StatusOr<v1::Template> ParseCadTemplateText(std::string_view text,
                                                  const std::string& origin) {
  v1::Template message;
  MORTISE_RETURN_IF_ERROR(ParseProtoText(text, origin, *message.mutable_cad()));
  message.set_name(message.cad().name());
  return message;
}

absl::StatusOr<v1::Template> ParseCageTemplateMessage(std::string_view text,
                                                      const std::string& origin) {
  v1::Template message;
  MORTISE_RETURN_IF_ERROR(ParseProtoText(text, origin, *message.mutable_cage()));
  message.set_name(message.cage().name());
  return message;
}

absl::StatusOr<v1::TemplateBundle> ParseBundleText(std::string_view text,
                                                   const std::string& origin) {
  v1::TemplateBundle message;
  MORTISE_RETURN_IF_ERROR(ParseProtoText(text, origin, message));
  return message;
}

absl::StatusOr<v1::Assembly> ParseAssemblyText(std::string_view text, const std::string& origin) {
  v1::Assembly message;
  MORTISE_RETURN_IF_ERROR(ParseProtoText(text, origin, message));
  return message;
}

absl::StatusOr<Collection> ReadCollection(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return ResourceNotFound(folder.string());
  Collection collection;
  CollectionShapes shapes;
  const fs::path materials = folder / "materials.textproto";
  if (fs::exists(materials, error)) {
    MORTISE_RETURN_IF_ERROR(AppendBundle(materials, shapes, collection));
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<fs::path> item_files, FilesUnder(folder / "items"));
  for (const fs::path& file : item_files) {
    MORTISE_RETURN_IF_ERROR(AppendBundle(file, shapes, collection));
  }
  MORTISE_RETURN_IF_ERROR(AppendTemplates(folder / "designs", ParseTemplateText, collection));
  MORTISE_RETURN_IF_ERROR(
      AppendTemplates(folder / "cad_templates", ParseCadTemplateText, collection));
  MORTISE_RETURN_IF_ERROR(
      AppendTemplates(folder / "cage_templates", ParseCageTemplateMessage, collection));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<fs::path> assemblies,
                           FilesUnder(folder / "assemblies"));
  for (const fs::path& file : assemblies) {
    if (LowerCaseExtension(file) != ".textproto") continue;
    MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(file, kMaxTextBytes));
    MORTISE_ASSIGN_OR_RETURN(v1::Assembly message, ParseAssemblyText(text, file.string()));
    MORTISE_RETURN_IF_ERROR(ResolveShapes(file, shapes, message));
    collection.assemblies.push_back(std::move(message));
  }
  collection.shapes = shapes.Take();
  const fs::path categories = folder / "categories.csv";
  if (fs::exists(categories, error)) {
    MORTISE_RETURN_IF_ERROR(LabelCategories(categories, collection));
  }
  const fs::path versions = folder / "versions.csv";
  if (fs::exists(versions, error)) {
    MORTISE_ASSIGN_OR_RETURN(const Version version, ReadVersion(versions));
    if (version.digest == ContentDigest(collection)) collection.number = version.number;
  }
  return collection;
}

std::string ContentDigest(const Collection& collection) {
  std::vector<std::string> digests;
  AddDigests(collection.materials, digests);
  AddDigests(collection.items, digests);
  AddDigests(collection.templates, digests);
  AddDigests(collection.assemblies, digests);
  std::sort(digests.begin(), digests.end());
  return Sha256Hex(absl::StrJoin(digests, "\n"));
}

absl::StatusOr<TemplateBundle> BundleOf(const Collection& collection, const std::string& name) {
  std::vector<Item> items;
  for (const v1::Item& message : collection.items) {
    MORTISE_ASSIGN_OR_RETURN(Item item, FromProto(message));
    items.push_back(std::move(item));
  }
  std::vector<Material> materials;
  for (const v1::Material& message : collection.materials) {
    MORTISE_ASSIGN_OR_RETURN(Material material, FromProto(message));
    materials.push_back(std::move(material));
  }
  for (const v1::Template& message : collection.templates) {
    if (message.name() != name) continue;
    MORTISE_ASSIGN_OR_RETURN(TemplateDefinition definition, FromProto(message));
    if (definition.digest.empty()) definition.digest = TemplateDigest(message);
    return MakeBundle(std::move(definition), items, materials);
  }
  return ResourceNotFound(name);
}

TemplateBundle MakeBundle(TemplateDefinition definition, const std::vector<Item>& items,
                          const std::vector<Material>& materials) {
  std::set<std::string> item_names, material_names;
  const auto add = [&item_names](const auto& owner) {
    item_names.insert(owner.item);
    for (const ConditionalItem& item : owner.items) item_names.insert(item.item);
  };
  std::for_each(definition.parts.begin(), definition.parts.end(), add);
  std::for_each(definition.connections.begin(), definition.connections.end(), add);
  TemplateBundle bundle;
  for (const std::string& name : item_names) {
    const Item* item = FindItem(items, name);
    if (item == nullptr) continue;
    bundle.items.push_back(*item);
    material_names.insert(item->material);
  }
  for (const std::string& name : material_names) {
    const Material* material = FindMaterial(materials, name);
    if (material != nullptr) bundle.materials.push_back(*material);
  }
  bundle.definition = std::move(definition);
  return bundle;
}

}  // namespace mortise::parametric
