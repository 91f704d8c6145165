#include "services/composer/service/save_methods.h"

#include <grpcpp/grpcpp.h>

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/design/field_checks.h"
#include "common/design/template_validation.h"
#include "common/host/call_author.h"
#include "common/rpc/channel.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "services/composer/catalog/shape_imports.h"
#include "services/composer/service/model_change.h"
#include "services/composer/service/model_loads.h"
#include "services/composer/service/new_body.h"

namespace mortise::composer::methods {
namespace {

// What is told of the catalog's findings, which name its own fields. `expected` is the revision of
// the assembly or template called `name` that was to be there; 0 for none.
absl::Status Refused(const absl::Status& status, const std::string& name, std::int64_t expected) {
  if (absl::IsAborted(status) && expected == 0) return ResourceExists(name);
  if (!absl::IsInvalidArgument(status)) return status;
  return PreconditionFailed(
      "MODEL_REFUSED", absl::StrCat("the catalog refuses the model: ", status.message()), "name");
}

absl::Status CheckSaving(const v1::SaveModelRequest& asked) {
  std::vector<FieldViolation> findings;
  if (!asked.template_id().empty() && !IsResourceId(asked.template_id())) {
    findings.push_back({"template_id",
                        "must be 1 to 63 lower-case letters, digits and hyphens, and begin and end "
                        "with a letter or digit"});
  }
  parametric::CheckTitle("title", asked.title(), findings);
  return parametric::ToStatus(findings);
}

absl::Status CheckComplete(const OpenModel& model) {
  if (!model.body) {
    return PreconditionFailed("MODEL_EMPTY", absl::StrCat("nothing is in ", model.name, " yet"),
                              "name");
  }
  if (model.loose.empty()) return absl::OkStatus();
  return PreconditionFailed(
      "COMPONENT_NOT_CONNECTED",
      absl::StrCat("'", model.loose.front().id, "' is not connected: connect or remove it"),
      "name");
}

// An idempotency key for a call that is part of another: repeated with it, it has its effect once.
std::string KeyOf(const rpc::Call& call, const v1::SaveModelRequest& asked, const char* what) {
  return Sha256Hex(absl::StrCat(call.identity().subject, "\n", asked.request_id(), "\n", what));
}

// Imports what the model's parts look like and the catalog does not know.
absl::Status StoreShapes(const Composer& composer, const rpc::Call& call,
                         const v1::SaveModelRequest& asked, v1::AssemblyBundle* bundle) {
  const absl::Status stored = ImportShapes(composer.catalog, rpc::ForwardedFrom(call),
                                           KeyOf(call, asked, "shapes"), bundle);
  const bool is_of_shape = absl::IsInvalidArgument(stored) || absl::IsResourceExhausted(stored) ||
                           DetailOf(stored).reason == "SHAPE_NOT_SOLID" ||
                           DetailOf(stored).reason == "NO_STEP";
  if (!is_of_shape) return stored;
  return PreconditionFailed(
      "MODEL_REFUSED", absl::StrCat("the shape of a part cannot be stored: ", stored.message()),
      "name");
}

absl::StatusOr<v1::Assembly> ImportAssembly(const Composer& composer, const rpc::Call& call,
                                            const v1::SaveModelRequest& asked,
                                            v1::Assembly assembly, std::int64_t expected) {
  v1::ImportAssemblyRequest request;
  request.set_request_id(KeyOf(call, asked, "assembly"));
  request.set_expected_revision(expected);
  const std::string name = assembly.name();
  *request.mutable_assembly() = std::move(assembly);
  const auto stub = v1::AssemblyService::NewStub(composer.catalog);
  absl::StatusOr<v1::Assembly> imported = rpc::CallUnary(
      *stub, &v1::AssemblyService::Stub::ImportAssembly, request, rpc::ForwardedFrom(call));
  if (!imported.ok()) return Refused(imported.status(), name, expected);
  return imported;
}

absl::StatusOr<v1::Template> ImportTemplate(const Composer& composer, const rpc::Call& call,
                                            const v1::SaveModelRequest& asked,
                                            const v1::Assembly& assembly, const std::string& name,
                                            std::int64_t expected, const v1::Template& loads) {
  v1::ImportTemplateRequest request;
  *request.mutable_template_() = loads;
  request.set_request_id(KeyOf(call, asked, "template"));
  request.set_expected_revision(expected);
  request.mutable_template_()->set_name(name);
  request.mutable_template_()->set_title(assembly.title());
  request.mutable_template_()->mutable_assembly()->set_assembly(assembly.name());
  request.mutable_template_()->mutable_assembly()->set_revision(assembly.revision());
  const auto stub = v1::CatalogService::NewStub(composer.catalog);
  absl::StatusOr<v1::Template> imported = rpc::CallUnary(
      *stub, &v1::CatalogService::Stub::ImportTemplate, request, rpc::ForwardedFrom(call));
  if (!imported.ok()) return Refused(imported.status(), name, expected);
  return imported;
}

// Takes an assembly back that nothing exposes; what keeps it from that is not worth telling.
void TakeBack(const Composer& composer, const rpc::Call& call, const v1::SaveModelRequest& asked,
              const v1::Assembly& assembly) {
  v1::DeleteAssemblyRequest request;
  request.set_request_id(KeyOf(call, asked, "taken back"));
  request.set_name(assembly.name());
  request.set_revision(assembly.revision());
  const auto stub = v1::AssemblyService::NewStub(composer.catalog);
  rpc::CallUnary(*stub, &v1::AssemblyService::Stub::DeleteAssembly, request,
                 rpc::ForwardedFrom(call))
      .status()
      .IgnoreError();
}

}  // namespace

absl::StatusOr<v1::SavedModel> WriteIntoCatalog(const Composer& composer, const rpc::Call& call,
                                                const v1::SaveModelRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CheckSaving(asked));
  MORTISE_ASSIGN_OR_RETURN(const ModelAtWork at_work, OpenFor(composer, call, asked));
  const v1::Model& seen = at_work.seen;
  MORTISE_RETURN_IF_ERROR(CheckComplete(at_work.model));
  v1::Template loads;
  if (asked.with_loads()) {
    MORTISE_ASSIGN_OR_RETURN(loads, LoadsOf(*at_work.model.body, at_work.model, composer.drawings));
  }
  const std::string id = asked.template_id().empty() ? seen.name().substr(seen.name().find('/') + 1)
                                                     : asked.template_id();
  v1::SavedModel saved;
  saved.set_template_(absl::StrCat("templates/", id));
  saved.set_assembly(absl::StrCat("assemblies/", id));
  saved.set_digest(seen.digest());
  const bool again = seen.saved().template_() == saved.template_();
  MORTISE_ASSIGN_OR_RETURN(Drawing drawing,
                           DrawBody(at_work.model, saved.assembly(), composer.drawings));
  MORTISE_RETURN_IF_ERROR(StoreShapes(composer, call, asked, &drawing.bundle));
  v1::Assembly& drawn = *drawing.bundle.mutable_assembly();
  const std::string& title = asked.title().empty() ? seen.title() : asked.title();
  drawn.set_title(title.empty() ? id : title);
  MORTISE_ASSIGN_OR_RETURN(const v1::Assembly assembly,
                           ImportAssembly(composer, call, asked, std::move(drawn),
                                          again ? seen.saved().assembly_revision() : 0));
  saved.set_assembly_revision(assembly.revision());
  const absl::StatusOr<v1::Template> made =
      ImportTemplate(composer, call, asked, assembly, saved.template_(),
                     again ? seen.saved().template_revision() : 0, loads);
  if (!made.ok()) {
    if (!again && !absl::IsUnavailable(made.status())) TakeBack(composer, call, asked, assembly);
    return made.status();
  }
  saved.set_template_revision(made->revision());
  return saved;
}

absl::StatusOr<v1::SavedModel> SaveModel(const Composer&, const rpc::Call& call,
                                         const v1::SaveModelRequest& asked,
                                         const v1::SavedModel& saved,
                                         store::Transaction& transaction) {
  // What was saved is in the catalog, whatever has become of the model since.
  MORTISE_ASSIGN_OR_RETURN(v1::Model head, kModels.Get(transaction, asked.name()));
  *head.mutable_saved() = saved;
  MORTISE_RETURN_IF_ERROR(PutHead(transaction, head, rpc::AuthorOf(call)));
  return saved;
}

}  // namespace mortise::composer::methods
