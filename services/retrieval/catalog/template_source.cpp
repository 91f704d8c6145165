#include "services/retrieval/catalog/template_source.h"

#include <grpcpp/grpcpp.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/parametric_assembly.h"
#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/bundles/bundle_source.h"
#include "common/bundles/template_list.h"
#include "common/design/parameter_values.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::retrieval {
namespace {

constexpr int kPageSize = 1000;
constexpr std::size_t kSurfaceBytes = std::size_t{16} << 20;

// Of a template of an assembly that of a sub-tree.
absl::Status ReduceTo(const std::string& group, v1::TemplateBundle& bundle) {
  v1::Template& message = *bundle.mutable_template_();
  if (!message.has_assembly()) return InvalidField("group", "is of assemblies alone");
  message.mutable_assembly()->set_group(group);
  // What is said of the whole does not hold of a part of it.
  message.mutable_assembly()->clear_handles();
  message.clear_title();
  message.clear_description();
  message.clear_parameters();
  message.clear_boundary_conditions();
  message.clear_reference_temperature();
  message.clear_metric_definitions();
  return templates::FillAndCheck(bundle, templates::Trial::kDefaults);
}

// The names of all resources that a List method gives, page by page.
template <typename Request, typename Response, typename Message>
absl::StatusOr<std::vector<std::string>> NamesOf(
    v1::CatalogService::Stub& stub,
    grpc::Status (v1::CatalogService::Stub::*list)(grpc::ClientContext*, const Request&, Response*),
    Request request,
    const google::protobuf::RepeatedPtrField<Message>& (Response::*entries)() const,
    const rpc::Origin& origin) {
  std::vector<std::string> names;
  request.set_page_size(kPageSize);
  do {
    MORTISE_ASSIGN_OR_RETURN(const Response page, rpc::CallUnary(stub, list, request, origin));
    for (const Message& each : (page.*entries)()) names.push_back(each.name());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return names;
}

}  // namespace

std::vector<std::string> GroupsOf(const SearchedTemplate& whole) {
  if (!whole.group.empty()) return {};
  const templates::Template& design_template = *whole.design_template;
  const auto design =
      design_template.AssemblyAt(parametric::Defaults(design_template.parameters()));
  if (!design.ok() || !*design) return {};
  return parametric::DistinctSubTrees((*design)->assembly->assembly());
}

TemplateSource::TemplateSource(std::shared_ptr<grpc::Channel> catalog, std::size_t capacity)
    : catalog_(catalog), shapes_(std::move(catalog), kSurfaceBytes), kept_(capacity) {}

absl::StatusOr<std::vector<std::string>> TemplateSource::MaterialNames(
    const rpc::Origin& origin) const {
  const auto stub = v1::CatalogService::NewStub(catalog_);
  return NamesOf(*stub, &v1::CatalogService::Stub::ListMaterials, v1::ListMaterialsRequest(),
                 &v1::ListMaterialsResponse::materials, origin);
}

absl::StatusOr<std::vector<std::string>> TemplateSource::ItemNames(
    const rpc::Origin& origin) const {
  const auto stub = v1::CatalogService::NewStub(catalog_);
  return NamesOf(*stub, &v1::CatalogService::Stub::ListItems, v1::ListItemsRequest(),
                 &v1::ListItemsResponse::items, origin);
}

absl::StatusOr<std::vector<v1::Template>> TemplateSource::List(
    const v1::ResourceFilter& filter, const rpc::Origin& origin,
    const rpc::RetryOptions& retry) const {
  v1::ListTemplatesRequest request;
  *request.mutable_filter() = filter;
  return bundles::ListTemplates(catalog_, std::move(request), origin, retry);
}

absl::StatusOr<std::shared_ptr<const SearchedTemplate>> TemplateSource::Get(
    const std::string& name, std::int64_t revision, const rpc::Origin& origin,
    const std::string& group) {
  MORTISE_RETURN_IF_ERROR(ParseResourceName(name, "templates", "template").status());
  if (revision < 0) return InvalidField("template_revision", "must not be negative");
  // A revision never changes.
  if (const auto kept = kept_.Find(absl::StrCat(name, "/", revision, "/", group))) return *kept;
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                           bundles::FetchBundle(catalog_, name, revision, origin));
  const std::string key = absl::StrCat(name, "/", bundle.template_().revision(), "/", group);
  return kept_.Get(key, [&]() -> absl::StatusOr<Kept::Made> {
    MORTISE_RETURN_IF_ERROR(shapes_.AddMore(bundle, {}, origin));
    SearchedTemplate compiled{.name = name,
                              .revision = bundle.template_().revision(),
                              .digest = absl::StrCat(bundles::ContentDigest(bundle), group),
                              .title = "",
                              .group = group,
                              .design_template = nullptr,
                              .domain = nullptr};
    if (!group.empty()) MORTISE_RETURN_IF_ERROR(ReduceTo(group, bundle));
    compiled.title = bundle.template_().title();
    MORTISE_ASSIGN_OR_RETURN(compiled.design_template, templates::Compile(bundle));
    compiled.domain = std::make_shared<const KeptDomain>(compiled.design_template);
    const std::size_t bytes = compiled.design_template->MemoryUse();
    return Kept::Made{std::make_shared<const SearchedTemplate>(std::move(compiled)), bytes};
  });
}

}  // namespace mortise::retrieval
