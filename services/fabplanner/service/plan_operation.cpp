#include "services/fabplanner/service/plan_operation.h"

#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/time_util.h>
#include <grpcpp/channel.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/base/violation_lists.h"
#include "common/host/operation_codec.h"
#include "common/resources/resource_tags.h"
#include "common/rpc/channel.h"
#include "common/store/blob_folder.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "services/fabplanner/documents/part_drawing.h"
#include "services/fabplanner/documents/part_labels.h"
#include "services/fabplanner/documents/plan_files.h"
#include "services/fabplanner/planning/bill_tree.h"
#include "services/fabplanner/planning/nearest_parameters.h"
#include "services/fabplanner/planning/part_making.h"
#include "services/fabplanner/planning/planning.h"
#include "services/fabplanner/service/design_codec.h"
#include "services/fabplanner/shop_floor/order_records.h"
#include "services/fabplanner/shop_floor/plan_codec.h"
#include "services/fabplanner/shop_floor/plan_records.h"

namespace mortise::fabplanner {
namespace {

// Whether there is no such design, rather than that the catalog cannot be asked.
bool IsOfDesign(const absl::Status& status) {
  return absl::IsNotFound(status) || absl::IsInvalidArgument(status) ||
         absl::IsOutOfRange(status) || absl::IsFailedPrecondition(status) ||
         absl::IsUnimplemented(status);
}

constexpr absl::Duration kCatalogTimeout = absl::Minutes(2);
constexpr std::size_t kMaxExport = 256u << 20;  // bytes

// Whether it is not the design that is at fault.
bool MayPass(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsDeadlineExceeded(status) ||
         absl::IsAborted(status) || absl::IsCancelled(status);
}

// "operations/fabplanner/abc" names "plans/abc".
std::string PlanIdOf(const std::string& operation_name) {
  return operation_name.substr(operation_name.rfind('/') + 1);
}

v1::EvaluateTemplateRequest EvaluationOf(const v1::CreatePlanRequest& request) {
  v1::EvaluateTemplateRequest evaluate;
  evaluate.set_name(request.template_());
  evaluate.set_revision(request.template_revision());
  *evaluate.mutable_parameters() = request.parameters();
  return evaluate;
}

absl::Status StorePlan(store::Transaction& transaction, v1::Plan* plan) {
  *plan->mutable_create_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
      absl::ToUnixMicros(transaction.Now()));
  MORTISE_RETURN_IF_ERROR(CreatePlanRecords(transaction, *plan));
  const nlohmann::json json = {
      {"template", plan->template_()},   {"quantity", plan->quantity()},
      {"boards", plan->boards_size()},   {"sheets", plan->sheets_size()},
      {"total", plan->total().amount()}, {"currency", plan->total().currency()}};
  return transaction.AppendEvent({.type = "plan.created",
                                  .subject = plan->name(),
                                  .payload = json.dump(),
                                  .trace_id = CurrentTraceId()});
}

// Empty if there is no such plan.
absl::StatusOr<std::string> FindStored(const std::string& id,
                                       operations::OperationContext& context) {
  std::string stored;
  MORTISE_RETURN_IF_ERROR(context.Transact([&](store::Transaction& transaction) -> absl::Status {
    const absl::StatusOr<store::Record> record = transaction.Get(kPlans.kind, id);
    if (record.ok()) stored = record->payload;
    return absl::IsNotFound(record.status()) ? absl::OkStatus() : record.status();
  }));
  return stored;
}

struct PlannedDesign {
  Design design;
  Items items;
  FabricationPlan plan;
};

absl::StatusOr<PlannedDesign> PlanDesign(const v1::CreatePlanRequest& request,
                                         const v1::EvaluatedDesign& evaluated,
                                         const v1::TemplateBundle& bundle,
                                         operations::OperationContext& context) {
  PlannedDesign planned;
  MORTISE_ASSIGN_OR_RETURN(planned.design, DesignFrom(evaluated));
  AddDrawing(bundle.assembly(), &planned.design);
  MORTISE_ASSIGN_OR_RETURN(planned.items, ItemsFrom(bundle));
  context.ReportProgress({.total = 0, .message = "laying out boards and sheets"});
  const int quantity = request.has_quantity() ? request.quantity() : 1;
  MORTISE_ASSIGN_OR_RETURN(
      planned.plan, MakePlan(planned.design, planned.items, quantity, RulesFrom(request.rules()),
                             context.stop_token()));
  return planned;
}

bool HasLimits(const FabricationPlan& plan) {
  return std::any_of(plan.parts.begin(), plan.parts.end(),
                     [](const PlannedPart& part) { return !part.beyond_machines.empty(); });
}

// The template's parameters with the values that the design has.
std::vector<DesignParameter> ParametersOf(const v1::Template& origin,
                                          const v1::EvaluatedDesign& design) {
  std::map<std::string, double> values;
  for (const v1::ParameterValue& value : design.parameters()) values[value.name()] = value.value();
  std::vector<DesignParameter> parameters;
  for (const v1::Parameter& parameter : origin.parameters()) {
    const auto value = values.find(parameter.name());
    if (value == values.end()) continue;
    parameters.push_back({parameter.name(),
                          parameter.unit(),
                          parameter.minimum(),
                          parameter.maximum(),
                          parameter.step(),
                          value->second,
                          {parameter.choices().begin(), parameter.choices().end()}});
  }
  return parameters;
}

struct DrawnFiles {
  std::vector<PlanFile> files;
  int total = 1;  // of the progress that was told
};

absl::StatusOr<DrawnFiles> DrawFiles(const PlannedDesign& planned, const PlanNames& names,
                                     operations::OperationContext& context) {
  DrawnFiles drawn;
  const auto tell = [&](int done, int total) {
    drawn.total = total;
    context.ReportProgress({.done = done, .total = total, .message = "drawing the assembly"});
    return !context.Cancelled();
  };
  MORTISE_ASSIGN_OR_RETURN(drawn.files,
                           MakePlanFiles(planned.plan, planned.design, planned.items, names, tell));
  return drawn;
}

// What the plan is of, and since when it holds: when it was asked for, so that a run repeated after
// a crash makes the same files.
BillSubject SubjectOf(const v1::TemplateBundle& bundle, const std::string& title,
                      const v1::EvaluatedDesign& evaluated, absl::Time asked_for) {
  const v1::Template& origin = bundle.template_();
  return {.template_name = evaluated.template_(),
          .template_revision = evaluated.template_revision(),
          .title = title,
          .external_ids = {origin.external_ids().begin(), origin.external_ids().end()},
          .assembly = origin.assembly().assembly(),
          .assembly_revision = origin.assembly().revision(),
          .effective_from = absl::ToUnixSeconds(asked_for)};
}

// The bill of the plan as its calls give it, and nothing else of the plan.
absl::StatusOr<PlanFile> BillAsJson(const v1::Plan& plan) {
  v1::Plan bill;
  bill.set_name(plan.name());
  bill.set_template_(plan.template_());
  bill.set_template_revision(plan.template_revision());
  bill.set_quantity(plan.quantity());
  *bill.mutable_bill() = plan.bill();
  *bill.mutable_totals() = plan.totals();
  bill.set_unpriced_lines(plan.unpriced_lines());
  *bill.mutable_bill_tree() = plan.bill_tree();
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  std::string json;
  const auto written = google::protobuf::util::MessageToJsonString(bill, &json, options);
  if (!written.ok()) {
    return absl::InternalError(absl::StrCat("the bill as JSON: ", written.ToString()));
  }
  return PlanFile{"bill.json", "application/json", std::move(json)};
}

// Without the files, the tags, the creator and the time.
v1::Plan MessageOf(const std::string& id, const PlannedDesign& planned,
                   const v1::EvaluatedDesign& evaluated) {
  v1::Plan plan = ToProto(planned.plan, planned.design);
  plan.set_name(absl::StrCat("plans/", id));
  plan.set_template_(evaluated.template_());
  plan.set_template_revision(evaluated.template_revision());
  *plan.mutable_parameters() = evaluated.parameters();
  return plan;
}

}  // namespace

absl::Status CheckTemplate(const v1::CreatePlanRequest& request) {
  const absl::Status name =
      ParseResourceName(request.template_(), "templates", "template").status();
  if (request.template_revision() >= 0) return name;
  return CombineViolations(
      name, InvalidField("template_revision", "must be a revision, or 0 for the latest"));
}

absl::Status CheckRequest(const v1::CreatePlanRequest& request) {
  absl::Status status = CheckTemplate(request);
  if (request.has_quantity() && (request.quantity() < 1 || request.quantity() > 1000)) {
    status = CombineViolations(status, InvalidField("quantity", "must be 1 to 1000"));
  }
  status = CombineViolations(status, CheckRules(RulesFrom(request.rules())));
  status = CombineViolations(status, CheckLabelAddress(request.label_address(), "label_address"));
  return CombineViolations(status, resources::ValidateTags(request));
}

absl::Status PlanOperation::CheckDesign(const v1::CreatePlanRequest& request,
                                        const rpc::Origin& origin) const {
  const auto channel = peers_->Channel("catalog");
  if (!channel.ok()) return absl::OkStatus();
  v1::CatalogService::Stub catalog(*channel);
  rpc::RetryOptions once;
  once.patience = absl::ZeroDuration();
  const absl::StatusOr<v1::EvaluatedDesign> design = rpc::CallUnary(
      catalog, &v1::CatalogService::Stub::EvaluateTemplate, EvaluationOf(request), origin, once);
  const absl::Status status = design.ok() ? DesignFrom(*design).status() : design.status();
  return IsOfDesign(status) ? status : absl::OkStatus();
}

absl::StatusOr<PlanOperation::Inputs> PlanOperation::FetchInputs(
    const v1::CreatePlanRequest& request, operations::OperationContext& context) const {
  MORTISE_ASSIGN_OR_RETURN(const auto channel, peers_->Channel("catalog"));
  const std::unique_ptr<v1::CatalogService::Stub> catalog = v1::CatalogService::NewStub(channel);
  const rpc::Origin origin =
      rpc::OwnOrigin(signer_, rpc::Role::kViewer, CurrentTraceId(), kCatalogTimeout);
  rpc::RetryOptions retry;
  retry.patience = kCatalogTimeout;  // the catalog may be starting again
  retry.stop = context.stop_token();

  Inputs inputs;
  v1::ExportDesignRequest evaluate;
  evaluate.set_name(request.template_());
  evaluate.set_revision(request.template_revision());
  *evaluate.mutable_parameters() = request.parameters();
  evaluate.set_format(v1::ExportDesignRequest::DESIGN);
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, Export(evaluate, context));
  if (!inputs.design.ParseFromString(bytes)) {
    return absl::DataLossError("the design did not arrive as the catalog sent it");
  }
  v1::GetTemplateBundleRequest get_bundle;
  get_bundle.set_name(request.template_());
  get_bundle.set_revision(inputs.design.template_revision());
  MORTISE_ASSIGN_OR_RETURN(inputs.bundle,
                           rpc::CallUnary(*catalog, &v1::CatalogService::Stub::GetTemplateBundle,
                                          get_bundle, origin, retry));
  return inputs;
}

absl::StatusOr<std::string> PlanOperation::Export(const v1::ExportDesignRequest& request,
                                                  operations::OperationContext& context) const {
  MORTISE_ASSIGN_OR_RETURN(const auto channel, peers_->Channel("catalog"));
  const std::unique_ptr<v1::CatalogService::Stub> catalog = v1::CatalogService::NewStub(channel);
  rpc::RetryOptions retry;
  retry.patience = kCatalogTimeout;  // the catalog may be starting again
  retry.stop = context.stop_token();
  std::string bytes;
  bool too_large = false;
  const absl::Status status = rpc::CallWithRetry(
      rpc::OwnOrigin(signer_, rpc::Role::kViewer, CurrentTraceId(), kCatalogTimeout), retry,
      [&](grpc::ClientContext* call) {
        // A plan that is cancelled does not wait for a large design to be written.
        const std::stop_callback stopping(context.stop_token(), [call] { call->TryCancel(); });
        bytes.clear();
        const auto chunks = catalog->ExportDesign(call, request);
        for (v1::Chunk chunk; !too_large && chunks->Read(&chunk);) {
          bytes += chunk.data();
          too_large = bytes.size() > kMaxExport;
        }
        if (too_large) call->TryCancel();
        return chunks->Finish();
      });
  if (too_large) return TooLarge("the design", "256 MiB");
  MORTISE_RETURN_IF_ERROR(status);
  return bytes;
}

absl::Status PlanOperation::FindNearestParameters(const Inputs& inputs, const Items& items,
                                                  FabricationPlan* plan,
                                                  operations::OperationContext& context) const {
  if (!HasLimits(*plan)) return absl::OkStatus();
  context.ReportProgress({.total = 0, .message = "looking for parameters that machines can make"});
  const std::vector<DesignParameter> parameters =
      ParametersOf(inputs.bundle.template_(), inputs.design);
  using Parts = std::optional<std::vector<PlannedPart>>;
  const auto parts_at = [&](std::size_t index, double value) -> absl::StatusOr<Parts> {
    if (context.Cancelled()) return absl::CancelledError("the plan was cancelled");
    v1::ExportDesignRequest request;
    request.set_name(inputs.design.template_());
    request.set_revision(inputs.design.template_revision());
    *request.mutable_parameters() = inputs.design.parameters();
    for (v1::ParameterValue& parameter : *request.mutable_parameters()) {
      if (parameter.name() != parameters[index].name) continue;
      parameter.set_value(value);
      if (const auto& choices = parameters[index].choices; !choices.empty()) {
        parameter.set_choice(choices[static_cast<std::size_t>(std::llround(value))]);
      }
    }
    request.set_format(v1::ExportDesignRequest::DESIGN);
    const absl::StatusOr<std::string> bytes = Export(request, context);
    if (IsOfDesign(bytes.status())) return Parts();
    MORTISE_RETURN_IF_ERROR(bytes.status());
    v1::EvaluatedDesign evaluated;
    if (!evaluated.ParseFromString(*bytes)) return absl::InternalError("not a design");
    // What comes apart, or runs into itself, is no cure.
    if (evaluated.faults_size() > inputs.design.faults_size()) return Parts();
    const absl::StatusOr<Design> design = DesignFrom(evaluated);
    if (!design.ok()) return Parts();
    absl::StatusOr<std::vector<PlannedPart>> parts = PlanParts(*design, items, plan->rules);
    return parts.ok() ? Parts(*std::move(parts)) : Parts();
  };
  return AddNearestParameters(parameters, parts_at, plan);
}

absl::StatusOr<std::string> PlanOperation::FetchStep(const v1::EvaluatedDesign& design,
                                                     operations::OperationContext& context) const {
  v1::ExportDesignRequest request;
  request.set_name(design.template_());
  request.set_revision(design.template_revision());
  *request.mutable_parameters() = design.parameters();
  request.set_format(v1::ExportDesignRequest::STEP);
  return Export(request, context);
}

absl::StatusOr<std::string> PlanOperation::AttachStep(const v1::EvaluatedDesign& design,
                                                      FabricationPlan* plan,
                                                      operations::OperationContext& context) const {
  if (!HasDrawings(*plan)) return "";
  absl::StatusOr<std::string> step = FetchStep(design, context);
  if (context.Cancelled()) return absl::CancelledError("the plan was cancelled");
  if (step.ok()) {
    AddToDrawings(kDesignStepFile, plan);
    return step;
  }
  if (MayPass(step.status())) return step.status();
  if (!absl::IsFailedPrecondition(step.status())) {
    plan->handwork.push_back(
        absl::StrCat("make do without ", kDesignStepFile,
                     ", which the catalog could not make: ", step.status().message()));
  }
  return "";
}

absl::Status PlanOperation::KeepFiles(const std::vector<PlanFile>& files, v1::Plan* plan) const {
  for (const PlanFile& file : files) {
    v1::Artifact* artifact = plan->add_artifacts();
    artifact->set_file_name(file.file_name);
    artifact->set_media_type(file.media_type);
    artifact->set_size(static_cast<int64_t>(file.bytes.size()));
    MORTISE_ASSIGN_OR_RETURN(*artifact->mutable_sha256(), blobs_->Put(file.bytes));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> PlanOperation::Run(operations::OperationContext& context) const {
  v1::CreatePlanRequest request;
  if (!request.ParseFromString(context.request())) {
    return StorageFailed(context.name(), "the request is not readable");
  }
  const std::string id = PlanIdOf(context.name());
  // A run that was killed after it had stored the plan has nothing more to do.
  MORTISE_ASSIGN_OR_RETURN(const std::string stored, FindStored(id, context));
  v1::Plan plan;
  if (!stored.empty() && plan.ParseFromString(stored)) return rpc::PackResult(plan);

  context.ReportProgress({.total = 0, .message = "evaluating the design"});
  MORTISE_ASSIGN_OR_RETURN(const Inputs inputs, FetchInputs(request, context));
  if (context.Cancelled()) return absl::CancelledError("the plan was cancelled");
  MORTISE_ASSIGN_OR_RETURN(PlannedDesign planned,
                           PlanDesign(request, inputs.design, inputs.bundle, context));
  MORTISE_RETURN_IF_ERROR(FindNearestParameters(inputs, planned.items, &planned.plan, context));
  MORTISE_ASSIGN_OR_RETURN(std::string step, AttachStep(inputs.design, &planned.plan, context));
  const v1::Template& origin = inputs.bundle.template_();
  const PlanNames names = {origin.title().empty() ? origin.name() : origin.title(),
                           absl::StrCat("plans/", id), request.label_address()};
  planned.plan.bill_tree = MakeBillTree(
      planned.plan, planned.design, planned.items,
      SubjectOf(inputs.bundle, names.title, inputs.design, context.operation().created_at));
  MORTISE_ASSIGN_OR_RETURN(DrawnFiles drawn, DrawFiles(planned, names, context));
  if (!step.empty()) drawn.files.push_back({kDesignStepFile, "model/step", std::move(step)});

  plan = MessageOf(id, planned, inputs.design);
  MORTISE_ASSIGN_OR_RETURN(PlanFile bill, BillAsJson(plan));
  drawn.files.push_back(std::move(bill));
  rpc::SetTagsAndCreator(context.operation(), &plan);
  MORTISE_RETURN_IF_ERROR(KeepFiles(drawn.files, &plan));
  // The files have the tree, however large it is.
  if (plan.ByteSizeLong() > kMaxMessageBytes) plan.clear_bill_tree();
  if (plan.ByteSizeLong() > kMaxMessageBytes) {
    return TooLarge(absl::StrCat("a plan of ", plan.ByteSizeLong(), " bytes"),
                    absl::StrCat(kMaxMessageBytes, " bytes; plan fewer copies at a time"));
  }
  MORTISE_RETURN_IF_ERROR(context.Transact(
      [&](store::Transaction& transaction) { return StorePlan(transaction, &plan); }));
  context.ReportProgress({.done = drawn.total, .total = drawn.total, .message = "planned"});
  return rpc::PackResult(plan);
}

}  // namespace mortise::fabplanner
