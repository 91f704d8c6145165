#include "services/pareto/service/front_methods.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "common/host/chunk_stream.h"
#include "services/pareto/front/front_files.h"
#include "services/pareto/service/front_cache.h"
#include "services/pareto/service/front_queries.h"
#include "services/pareto/service/front_records.h"

namespace mortise::pareto::methods {
namespace {

// Lists show fronts without their points, and so do the results of operations.
v1::Front Summary(v1::Front front) {
  front.clear_points();
  return front;
}

// Whether a list can be of the fronts of this subject.
absl::Status CheckSubject(const std::string& subject) {
  if (subject.empty()) return absl::OkStatus();
  const char* const collection =
      absl::StartsWith(subject, "evaluators/") ? "evaluators" : "templates";
  if (ParseResourceName(subject, collection, "subject").ok()) return absl::OkStatus();
  return InvalidField("subject", "must have the form templates/{id} or evaluators/{id}");
}

// Whether a list can be of fronts in these states.
absl::Status CheckStates(const v1::ListFrontsRequest& asked) {
  constexpr int kStates = v1::Front::State_ARRAYSIZE - 1;  // but the unspecified one
  if (asked.states_size() > kStates) {
    return InvalidField("states", absl::StrCat("has ", asked.states_size(), " entries; there are ",
                                               kStates, " states"));
  }
  std::vector<FieldViolation> violations;
  for (int i = 0; i < asked.states_size(); ++i) {
    const v1::Front::State state = asked.states(i);
    if (v1::Front::State_IsValid(state) && state != v1::Front::STATE_UNSPECIFIED) continue;
    violations.push_back({absl::StrCat("states[", i, "]"), "must be a state of fronts"});
  }
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

bool Matches(const v1::ListFrontsRequest& asked, const v1::Front& front) {
  const auto is_reason = [&](int state) {
    return front.stop_reason() == v1::Front::State_Name(static_cast<v1::Front::State>(state));
  };
  return (asked.subject().empty() || front.specification().subject() == asked.subject()) &&
         (asked.states().empty() ||
          std::any_of(asked.states().begin(), asked.states().end(), is_reason));
}

absl::StatusOr<std::shared_ptr<const OpenFront>> Explored(const Pareto& pareto,
                                                          const std::string& name) {
  return pareto.explored->Find(name, [&] { return kFronts.Get(*pareto.store, name); });
}

}  // namespace

absl::StatusOr<v1::Front> GetFront(const Pareto& pareto, const rpc::Call&,
                                   const v1::GetFrontRequest& asked) {
  return kFronts.Get(*pareto.store, asked.name());
}

absl::StatusOr<v1::ListFrontsResponse> ListFronts(const Pareto& pareto, const rpc::Call&,
                                                  const v1::ListFrontsRequest& asked) {
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      CombineViolations(resources::ReadPageQuery(asked).status(),
                        CombineViolations(CheckSubject(asked.subject()), CheckStates(asked))),
      resources::ResourceFilter::Of(asked).status()));
  const auto matches = [&asked](const v1::Front& front) { return Matches(asked, front); };
  MORTISE_ASSIGN_OR_RETURN(auto page, kFronts.List(*pareto.store, asked, matches, Summary));
  return resources::ToResponse(std::move(page), &v1::ListFrontsResponse::mutable_fronts);
}

absl::StatusOr<v1::Front> UpdateFront(const rpc::Call& call, const v1::UpdateFrontRequest& asked,
                                      store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(
      v1::Front front, kFronts.UpdateTags(transaction, asked.front(), asked.update_mask(), "front",
                                          rpc::AuthorOf(call)));
  return Summary(std::move(front));
}

absl::StatusOr<v1::PickPointResponse> PickPoint(const Pareto& pareto, const rpc::Call&,
                                                const v1::PickPointRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const auto front, Explored(pareto, asked.name()));
  return Pick(*front, asked);
}

absl::StatusOr<v1::RestrictFrontResponse> RestrictFront(const Pareto& pareto, const rpc::Call&,
                                                        const v1::RestrictFrontRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const auto front, Explored(pareto, asked.name()));
  return Restrict(*front, asked);
}

absl::Status ExportFront(const Pareto& pareto, const rpc::Call&,
                         const v1::ExportFrontRequest& asked,
                         const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  MORTISE_ASSIGN_OR_RETURN(const v1::Front front, kFronts.Get(*pareto.store, asked.name()));
  const std::string stem = absl::StrCat("front-", asked.name().substr(asked.name().find('/') + 1));
  switch (asked.format()) {
    case v1::ExportFrontRequest::CSV:
      rpc::StreamBytes(FrontAsCsv(front), {absl::StrCat(stem, ".csv"), "text/csv"}, writer);
      return absl::OkStatus();
    case v1::ExportFrontRequest::JSON: {
      MORTISE_ASSIGN_OR_RETURN(std::string json, FrontAsJson(front));
      rpc::StreamBytes(std::move(json), {absl::StrCat(stem, ".json"), "application/json"}, writer);
      return absl::OkStatus();
    }
    case v1::ExportFrontRequest::SVG: {
      MORTISE_ASSIGN_OR_RETURN(std::string svg, FrontAsSvg(front));
      rpc::StreamBytes(std::move(svg), {absl::StrCat(stem, ".svg"), "image/svg+xml"}, writer);
      return absl::OkStatus();
    }
    case v1::ExportFrontRequest::PNG: {
      MORTISE_ASSIGN_OR_RETURN(std::string png, FrontAsPng(front));
      rpc::StreamBytes(std::move(png), {absl::StrCat(stem, ".png"), "image/png"}, writer);
      return absl::OkStatus();
    }
    default:
      return InvalidField("format", "must be CSV, JSON, SVG or PNG");
  }
}

}  // namespace mortise::pareto::methods
