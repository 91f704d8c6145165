// Answers the methods of AssemblyService: each is a few lines between a message and
// assembly_records.h or parametric_assembly.h.
#include "services/catalog/service/assembly_service.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/assembly_design.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/files/template_codec.h"
#include "common/host/call_author.h"
#include "common/resources/resource_tags.h"
#include "common/rpc/handler.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/exchange/part_annotations.h"
#include "services/catalog/records/assembly_records.h"
#include "services/catalog/records/drawing_records.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"
#include "services/catalog/records/store_reading.h"
#include "services/catalog/service/asked_parameters.h"
#include "services/catalog/service/demand_check.h"
#include "services/catalog/service/design_stream.h"
#include "services/catalog/service/drawing_source.h"

namespace mortise::catalog {
namespace {

constexpr int kMaxDesigns = 1000;  // in one answer

using AdjustedWriter = std::shared_ptr<rpc::StreamWriter<v1::AdjustedAssembly>>;

// An assembly revision, parametrised.
struct Found {
  v1::AssemblyBundle bundle;
  templates::Parametrization parametrized;
};

// Where to look at one.
struct Chosen {
  Found found;
  Eigen::VectorXd q;
};

struct ChosenPoints {
  Found found;
  std::vector<Eigen::VectorXd> points;
};

// An assembly that is drawn in CAD and can be stored.
struct Imported {
  v1::AssemblyBundle bundle;
  std::vector<std::string> notes;
};

absl::Status CheckCount(const char* field, int count) {
  if (count >= 1 && count <= kMaxDesigns) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("must be 1 to ", kMaxDesigns));
}

absl::StatusOr<v1::AdjustedAssembly> Evaluate(const Found& found, const Eigen::VectorXd& q,
                                              const std::string& field) {
  auto evaluated = parametric::EvaluatedToProto(*found.parametrized, q);
  if (absl::IsInvalidArgument(evaluated.status())) {
    return InvalidField(field, std::string(evaluated.status().message()));
  }
  MORTISE_RETURN_IF_ERROR(evaluated.status());
  evaluated->set_assembly(found.bundle.assembly().name());
  evaluated->set_revision(found.bundle.assembly().revision());
  return evaluated;
}

// Sends one design for each of the parameters, as the reader takes them.
void StreamDesigns(Found found, std::vector<Eigen::VectorXd> parameters,
                   const std::string& list_field, const AdjustedWriter& writer) {
  struct Source {
    Found found;
    std::vector<Eigen::VectorXd> parameters;
    std::size_t next = 0;
  };
  const auto source = std::make_shared<Source>(Source{std::move(found), std::move(parameters)});
  // The writer keeps the function, so the function must not keep the writer.
  const std::weak_ptr<rpc::StreamWriter<v1::AdjustedAssembly>> weak = writer;
  writer->Pull([source, weak, list_field]() -> absl::StatusOr<std::optional<v1::AdjustedAssembly>> {
    if (source->next == source->parameters.size()) {
      if (const auto present = weak.lock()) present->Finish(absl::OkStatus());
      return std::optional<v1::AdjustedAssembly>();
    }
    const std::size_t index = source->next++;
    MORTISE_ASSIGN_OR_RETURN(v1::AdjustedAssembly design,
                             Evaluate(source->found, source->parameters[index],
                                      absl::StrCat(list_field, "[", index, "].q")));
    return std::optional<v1::AdjustedAssembly>(std::move(design));
  });
}

class AssemblyAdapter : public v1::AssemblyService::CallbackService {
 public:
  AssemblyAdapter(const rpc::ServiceEnvironment& environment, store::BlobFolder* blobs,
                  std::shared_ptr<ParametrizationCache> parametrized)
      : store_(environment.store),
        blobs_(blobs),
        endpoint_(environment.dispatcher, "mortise.v1.AssemblyService"),
        parametrized_(std::move(parametrized)),
        drawings_(environment.store, blobs) {}

  grpc::ServerUnaryReactor* GetAssembly(grpc::CallbackServerContext* context,
                                        const v1::GetAssemblyRequest* request,
                                        v1::Assembly* response) override {
    return endpoint_.Query(
        "GetAssembly", context, request, response,
        [this](const rpc::Call&,
               const v1::GetAssemblyRequest& asked) -> absl::StatusOr<v1::Assembly> {
          MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, Get(asked.name(), asked.revision()));
          return std::move(*bundle.mutable_assembly());
        });
  }

  grpc::ServerUnaryReactor* ListAssemblies(grpc::CallbackServerContext* context,
                                           const v1::ListAssembliesRequest* request,
                                           v1::ListAssembliesResponse* response) override {
    return endpoint_.Query("ListAssemblies", context, request, response,
                           [this](const rpc::Call&, const v1::ListAssembliesRequest& asked) {
                             return ListFrom(*store_,
                                             &v1::ListAssembliesResponse::mutable_assemblies,
                                             [&](store::ReadTransaction& transaction) {
                                               return catalog::ListAssemblies(transaction, asked);
                                             });
                           });
  }

  // Parametrising takes a while, so it happens before the transaction.
  grpc::ServerUnaryReactor* ImportAssembly(grpc::CallbackServerContext* context,
                                           const v1::ImportAssemblyRequest* request,
                                           v1::Assembly* response) override {
    return endpoint_.PreparedMutation(
        "ImportAssembly", context, request, response,
        [this](const rpc::Call& call,
               const v1::ImportAssemblyRequest& asked) -> absl::StatusOr<v1::AssemblyBundle> {
          MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, FreezeNow(asked.assembly()));
          MORTISE_RETURN_IF_ERROR(WithRevisionFault(
              *store_, kAssemblies, asked.assembly().name(), asked.expected_revision(),
              UnderField("assembly", Together(Parametrize(call, bundle).status(),
                                              resources::ValidateTags(asked.assembly())))));
          return bundle;
        },
        [](const rpc::Call& call, const v1::ImportAssemblyRequest& asked,
           v1::AssemblyBundle& bundle, store::Transaction& transaction) {
          return ImportBundle(transaction, bundle, asked.expected_revision(), rpc::AuthorOf(call));
        },
        rpc::BadNumbers::kToldWithAllElse);
  }

  grpc::ServerUnaryReactor* ImportAssemblyStep(grpc::CallbackServerContext* context,
                                               const v1::ImportAssemblyStepRequest* request,
                                               v1::ImportAssemblyStepResponse* response) override {
    return endpoint_.PreparedMutation(
        "ImportAssemblyStep", context, request, response,
        [this](const rpc::Call& call, const v1::ImportAssemblyStepRequest& asked) {
          return PrepareStep(call, asked);
        },
        [](const rpc::Call& call, const v1::ImportAssemblyStepRequest& asked, Imported& imported,
           store::Transaction& transaction) -> absl::StatusOr<v1::ImportAssemblyStepResponse> {
          v1::ImportAssemblyStepResponse answer;
          MORTISE_ASSIGN_OR_RETURN(*answer.mutable_assembly(),
                                   ImportBundle(transaction, imported.bundle,
                                                asked.expected_revision(), rpc::AuthorOf(call)));
          answer.mutable_notes()->Assign(imported.notes.begin(), imported.notes.end());
          return answer;
        },
        rpc::BadNumbers::kToldWithAllElse);
  }

  grpc::ServerUnaryReactor* DeleteAssembly(grpc::CallbackServerContext* context,
                                           const v1::DeleteAssemblyRequest* request,
                                           v1::DeleteAssemblyResponse* response) override {
    return endpoint_.Mutation(
        "DeleteAssembly", context, request, response,
        [](const rpc::Call& call, const v1::DeleteAssemblyRequest& asked,
           store::Transaction& transaction) -> absl::StatusOr<v1::DeleteAssemblyResponse> {
          MORTISE_RETURN_IF_ERROR(catalog::DeleteAssembly(transaction, asked, rpc::AuthorOf(call)));
          return v1::DeleteAssemblyResponse();
        });
  }

  grpc::ServerReadReactor<v1::Chunk>* UploadDrawing(grpc::CallbackServerContext* context,
                                                    v1::UploadDrawingResponse* response) override {
    using Reader = rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>;
    return endpoint_.Upload<v1::Chunk, v1::UploadDrawingResponse>(
        "UploadDrawing", context, response,
        [this](const rpc::Call&) -> absl::StatusOr<std::unique_ptr<Reader>> {
          return ReceiveDrawing(store_, blobs_);
        });
  }

  grpc::ServerUnaryReactor* ParametrizeAssembly(grpc::CallbackServerContext* context,
                                                const v1::ParametrizeAssemblyRequest* request,
                                                v1::Parametrization* response) override {
    return endpoint_.Query(
        "ParametrizeAssembly", context, request, response,
        [this](const rpc::Call& call,
               const v1::ParametrizeAssemblyRequest& asked) -> absl::StatusOr<v1::Parametrization> {
          MORTISE_ASSIGN_OR_RETURN(const Found found, Find(call, asked.name(), asked.revision()));
          MORTISE_ASSIGN_OR_RETURN(v1::Parametrization described,
                                   parametric::ToProto(*found.parametrized));
          described.set_assembly(found.bundle.assembly().name());
          described.set_revision(found.bundle.assembly().revision());
          return described;
        });
  }

  grpc::ServerUnaryReactor* AdjustAssembly(grpc::CallbackServerContext* context,
                                           const v1::AdjustAssemblyRequest* request,
                                           v1::AdjustedAssembly* response) override {
    return endpoint_.Query(
        "AdjustAssembly", context, request, response,
        [this](const rpc::Call& call, const v1::AdjustAssemblyRequest& asked) {
          return Adjust(call, asked);
        },
        [this](const rpc::Call& call, const v1::AdjustAssemblyRequest& asked) {
          return ChooseFor(call, asked).status();
        });
  }

  grpc::ServerWriteReactor<v1::AdjustedAssembly>* EvaluateAssembly(
      grpc::CallbackServerContext* context, const v1::EvaluateAssemblyRequest* request) override {
    return endpoint_.ServerStream<v1::AdjustedAssembly>(
        "EvaluateAssembly", context, request,
        [this](const rpc::Call& call, const v1::EvaluateAssemblyRequest& asked,
               const AdjustedWriter& writer) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(ChosenPoints chosen, ChooseFor(call, asked));
          StreamDesigns(std::move(chosen.found), std::move(chosen.points), "points", writer);
          return absl::OkStatus();
        },
        {},
        [this](const rpc::Call& call, const v1::EvaluateAssemblyRequest& asked) {
          return ChooseFor(call, asked).status();
        });
  }

  grpc::ServerWriteReactor<v1::AdjustedAssembly>* SampleAssembly(
      grpc::CallbackServerContext* context, const v1::SampleAssemblyRequest* request) override {
    return endpoint_.ServerStream<v1::AdjustedAssembly>(
        "SampleAssembly", context, request,
        [this](const rpc::Call& call, const v1::SampleAssemblyRequest& asked,
               const AdjustedWriter& writer) -> absl::Status {
          absl::StatusOr<Found> found = Find(call, asked.name(), asked.revision());
          MORTISE_RETURN_IF_ERROR(Together(CheckCount("count", asked.count()), found.status()));
          MORTISE_ASSIGN_OR_RETURN(std::vector<Eigen::VectorXd> samples,
                                   found->parametrized->Sample(asked.count(), asked.seed()));
          StreamDesigns(*std::move(found), std::move(samples), "samples", writer);
          return absl::OkStatus();
        });
  }

  grpc::ServerWriteReactor<v1::Chunk>* ExportAssembly(
      grpc::CallbackServerContext* context, const v1::ExportAssemblyRequest* request) override {
    return endpoint_.ServerStream<v1::Chunk>(
        "ExportAssembly", context, request,
        [this](const rpc::Call& call, const v1::ExportAssemblyRequest& asked,
               const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
          return Export(call, asked, writer);
        },
        {},
        [this](const rpc::Call& call, const v1::ExportAssemblyRequest& asked) {
          return ChooseFor(call, asked).status();
        });
  }

 private:
  absl::StatusOr<v1::AssemblyBundle> Get(const std::string& name, int64_t revision) {
    return ReadFrom<v1::AssemblyBundle>(*store_, [&](store::ReadTransaction& transaction) {
      return GetAssemblyBundle(transaction, name, revision);
    });
  }

  absl::StatusOr<v1::AssemblyBundle> FreezeNow(const v1::Assembly& assembly) {
    return ReadFrom<v1::AssemblyBundle>(*store_, [&](store::ReadTransaction& transaction) {
      return Freeze(transaction, assembly);
    });
  }

  // What is said of 'step' is said of the drawing that was uploaded instead.
  absl::StatusOr<Imported> PrepareStep(const rpc::Call& call,
                                       const v1::ImportAssemblyStepRequest& asked) {
    absl::StatusOr<Imported> prepared = PrepareAnyStep(call, asked);
    const bool renames = !prepared.ok() && !asked.drawing().empty();
    MORTISE_RETURN_IF_ERROR(WithRevisionFault(
        *store_, kAssemblies, asked.annotations().name(), asked.expected_revision(),
        Together(renames ? OfUpload(prepared.status()) : prepared.status(),
                 UnderField("annotations", resources::ValidateTags(asked.annotations())))));
    return prepared;
  }

  absl::StatusOr<Imported> PrepareAnyStep(const rpc::Call& call,
                                          const v1::ImportAssemblyStepRequest& asked) {
    // Only for the items.
    v1::Assembly named;
    for (const v1::PartAnnotation& part : asked.annotations().parts()) {
      named.add_parts()->set_item(part.item());
    }
    MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyBundle used, FreezeNow(named));
    MORTISE_ASSIGN_OR_RETURN(const parametric::TemplateBundle items, UsedBy(used));
    const absl::StatusOr<Drawing> read = drawings_.Read(asked.step(), asked.drawing());
    if (absl::IsInvalidArgument(read.status())) {
      return Together(read.status(),
                      parametric::ToStatus(CheckWithoutDrawing(asked.annotations(), items.items)));
    }
    MORTISE_RETURN_IF_ERROR(read.status());
    const cad::StepAssembly& drawing = **read;
    DrawnAssembly drawn = MakeAssembly(drawing, asked.annotations(), items.items);
    MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, FreezeNow(drawn.assembly));
    AddNewShapes(drawing, bundle);
    const absl::StatusOr<templates::Parametrization> made = Parametrize(call, bundle);
    MORTISE_RETURN_IF_ERROR(AtRequest(drawn, asked.annotations(), made.status()));
    const std::string held = NoteOnHeldSizes((*made)->HeldSizes());
    if (!held.empty()) drawn.notes.push_back(held);
    return Imported{std::move(bundle), std::move(drawn.notes)};
  }

  // Adds those of the drawing's shapes that parts have and that are not stored yet.
  static void AddNewShapes(const cad::StepAssembly& drawing, v1::AssemblyBundle& bundle) {
    std::set<std::string> missing;
    for (const v1::AssemblyPart& part : bundle.assembly().parts()) missing.insert(part.shape());
    for (const v1::Shape& shape : bundle.shapes()) missing.erase(shape.name());
    for (const mesh::DrawnShape& shape : drawing.shapes) {
      if (missing.erase(shape.name) != 0) *bundle.add_shapes() = NamedShape(shape);
    }
  }

  // Parametrised now, once for all who ask, or before.
  absl::StatusOr<Found> Find(const rpc::Call& call, const std::string& name, int64_t revision) {
    MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, Get(name, revision));
    const auto add_shapes = [this](v1::AssemblyBundle& needed) {
      return store_->Read([&](store::ReadTransaction& transaction) {
        return AddShapes(transaction, needed.assembly(), needed.items(), *needed.mutable_shapes());
      });
    };
    MORTISE_ASSIGN_OR_RETURN(templates::Parametrization parametrized,
                             parametrized_->Get(
                                 bundle, [&call] { return call.cancelled(); }, add_shapes));
    return Found{std::move(bundle), std::move(parametrized)};
  }

  // Whether a design can be made of it; kept for who asks for it next.
  absl::StatusOr<templates::Parametrization> Parametrize(const rpc::Call& call,
                                                         const v1::AssemblyBundle& bundle) {
    return parametrized_->Get(bundle, [&call] { return call.cancelled(); });
  }

  // What a request is about. Everything that is wrong with it is told, as it is by the two below.
  absl::StatusOr<Chosen> ChooseFor(const rpc::Call& call, const v1::AdjustAssemblyRequest& asked) {
    const absl::Status count = CheckDemandCount(asked.demands());
    absl::StatusOr<Found> found = Find(call, asked.name(), asked.revision());
    if (!found.ok()) return Together(count, found.status());
    absl::StatusOr<Eigen::VectorXd> from = AskedParameters(asked.q(), *found->parametrized, "q");
    const absl::Status demands = CheckDemands(*found->parametrized, asked.demands());
    MORTISE_RETURN_IF_ERROR(Together(count, Together(from.status(), demands)));
    return Chosen{*std::move(found), *std::move(from)};
  }

  absl::StatusOr<ChosenPoints> ChooseFor(const rpc::Call& call,
                                         const v1::EvaluateAssemblyRequest& asked) {
    const absl::Status count = CheckCount("points", asked.points_size());
    absl::StatusOr<Found> found = Find(call, asked.name(), asked.revision());
    if (!found.ok()) return Together(count, found.status());
    absl::StatusOr<std::vector<Eigen::VectorXd>> points =
        AskedPoints(asked.points(), *found->parametrized);
    MORTISE_RETURN_IF_ERROR(Together(count, points.status()));
    return ChosenPoints{*std::move(found), *std::move(points)};
  }

  absl::StatusOr<Chosen> ChooseFor(const rpc::Call& call, const v1::ExportAssemblyRequest& asked) {
    const absl::Status format = KindOf(asked.format()).status();
    absl::StatusOr<Found> found = Find(call, asked.name(), asked.revision());
    if (!found.ok()) return Together(format, found.status());
    absl::StatusOr<Eigen::VectorXd> q = AskedParameters(asked.q(), *found->parametrized, "q");
    const absl::Status pose = CheckRestPose(found->parametrized->assembly(), asked.rest_pose());
    MORTISE_RETURN_IF_ERROR(Together(format, Together(q.status(), pose)));
    return Chosen{*std::move(found), *std::move(q)};
  }

  absl::StatusOr<v1::AdjustedAssembly> Adjust(const rpc::Call& call,
                                              const v1::AdjustAssemblyRequest& asked) {
    MORTISE_ASSIGN_OR_RETURN(const Chosen chosen, ChooseFor(call, asked));
    const Found& found = chosen.found;
    MORTISE_ASSIGN_OR_RETURN(const std::vector<parametric::MeasureDemand> demands,
                             parametric::FromProto(asked.demands()));
    const auto policy =
        asked.strict() ? parametric::DemandPolicy::kStrict : parametric::DemandPolicy::kNearest;
    MORTISE_ASSIGN_OR_RETURN(const parametric::Adjustment adjusted,
                             found.parametrized->Adjust(chosen.q, demands, policy));
    MORTISE_ASSIGN_OR_RETURN(v1::AdjustedAssembly answer, Evaluate(found, adjusted.q, "q"));
    answer.mutable_reached()->Add(adjusted.reached.begin(), adjusted.reached.end());
    return answer;
  }

  absl::Status Export(const rpc::Call& call, const v1::ExportAssemblyRequest& asked,
                      const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
    MORTISE_ASSIGN_OR_RETURN(const Chosen chosen, ChooseFor(call, asked));
    const auto& [found, q] = chosen;
    MORTISE_RETURN_IF_ERROR(Evaluate(found, q, "q").status());
    MORTISE_ASSIGN_OR_RETURN(const parametric::TemplateBundle bundle, UsedBy(found.bundle));
    const parametric::EvaluatedDesign design =
        parametric::DesignAt(*found.parametrized, q, bundle.items, bundle.materials);
    return StreamAssembly({*found.parametrized, q, design, asked.rest_pose()}, asked.format(),
                          asked.name().substr(asked.name().find('/') + 1),
                          found.bundle.assembly().title(), writer);
  }

  static absl::StatusOr<parametric::TemplateBundle> UsedBy(const v1::AssemblyBundle& bundle) {
    parametric::TemplateBundle used;
    for (const v1::Item& message : bundle.items()) {
      MORTISE_ASSIGN_OR_RETURN(parametric::Item item, parametric::FromProto(message));
      used.items.push_back(std::move(item));
    }
    for (const v1::Material& message : bundle.materials()) {
      MORTISE_ASSIGN_OR_RETURN(parametric::Material material, parametric::FromProto(message));
      used.materials.push_back(std::move(material));
    }
    return used;
  }

  store::Store* const store_;
  store::BlobFolder* const blobs_;
  rpc::Endpoint endpoint_;
  const std::shared_ptr<ParametrizationCache> parametrized_;
  DrawingSource drawings_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeAssemblyService(
    const rpc::ServiceEnvironment& environment, store::BlobFolder* blobs,
    std::shared_ptr<ParametrizationCache> parametrized) {
  return std::make_shared<AssemblyAdapter>(environment, blobs, std::move(parametrized));
}

}  // namespace mortise::catalog
