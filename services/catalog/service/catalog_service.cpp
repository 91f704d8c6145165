// Answers the methods of CatalogService: each is a few lines between a message and
// catalog_records.h.
#include "services/catalog/service/catalog_service.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/host/call_author.h"
#include "common/host/chunk_stream.h"
#include "common/resources/resource_tags.h"
#include "common/rpc/handler.h"
#include "common/rpc/server_host.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "services/catalog/exchange/design_export.h"
#include "services/catalog/exchange/shape_file.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"
#include "services/catalog/records/store_reading.h"
#include "services/catalog/records/template_cache.h"
#include "services/catalog/records/upkeep.h"
#include "services/catalog/service/assembly_service.h"
#include "services/catalog/service/catalog_import.h"
#include "services/catalog/service/collection_loader.h"
#include "services/catalog/service/design_answer.h"
#include "services/catalog/service/design_stream.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kCompiledBytes = std::size_t{256} << 20;
constexpr std::size_t kParametrizedBytes = std::size_t{256} << 20;

// A template and where to evaluate it.
struct Choice {
  std::shared_ptr<const templates::Template> function;
  Eigen::VectorXd q;
};

// A design with the template it came from.
struct NamedDesign {
  std::shared_ptr<const templates::Template> function;
  Eigen::VectorXd q;
  parametric::EvaluatedDesign design;
};

class CatalogAdapter : public v1::CatalogService::CallbackService {
 public:
  CatalogAdapter(const rpc::ServiceEnvironment& environment, store::BlobFolder* blobs,
                 std::shared_ptr<ParametrizationCache> parametrized)
      : store_(environment.store),
        endpoint_(environment.dispatcher, "mortise.v1.CatalogService"),
        parametrized_(std::move(parametrized)),
        cache_(kCompiledBytes, parametrized_->ForTemplates()),
        upkeep_(environment.store, blobs, environment.options.blobs) {}

  // Checking tries designs of templates, so it happens before the transaction.
  grpc::ServerUnaryReactor* ImportCatalog(grpc::CallbackServerContext* context,
                                          const v1::ImportCatalogRequest* request,
                                          v1::ImportCatalogResponse* response) override {
    return endpoint_.PreparedMutation(
        "ImportCatalog", context, request, response,
        [this](const rpc::Call& call, const v1::ImportCatalogRequest& asked) {
          return PrepareImport(
              *store_, asked, [&call] { return call.cancelled(); }, parametrized_->ForTemplates());
        },
        [](const rpc::Call& call, const v1::ImportCatalogRequest& asked,
           std::vector<v1::TemplateBundle>& templates, store::Transaction& transaction) {
          return catalog::ImportCatalog(transaction, asked, templates, rpc::AuthorOf(call));
        },
        rpc::BadNumbers::kToldWithAllElse);
  }

  grpc::ServerUnaryReactor* GetMaterial(grpc::CallbackServerContext* context,
                                        const v1::GetMaterialRequest* request,
                                        v1::Material* response) override {
    return endpoint_.Query(
        "GetMaterial", context, request, response,
        [this](const rpc::Call&, const v1::GetMaterialRequest& asked) {
          return ReadFrom<v1::Material>(*store_, [&](store::ReadTransaction& transaction) {
            return catalog::GetMaterial(transaction, asked.name(), asked.revision());
          });
        });
  }

  grpc::ServerUnaryReactor* ListMaterials(grpc::CallbackServerContext* context,
                                          const v1::ListMaterialsRequest* request,
                                          v1::ListMaterialsResponse* response) override {
    return endpoint_.Query("ListMaterials", context, request, response,
                           [this](const rpc::Call&, const v1::ListMaterialsRequest& asked) {
                             return ListFrom(*store_, &v1::ListMaterialsResponse::mutable_materials,
                                             [&](store::ReadTransaction& transaction) {
                                               return catalog::ListMaterials(transaction, asked);
                                             });
                           });
  }

  grpc::ServerUnaryReactor* CreateMaterial(grpc::CallbackServerContext* context,
                                           const v1::CreateMaterialRequest* request,
                                           v1::Material* response) override {
    return endpoint_.Mutation("CreateMaterial", context, request, response,
                              [](const rpc::Call& call, const v1::CreateMaterialRequest& asked,
                                 store::Transaction& transaction) {
                                return catalog::CreateMaterial(transaction, asked.material(),
                                                               rpc::AuthorOf(call));
                              });
  }

  grpc::ServerUnaryReactor* UpdateMaterial(grpc::CallbackServerContext* context,
                                           const v1::UpdateMaterialRequest* request,
                                           v1::Material* response) override {
    return endpoint_.Mutation("UpdateMaterial", context, request, response,
                              [](const rpc::Call& call, const v1::UpdateMaterialRequest& asked,
                                 store::Transaction& transaction) {
                                return catalog::UpdateMaterial(transaction, asked,
                                                               rpc::AuthorOf(call));
                              });
  }

  grpc::ServerUnaryReactor* DeleteMaterial(grpc::CallbackServerContext* context,
                                           const v1::DeleteMaterialRequest* request,
                                           v1::DeleteMaterialResponse* response) override {
    return endpoint_.Mutation(
        "DeleteMaterial", context, request, response,
        [](const rpc::Call& call, const v1::DeleteMaterialRequest& asked,
           store::Transaction& transaction) -> absl::StatusOr<v1::DeleteMaterialResponse> {
          MORTISE_RETURN_IF_ERROR(catalog::DeleteMaterial(transaction, asked, rpc::AuthorOf(call)));
          return v1::DeleteMaterialResponse();
        });
  }

  grpc::ServerUnaryReactor* GetItem(grpc::CallbackServerContext* context,
                                    const v1::GetItemRequest* request,
                                    v1::Item* response) override {
    return endpoint_.Query(
        "GetItem", context, request, response,
        [this](const rpc::Call&, const v1::GetItemRequest& asked) {
          return ReadFrom<v1::Item>(*store_, [&](store::ReadTransaction& transaction) {
            return catalog::GetItem(transaction, asked.name(), asked.revision());
          });
        });
  }

  grpc::ServerUnaryReactor* ListItems(grpc::CallbackServerContext* context,
                                      const v1::ListItemsRequest* request,
                                      v1::ListItemsResponse* response) override {
    return endpoint_.Query("ListItems", context, request, response,
                           [this](const rpc::Call&, const v1::ListItemsRequest& asked) {
                             return ListFrom(*store_, &v1::ListItemsResponse::mutable_items,
                                             [&](store::ReadTransaction& transaction) {
                                               return catalog::ListItems(transaction, asked);
                                             });
                           });
  }

  grpc::ServerUnaryReactor* CreateItem(grpc::CallbackServerContext* context,
                                       const v1::CreateItemRequest* request,
                                       v1::Item* response) override {
    return endpoint_.Mutation("CreateItem", context, request, response,
                              [](const rpc::Call& call, const v1::CreateItemRequest& asked,
                                 store::Transaction& transaction) {
                                return catalog::CreateItem(transaction, asked.item(),
                                                           rpc::AuthorOf(call));
                              });
  }

  grpc::ServerUnaryReactor* UpdateItem(grpc::CallbackServerContext* context,
                                       const v1::UpdateItemRequest* request,
                                       v1::Item* response) override {
    return endpoint_.Mutation("UpdateItem", context, request, response,
                              [](const rpc::Call& call, const v1::UpdateItemRequest& asked,
                                 store::Transaction& transaction) {
                                return catalog::UpdateItem(transaction, asked, rpc::AuthorOf(call));
                              });
  }

  grpc::ServerUnaryReactor* DeleteItem(grpc::CallbackServerContext* context,
                                       const v1::DeleteItemRequest* request,
                                       v1::DeleteItemResponse* response) override {
    return endpoint_.Mutation(
        "DeleteItem", context, request, response,
        [](const rpc::Call& call, const v1::DeleteItemRequest& asked,
           store::Transaction& transaction) -> absl::StatusOr<v1::DeleteItemResponse> {
          MORTISE_RETURN_IF_ERROR(catalog::DeleteItem(transaction, asked, rpc::AuthorOf(call)));
          return v1::DeleteItemResponse();
        });
  }

  // Reading takes a while, so it happens before the transaction.
  grpc::ServerUnaryReactor* ImportShape(grpc::CallbackServerContext* context,
                                        const v1::ImportShapeRequest* request,
                                        v1::Shape* response) override {
    return endpoint_.PreparedMutation(
        "ImportShape", context, request, response,
        [](const rpc::Call&, const v1::ImportShapeRequest& asked) { return ReadShape(asked); },
        [](const rpc::Call& call, const v1::ImportShapeRequest&, v1::Shape& shape,
           store::Transaction& transaction) {
          return catalog::ImportShape(transaction, shape, rpc::AuthorOf(call));
        });
  }

  grpc::ServerUnaryReactor* GetShape(grpc::CallbackServerContext* context,
                                     const v1::GetShapeRequest* request,
                                     v1::Shape* response) override {
    return endpoint_.Query(
        "GetShape", context, request, response,
        [this](const rpc::Call&, const v1::GetShapeRequest& asked) -> absl::StatusOr<v1::Shape> {
          MORTISE_ASSIGN_OR_RETURN(
              v1::Shape shape,
              ReadFrom<v1::Shape>(*store_, [&](store::ReadTransaction& transaction) {
                return catalog::GetShape(transaction, asked.name());
              }));
          return ShownShape(std::move(shape));
        });
  }

  grpc::ServerWriteReactor<v1::Chunk>* DownloadShape(
      grpc::CallbackServerContext* context, const v1::DownloadShapeRequest* request) override {
    return endpoint_.ServerStream<v1::Chunk>(
        "DownloadShape", context, request,
        [this](const rpc::Call&, const v1::DownloadShapeRequest& asked,
               const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(
              const v1::Shape shape,
              ReadFrom<v1::Shape>(*store_, [&](store::ReadTransaction& transaction) {
                return catalog::GetShape(transaction, asked.name());
              }));
          rpc::StreamBytes(shape.SerializeAsString(), {"shape.binpb", "application/x-protobuf"},
                           writer);
          return absl::OkStatus();
        });
  }

  grpc::ServerUnaryReactor* GetTemplate(grpc::CallbackServerContext* context,
                                        const v1::GetTemplateRequest* request,
                                        v1::Template* response) override {
    return endpoint_.Query(
        "GetTemplate", context, request, response,
        [this](const rpc::Call&,
               const v1::GetTemplateRequest& asked) -> absl::StatusOr<v1::Template> {
          MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                                   FindBundle(asked.name(), asked.revision()));
          return std::move(*bundle.mutable_template_());
        });
  }

  grpc::ServerUnaryReactor* ListTemplates(grpc::CallbackServerContext* context,
                                          const v1::ListTemplatesRequest* request,
                                          v1::ListTemplatesResponse* response) override {
    return endpoint_.Query("ListTemplates", context, request, response,
                           [this](const rpc::Call&, const v1::ListTemplatesRequest& asked) {
                             return ListFrom(*store_, &v1::ListTemplatesResponse::mutable_templates,
                                             [&](store::ReadTransaction& transaction) {
                                               return catalog::ListTemplates(transaction, asked);
                                             });
                           });
  }

  // Checking tries many designs, so it happens before the transaction.
  grpc::ServerUnaryReactor* ImportTemplate(grpc::CallbackServerContext* context,
                                           const v1::ImportTemplateRequest* request,
                                           v1::Template* response) override {
    return endpoint_.PreparedMutation(
        "ImportTemplate", context, request, response,
        [this](const rpc::Call& call, const v1::ImportTemplateRequest& asked) {
          return PrepareTemplate(call, asked);
        },
        [](const rpc::Call& call, const v1::ImportTemplateRequest& asked,
           v1::TemplateBundle& bundle, store::Transaction& transaction) {
          return ImportBundle(transaction, bundle, asked.expected_revision(), rpc::AuthorOf(call));
        },
        rpc::BadNumbers::kToldWithAllElse);
  }

  grpc::ServerUnaryReactor* DeleteTemplate(grpc::CallbackServerContext* context,
                                           const v1::DeleteTemplateRequest* request,
                                           v1::DeleteTemplateResponse* response) override {
    return endpoint_.Mutation(
        "DeleteTemplate", context, request, response,
        [](const rpc::Call& call, const v1::DeleteTemplateRequest& asked,
           store::Transaction& transaction) -> absl::StatusOr<v1::DeleteTemplateResponse> {
          MORTISE_RETURN_IF_ERROR(catalog::DeleteTemplate(transaction, asked, rpc::AuthorOf(call)));
          return v1::DeleteTemplateResponse();
        });
  }

  grpc::ServerUnaryReactor* GetTemplateBundle(grpc::CallbackServerContext* context,
                                              const v1::GetTemplateBundleRequest* request,
                                              v1::TemplateBundle* response) override {
    return endpoint_.Query("GetTemplateBundle", context, request, response,
                           [this](const rpc::Call&, const v1::GetTemplateBundleRequest& asked) {
                             return WholeBundle(asked.name(), asked.revision());
                           });
  }

  grpc::ServerUnaryReactor* EvaluateTemplate(grpc::CallbackServerContext* context,
                                             const v1::EvaluateTemplateRequest* request,
                                             v1::EvaluatedDesign* response) override {
    return endpoint_.Query(
        "EvaluateTemplate", context, request, response,
        [this](const rpc::Call&,
               const v1::EvaluateTemplateRequest& asked) -> absl::StatusOr<v1::EvaluatedDesign> {
          MORTISE_ASSIGN_OR_RETURN(const NamedDesign evaluated,
                                   Evaluate(asked.name(), asked.revision(), asked.parameters()));
          v1::EvaluatedDesign answer = parametric::ToProto(evaluated.design);
          if (asked.without_triangles()) DropTriangles(answer);
          if (!asked.without_faults()) {
            MORTISE_RETURN_IF_ERROR(AddFaults(*evaluated.function, evaluated.q, answer));
          }
          if (answer.ByteSizeLong() > static_cast<std::size_t>(rpc::kMaxMessageBytes)) {
            return TooLarge("the design",
                            "4 MiB: ask for it without_triangles, or export it as a file");
          }
          return answer;
        },
        [this](const rpc::Call&, const v1::EvaluateTemplateRequest& asked) {
          return Choose(asked.name(), asked.revision(), asked.parameters()).status();
        });
  }

  grpc::ServerWriteReactor<v1::Chunk>* ExportDesign(
      grpc::CallbackServerContext* context, const v1::ExportDesignRequest* request) override {
    return endpoint_.ServerStream<v1::Chunk>(
        "ExportDesign", context, request,
        [this](const rpc::Call&, const v1::ExportDesignRequest& asked,
               const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
          return Export(asked, writer);
        },
        {},
        [this](const rpc::Call&, const v1::ExportDesignRequest& asked) {
          return ChooseFor(asked).status();
        });
  }

 private:
  absl::StatusOr<v1::TemplateBundle> FindBundle(const std::string& name, int64_t revision) {
    return ReadFrom<v1::TemplateBundle>(*store_, [&](store::ReadTransaction& transaction) {
      return GetBundle(transaction, name, revision);
    });
  }

  absl::StatusOr<v1::TemplateBundle> PrepareTemplate(const rpc::Call& call,
                                                     const v1::ImportTemplateRequest& asked) {
    absl::StatusOr<v1::TemplateBundle> bundle = FreezeAndComplete(call, asked.template_());
    const absl::Status faults =
        Together(bundle.status(), resources::ValidateTags(asked.template_()));
    MORTISE_RETURN_IF_ERROR(WithRevisionFault(*store_, kTemplates, asked.template_().name(),
                                              asked.expected_revision(),
                                              UnderField("template", faults)));
    return bundle;
  }

  absl::StatusOr<v1::TemplateBundle> FreezeAndComplete(const rpc::Call& call,
                                                       const v1::Template& message) {
    MORTISE_ASSIGN_OR_RETURN(
        v1::TemplateBundle bundle,
        ReadFrom<v1::TemplateBundle>(*store_, [&](store::ReadTransaction& transaction) {
          return Freeze(transaction, message);
        }));
    MORTISE_RETURN_IF_ERROR(templates::Complete(
        bundle, templates::Trial::kThorough, [&call] { return call.cancelled(); },
        parametrized_->ForTemplates()));
    return bundle;
  }

  // With the triangles of all shapes, as many as fit, or their names: what F(q) takes.
  absl::StatusOr<v1::TemplateBundle> WholeBundle(const std::string& name, int64_t revision) {
    MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, FindBundle(name, revision));
    MORTISE_RETURN_IF_ERROR(AddShapesTo(bundle));
    DropExact(*bundle.mutable_shapes());
    NameWhatDoesNotFit(bundle);
    return bundle;
  }

  absl::Status AddShapesTo(v1::TemplateBundle& bundle) {
    return store_->Read([&](store::ReadTransaction& transaction) {
      return AddShapes(transaction, bundle.assembly(), bundle.items(), *bundle.mutable_shapes());
    });
  }

  // F and the given parameters, rounded to what a workshop can set.
  absl::StatusOr<Choice> Choose(
      const std::string& name, int64_t revision,
      const google::protobuf::RepeatedPtrField<v1::ParameterValue>& values) {
    MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, FindBundle(name, revision));
    MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<const templates::Template> function,
                             cache_.Get(std::move(bundle), [this](v1::TemplateBundle& needed) {
                               return AddShapesTo(needed);
                             }));
    const std::vector<parametric::Parameter>& parameters = function->parameters();
    MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd q,
                             parametric::Complete(parameters, parametric::FromProto(values)));
    q = parametric::RoundToSteps(parameters, q);
    return Choice{std::move(function), std::move(q)};
  }

  // What a file is made of. Everything that is wrong with the request is told.
  absl::StatusOr<Choice> ChooseFor(const v1::ExportDesignRequest& asked) {
    absl::StatusOr<Choice> choice = Choose(asked.name(), asked.revision(), asked.parameters());
    MORTISE_RETURN_IF_ERROR(Together(CheckFile(asked), choice.status()));
    return choice;
  }

  // Whether there is such a file, of whatever template.
  static absl::Status CheckFile(const v1::ExportDesignRequest& asked) {
    if (asked.format() != v1::ExportDesignRequest::DESIGN) return KindOf(asked.format()).status();
    if (asked.rest_pose().empty()) return absl::OkStatus();
    return InvalidField("rest_pose", "of a DESIGN there is only the pose it is drawn in");
  }

  static absl::StatusOr<NamedDesign> Evaluate(Choice choice) {
    MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedDesign design,
                             choice.function->Evaluate(choice.q));
    return NamedDesign{std::move(choice.function), std::move(choice.q), std::move(design)};
  }

  // F at the given parameters.
  absl::StatusOr<NamedDesign> Evaluate(
      const std::string& name, int64_t revision,
      const google::protobuf::RepeatedPtrField<v1::ParameterValue>& values) {
    MORTISE_ASSIGN_OR_RETURN(Choice choice, Choose(name, revision, values));
    return Evaluate(std::move(choice));
  }

  absl::Status Export(const v1::ExportDesignRequest& asked,
                      const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
    MORTISE_ASSIGN_OR_RETURN(Choice choice, ChooseFor(asked));
    MORTISE_ASSIGN_OR_RETURN(const NamedDesign evaluated, Evaluate(std::move(choice)));
    if (asked.format() == v1::ExportDesignRequest::DESIGN) return ExportMessage(evaluated, writer);
    MORTISE_ASSIGN_OR_RETURN(const FileKind kind, KindOf(asked.format()));
    const std::string id = asked.name().substr(asked.name().find('/') + 1);
    MORTISE_ASSIGN_OR_RETURN(const auto assembly, evaluated.function->AssemblyAt(evaluated.q));
    if (assembly) {
      return StreamAssembly({*assembly->assembly, assembly->q, evaluated.design, asked.rest_pose()},
                            asked.format(), id, evaluated.function->head().title, writer);
    }
    if (!asked.rest_pose().empty()) {
      return InvalidField("rest_pose", "only assembly templates have rest poses");
    }
    std::string bytes;
    if (asked.format() == v1::ExportDesignRequest::STEP) {
      MORTISE_ASSIGN_OR_RETURN(const std::vector<cad::Solid> solids,
                               evaluated.function->Solids(evaluated.q));
      MORTISE_ASSIGN_OR_RETURN(bytes, ExportStep(evaluated.design, solids, id));
    } else {
      MORTISE_ASSIGN_OR_RETURN(bytes,
                               ExportMesh(evaluated.design, {}, MeshFormatOf(asked.format()), id));
    }
    rpc::StreamBytes(std::move(bytes), {id + kind.extension, kind.media_type}, writer);
    return absl::OkStatus();
  }

  // The evaluated design itself, as large as it may be.
  static absl::Status ExportMessage(const NamedDesign& evaluated,
                                    const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
    v1::EvaluatedDesign design = parametric::ToProto(evaluated.design);
    MORTISE_RETURN_IF_ERROR(AddFaults(*evaluated.function, evaluated.q, design));
    rpc::StreamBytes(design.SerializeAsString(), {"design.binpb", "application/x-protobuf"},
                     writer);
    return absl::OkStatus();
  }

  store::Store* const store_;
  rpc::Endpoint endpoint_;
  const std::shared_ptr<ParametrizationCache> parametrized_;
  TemplateCache cache_;
  const Upkeep upkeep_;
};

}  // namespace

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, const std::filesystem::path& collection) {
  const auto parametrized = std::make_shared<ParametrizationCache>(kParametrizedBytes);
  if (!collection.empty()) {
    MORTISE_RETURN_IF_ERROR(LoadCollection(*environment.store, collection, *parametrized).status());
  }
  MORTISE_ASSIGN_OR_RETURN(store::BlobFolder* const blobs, environment.store->Blobs());
  return std::vector<std::shared_ptr<grpc::Service>>{
      std::make_shared<CatalogAdapter>(environment, blobs, parametrized),
      MakeAssemblyService(environment, blobs, parametrized)};
}

}  // namespace mortise::catalog
