#include "services/catalog/service/parametrization_methods.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/assembly_design.h"
#include "common/assembly/codec/parametrization_codec.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "services/catalog/service/assembly_reading.h"
#include "services/catalog/service/design_stream.h"
#include "services/catalog/service/request_demands.h"
#include "services/catalog/service/request_parameters.h"

namespace mortise::catalog::methods {
namespace {

constexpr int kMaxDesigns = 1000;  // in one answer

// Where to look at an assembly.
struct Chosen {
  ParametrizedAssembly found;
  Eigen::VectorXd q;
};

struct ChosenPoints {
  ParametrizedAssembly found;
  std::vector<Eigen::VectorXd> points;
};

absl::Status CheckCount(const char* field, int count) {
  if (count >= 1 && count <= kMaxDesigns) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("must be 1 to ", kMaxDesigns));
}

absl::StatusOr<v1::AdjustedAssembly> Evaluate(const ParametrizedAssembly& found,
                                              const Eigen::VectorXd& q, const std::string& field) {
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
void StreamDesigns(ParametrizedAssembly found, std::vector<Eigen::VectorXd> parameters,
                   const std::string& list_field, const AdjustedWriter& writer) {
  struct Source {
    ParametrizedAssembly found;
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

// What a request is about. Everything that is wrong with it is told, as it is by the two below.
absl::StatusOr<Chosen> ChooseFor(Catalog& catalog, const rpc::Call& call,
                                 const v1::AdjustAssemblyRequest& asked) {
  const absl::Status count = CheckDemandCount(asked.demands());
  absl::StatusOr<ParametrizedAssembly> found =
      FindParametrized(catalog, call, asked.name(), asked.revision());
  if (!found.ok()) return CombineViolations(count, found.status());
  absl::StatusOr<Eigen::VectorXd> from = RequestParameters(asked.q(), *found->parametrized, "q");
  const absl::Status demands = CheckDemands(*found->parametrized, asked.demands());
  MORTISE_RETURN_IF_ERROR(CombineViolations(count, CombineViolations(from.status(), demands)));
  return Chosen{*std::move(found), *std::move(from)};
}

absl::StatusOr<ChosenPoints> ChooseFor(Catalog& catalog, const rpc::Call& call,
                                       const v1::EvaluateAssemblyRequest& asked) {
  const absl::Status count = CheckCount("points", asked.points_size());
  absl::StatusOr<ParametrizedAssembly> found =
      FindParametrized(catalog, call, asked.name(), asked.revision());
  if (!found.ok()) return CombineViolations(count, found.status());
  absl::StatusOr<std::vector<Eigen::VectorXd>> points =
      RequestPoints(asked.points(), *found->parametrized);
  MORTISE_RETURN_IF_ERROR(CombineViolations(count, points.status()));
  return ChosenPoints{*std::move(found), *std::move(points)};
}

absl::StatusOr<Chosen> ChooseFor(Catalog& catalog, const rpc::Call& call,
                                 const v1::ExportAssemblyRequest& asked) {
  const absl::Status format = KindOf(asked.format()).status();
  absl::StatusOr<ParametrizedAssembly> found =
      FindParametrized(catalog, call, asked.name(), asked.revision());
  if (!found.ok()) return CombineViolations(format, found.status());
  absl::StatusOr<Eigen::VectorXd> q = RequestParameters(asked.q(), *found->parametrized, "q");
  const absl::Status pose = CheckRestPose(found->parametrized->assembly(), asked.rest_pose());
  MORTISE_RETURN_IF_ERROR(CombineViolations(format, CombineViolations(q.status(), pose)));
  return Chosen{*std::move(found), *std::move(q)};
}

}  // namespace

absl::StatusOr<v1::Parametrization> ParametrizeAssembly(
    Catalog& catalog, const rpc::Call& call, const v1::ParametrizeAssemblyRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const ParametrizedAssembly found,
                           FindParametrized(catalog, call, asked.name(), asked.revision()));
  MORTISE_ASSIGN_OR_RETURN(v1::Parametrization described, parametric::ToProto(*found.parametrized));
  described.set_assembly(found.bundle.assembly().name());
  described.set_revision(found.bundle.assembly().revision());
  return described;
}

absl::StatusOr<v1::AdjustedAssembly> AdjustAssembly(Catalog& catalog, const rpc::Call& call,
                                                    const v1::AdjustAssemblyRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const Chosen chosen, ChooseFor(catalog, call, asked));
  const ParametrizedAssembly& found = chosen.found;
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

absl::Status EvaluateAssembly(Catalog& catalog, const rpc::Call& call,
                              const v1::EvaluateAssemblyRequest& asked,
                              const AdjustedWriter& writer) {
  MORTISE_ASSIGN_OR_RETURN(ChosenPoints chosen, ChooseFor(catalog, call, asked));
  StreamDesigns(std::move(chosen.found), std::move(chosen.points), "points", writer);
  return absl::OkStatus();
}

absl::Status SampleAssembly(Catalog& catalog, const rpc::Call& call,
                            const v1::SampleAssemblyRequest& asked, const AdjustedWriter& writer) {
  absl::StatusOr<ParametrizedAssembly> found =
      FindParametrized(catalog, call, asked.name(), asked.revision());
  MORTISE_RETURN_IF_ERROR(CombineViolations(CheckCount("count", asked.count()), found.status()));
  MORTISE_ASSIGN_OR_RETURN(std::vector<Eigen::VectorXd> samples,
                           found->parametrized->Sample(asked.count(), asked.seed()));
  StreamDesigns(*std::move(found), std::move(samples), "samples", writer);
  return absl::OkStatus();
}

absl::Status ExportAssembly(Catalog& catalog, const rpc::Call& call,
                            const v1::ExportAssemblyRequest& asked,
                            const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  MORTISE_ASSIGN_OR_RETURN(const Chosen chosen, ChooseFor(catalog, call, asked));
  const auto& [found, q] = chosen;
  MORTISE_RETURN_IF_ERROR(Evaluate(found, q, "q").status());
  MORTISE_ASSIGN_OR_RETURN(const parametric::TemplateBundle bundle, UsedBy(found.bundle));
  const parametric::EvaluatedDesign design =
      parametric::DesignAt(*found.parametrized, q, bundle.items, bundle.materials);
  const DesignIdentity identity = IdentityOf(found.bundle.assembly(), found.bundle.items());
  return StreamAssembly({*found.parametrized, q, design, asked.rest_pose(), identity},
                        asked.format(), asked.name().substr(asked.name().find('/') + 1),
                        found.bundle.assembly().title(), writer);
}

absl::Status ExplainAdjustAssembly(Catalog& catalog, const rpc::Call& call,
                                   const v1::AdjustAssemblyRequest& asked) {
  return ChooseFor(catalog, call, asked).status();
}

absl::Status ExplainEvaluateAssembly(Catalog& catalog, const rpc::Call& call,
                                     const v1::EvaluateAssemblyRequest& asked) {
  return ChooseFor(catalog, call, asked).status();
}

absl::Status ExplainExportAssembly(Catalog& catalog, const rpc::Call& call,
                                   const v1::ExportAssemblyRequest& asked) {
  return ChooseFor(catalog, call, asked).status();
}

}  // namespace mortise::catalog::methods
