// mortise catalog list
#include "cli/client/catalog_list.h"

#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "cli/client/command_flags.h"
#include "cli/client/filter_options.h"
#include "cli/client/requests.h"
#include "common/base/errors.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {
namespace {

struct ListOptions {
  std::string what;
  std::string kind;
  std::string material;
  std::string elasticity;
  std::string item;
  std::string text;
  FilterOptions filter;
};

// What is listed, and the entries so far.
struct Listing {
  v1::CatalogService::Stub& stub;
  const GatewayClient& client;
  v1::ResourceFilter filter;
  bool with_document = false;
  std::vector<std::vector<std::string>> rows = {};
  nlohmann::ordered_json document = nlohmann::ordered_json::array();

  template <typename Message>
  void Add(const Message& message, std::string details) {
    rows.push_back({message.name(), message.title(), std::move(details)});
    if (with_document) document.push_back(ToJson(message));
  }
};

// The value called "drawer-slide" or "DRAWER_SLIDE"; the first one, which stands for none, where
// there is no text.
absl::StatusOr<int> ParseWord(const google::protobuf::EnumDescriptor& words,
                              const std::string& field, const std::string& text) {
  if (text.empty()) return 0;
  const std::string name = absl::StrReplaceAll(absl::AsciiStrToUpper(text), {{"-", "_"}});
  const auto* value = words.FindValueByName(name);
  if (value != nullptr && value->number() != 0) return value->number();
  std::string names;
  for (int i = 1; i < words.value_count(); ++i) {
    absl::StrAppend(&names, i == 1 ? "" : ", ", words.value(i)->name());
  }
  return InvalidField(field, absl::StrCat("'", text, "' is none of ", names));
}

// "BOLT, 0.31 EUR", or "0.31 EUR (example)" where the price is one.
std::string DetailsOf(const v1::Item& item) {
  return absl::StrFormat("%s, %.2f %s%s%s", v1::ItemKind_Name(item.kind()), item.price().amount(),
                         item.price().currency(),
                         item.price_basis() == v1::PER_VOLUME ? " per m³" : "",
                         item.price_is_example() ? " (example)" : "");
}

// What a template is made of.
std::string KindOf(const v1::Template& message) {
  switch (message.kind_case()) {
    case v1::Template::kAssembly:
      return "assembly";
    case v1::Template::kCad:
      return "features";
    case v1::Template::kCage:
      return "cage";
    case v1::Template::KIND_NOT_SET:
      break;
  }
  return "parts";
}

// Whether a template can be analysed as it is, or what it lacks.
std::string AnalysisText(const v1::Template& message) {
  if (message.analysis_lacks().empty()) return ", can be analysed";
  return absl::StrCat(", lacks ", absl::StrJoin(message.analysis_lacks(), " and "),
                      " to be analysed");
}

absl::Status ListMaterials(const ListOptions& options, Listing& listing) {
  v1::ListMaterialsRequest filters;
  MORTISE_ASSIGN_OR_RETURN(const int elasticity,
                           ParseWord(*v1::ListMaterialsRequest::Elasticity_descriptor(),
                                     "elasticity", options.elasticity));
  filters.set_elasticity(static_cast<v1::ListMaterialsRequest::Elasticity>(elasticity));
  filters.set_text(options.text);
  *filters.mutable_filter() = listing.filter;
  return ListAll<v1::ListMaterialsRequest, v1::ListMaterialsResponse>(
      listing.client, [&](auto... a) { return listing.stub.ListMaterials(a...); },
      [&](const v1::ListMaterialsResponse& page) {
        for (const auto& m : page.materials()) {
          listing.Add(m, absl::StrFormat("%g kg/m³%s", m.density(),
                                         m.has_orthotropic() ? ", orthotropic" : ""));
        }
      },
      filters);
}

absl::Status ListItems(const ListOptions& options, Listing& listing) {
  v1::ListItemsRequest filters;
  MORTISE_ASSIGN_OR_RETURN(const int kind,
                           ParseWord(*v1::ItemKind_descriptor(), "kind", options.kind));
  filters.set_kind(static_cast<v1::ItemKind>(kind));
  if (!options.material.empty()) {
    filters.set_material(ResourceName("materials", options.material));
  }
  filters.set_text(options.text);
  *filters.mutable_filter() = listing.filter;
  return ListAll<v1::ListItemsRequest, v1::ListItemsResponse>(
      listing.client, [&](auto... a) { return listing.stub.ListItems(a...); },
      [&](const v1::ListItemsResponse& page) {
        for (const auto& item : page.items()) listing.Add(item, DetailsOf(item));
      },
      filters);
}

absl::Status ListTemplates(const ListOptions& options, Listing& listing) {
  v1::ListTemplatesRequest filters;
  MORTISE_ASSIGN_OR_RETURN(const int kind, ParseWord(*v1::ListTemplatesRequest::Kind_descriptor(),
                                                     "kind", options.kind));
  filters.set_kind(static_cast<v1::ListTemplatesRequest::Kind>(kind));
  if (!options.item.empty()) filters.set_item(ResourceName("items", options.item));
  filters.set_text(options.text);
  *filters.mutable_filter() = listing.filter;
  return ListAll<v1::ListTemplatesRequest, v1::ListTemplatesResponse>(
      listing.client, [&](auto... a) { return listing.stub.ListTemplates(a...); },
      [&](const v1::ListTemplatesResponse& page) {
        for (const auto& t : page.templates()) {
          listing.Add(t, absl::StrCat(KindOf(t), ", revision ", t.revision(), AnalysisText(t)));
        }
      },
      filters);
}

// What is listed where nothing is said: what the filters are of.
std::string Subject(const ListOptions& options) {
  if (!options.what.empty()) return options.what;
  if (!options.elasticity.empty()) return "materials";
  if (!options.item.empty()) return "templates";
  const bool filtered = !options.kind.empty() || !options.material.empty() || !options.text.empty();
  return filtered ? "items" : "templates";
}

// That no filter is of something else.
absl::Status CheckFilters(const ListOptions& options, const std::string& what) {
  if (what != "items" && !options.material.empty()) {
    return InvalidField("material", "only items are told apart by their material");
  }
  if (what != "materials" && !options.elasticity.empty()) {
    return InvalidField("elasticity", "only materials are told apart by it");
  }
  if (what != "templates" && !options.item.empty()) {
    return InvalidField("item", "only templates are told apart by the items they use");
  }
  if (what == "materials" && !options.kind.empty()) {
    return InvalidField("kind", "only items and templates are told apart by kind");
  }
  return absl::OkStatus();
}

absl::Status List(const ListOptions& options, Session& session, Output& output) {
  const std::string what = Subject(options);
  MORTISE_RETURN_IF_ERROR(CheckFilters(options, what));
  MORTISE_ASSIGN_OR_RETURN(v1::ResourceFilter filter, ParseFilter(options.filter));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::CatalogService::NewStub(client->channel());
  Listing listing{*stub, *client, std::move(filter), !output.text()};
  MORTISE_RETURN_IF_ERROR(what == "materials" ? ListMaterials(options, listing)
                          : what == "items"   ? ListItems(options, listing)
                                              : ListTemplates(options, listing));
  output.Table({"name", "title", "details"}, listing.rows);
  output.Document(listing.document);
  return absl::OkStatus();
}

}  // namespace

void AddCatalogList(CLI::App& catalog, Session& session) {
  auto options = std::make_shared<ListOptions>();
  CommandFlags flags(*catalog.add_subcommand("list", "List templates, items or materials"));
  flags
      .Add("what", options->what,
           "templates (also if nothing is said), items (also with a filter) or materials")
      ->check(CLI::IsMember({"templates", "items", "materials"}));
  flags.Add("--kind", options->kind,
            "Only items of this kind, such as bolt, or templates: parts, assembly, cad, cage",
            "kind");
  flags.Add("--material", options->material, "Only items of this material, such as steel",
            "material");
  flags.Add("--elasticity", options->elasticity,
            "Only materials that are isotropic, or orthotropic as wood", "elasticity");
  flags.Add("--item", options->item, "Only templates that use this item", "item");
  flags.Add("--text", options->text,
            "Only those with these words in id or title, of items also standard or designation, "
            "of templates also description",
            "text");
  AddFilterOptions(flags, options->filter);
  flags.command().footer("Example: mortise catalog list --kind nut --text \"ISO 4032\"");
  flags.Run(session, [options](Session& s, Output& o) { return List(*options, s, o); });
}

}  // namespace mortise::cli
