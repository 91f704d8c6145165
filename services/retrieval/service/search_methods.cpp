#include "services/retrieval/service/search_methods.h"

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/resources/resource_filter.h"
#include "services/retrieval/families/design_surface.h"
#include "services/retrieval/families/match_sheet.h"
#include "services/retrieval/service/match_fits.h"
#include "services/retrieval/service/query_shape.h"
#include "services/retrieval/service/template_names.h"

namespace mortise::retrieval::methods {
namespace {

constexpr int kDefaultLimit = 10;
constexpr int kMaxLimit = 100;
constexpr int kMaxDrawn = 15;  // matches on a sheet
constexpr int kDegreesOfTurn = 90;

absl::Status CheckSearch(const v1::SearchShapesRequest& request) {
  absl::Status status;
  if (request.limit() < 0 || request.limit() > kMaxLimit) {
    status = InvalidField("limit", absl::StrCat("must be 0 to ", kMaxLimit));
  } else if (request.fit() && request.limit() > kMostFits) {
    status = InvalidField("limit", absl::StrCat("must be 0 to ", kMostFits, " with fit"));
  }
  status = Together(status, CheckTemplateNames(request.templates()));
  return Together(status, resources::ResourceFilter::Of(request).status());
}

// The templates that may be found; nothing where all may.
absl::StatusOr<std::optional<std::set<std::string>>> AllowedOf(
    const v1::SearchShapesRequest& request, const Retrieval& retrieval, const rpc::Origin& origin) {
  std::optional<std::set<std::string>> allowed;
  if (!request.templates().empty()) {
    allowed.emplace(request.templates().begin(), request.templates().end());
  }
  if (!request.has_filter()) return allowed;
  MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::Template> templates,
                           retrieval.templates.List(request.filter(), origin));
  std::set<std::string> met;
  for (const v1::Template& each : templates) {
    if (!allowed || allowed->contains(each.name())) met.insert(each.name());
  }
  return std::optional(std::move(met));
}

// The match of a family, with the parameters of the primitive that is nearest.
absl::StatusOr<v1::ShapeMatch> MatchOf(const IndexMatch& found, const LoadedIndex& index,
                                       const Retrieval& retrieval, const rpc::Origin& origin) {
  const v1::ShapeIndex::Family& family = index.record.families(found.family);
  v1::ShapeMatch match;
  match.set_template_(family.template_());
  match.set_template_revision(family.template_revision());
  match.set_distance(found.distance);
  match.set_turn(kDegreesOfTurn * found.turn);
  MORTISE_ASSIGN_OR_RETURN(
      const std::shared_ptr<const CompiledTemplate> compiled,
      retrieval.templates.Get(match.template_(), match.template_revision(), origin));
  match.set_title(compiled->title);
  const Primitive primitive = index.primitives.PrimitiveOf(found);
  const std::vector<parametric::Parameter>& parameters = compiled->function->parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    v1::ParameterValue& value = *match.add_parameters();
    value.set_name(parameters[i].name);
    value.set_value(primitive.parameters[static_cast<Eigen::Index>(i)]);
  }
  return match;
}

absl::StatusOr<mesh::SurfaceMesh> SurfaceOf(const v1::ShapeMatch& match, const Retrieval& retrieval,
                                            const rpc::Origin& origin) {
  MORTISE_ASSIGN_OR_RETURN(
      const std::shared_ptr<const CompiledTemplate> compiled,
      retrieval.templates.Get(match.template_(), match.template_revision(), origin));
  Eigen::VectorXd q(match.parameters_size());
  for (int i = 0; i < match.parameters_size(); ++i) q[i] = match.parameters(i).value();
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design,
                           compiled->function->Evaluate(q));
  return DesignSurface(design);
}

std::string CaptionOf(const QueryShape& query) {
  return query.title.empty() ? "query" : absl::StrCat("query: ", query.title);
}

absl::StatusOr<std::string> DrawSheet(const QueryShape& query,
                                      const v1::SearchShapesResponse& response,
                                      const Retrieval& retrieval, const rpc::Origin& origin) {
  std::vector<SheetEntry> entries = {{query.surface, CaptionOf(query)}};
  for (const v1::ShapeMatch& match : response.matches()) {
    if (entries.size() > kMaxDrawn) break;
    MORTISE_ASSIGN_OR_RETURN(mesh::SurfaceMesh surface, SurfaceOf(match, retrieval, origin));
    entries.push_back({std::move(surface), absl::StrFormat("%s: %.3g", match.template_().substr(10),
                                                           match.distance())});
  }
  return DrawMatchSheet(entries);
}

}  // namespace

absl::StatusOr<v1::SearchShapesResponse> SearchShapes(const Retrieval& retrieval,
                                                      const rpc::Call& call,
                                                      const v1::SearchShapesRequest& request) {
  const rpc::Origin origin = rpc::ForwardedFrom(call);
  const absl::Status checked = CheckSearch(request);
  absl::StatusOr<QueryShape> query = ReadQuery(request, retrieval.templates, origin);
  MORTISE_RETURN_IF_ERROR(Together(checked, query.status()));
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const LoadedIndex> index,
                           retrieval.indexes.Get(request.shape_descriptor()));
  MORTISE_ASSIGN_OR_RETURN(const std::optional<std::set<std::string>> allowed,
                           AllowedOf(request, retrieval, origin));
  const absl::StatusOr<Eigen::VectorXd> described = index->descriptor->Describe(query->surface);
  if (!described.ok()) {
    return UnderField(request.has_mesh() ? "mesh" : "design", described.status());
  }
  IndexQuery wanted;
  wanted.count = request.limit() == 0 ? kDefaultLimit : request.limit();
  for (const auto& turned : index->descriptor->QuarterTurns(*described).colwise()) {
    wanted.descriptors.emplace_back(turned);
  }
  if (allowed) {
    wanted.allowed = [&](int family) {
      return allowed->contains(index->record.families(family).template_());
    };
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<IndexMatch> found, index->primitives.Nearest(wanted));
  v1::SearchShapesResponse response;
  for (const IndexMatch& each : found) {
    MORTISE_ASSIGN_OR_RETURN(*response.add_matches(), MatchOf(each, *index, retrieval, origin));
  }
  for (std::string& note : query->notes) response.add_notes(std::move(note));
  if (!index->record.current()) {
    response.add_notes("Templates have changed since the index was built.");
  }
  if (!index->record.every_template()) {
    response.add_notes("The index has only the templates that it was built of.");
  }
  response.set_shape_descriptor(index->record.shape_descriptor());
  response.set_families(index->record.family_count());
  std::vector<FitSheetEntry> fitted;
  if (request.fit()) {
    MORTISE_ASSIGN_OR_RETURN(fitted, FitMatches({*query, wanted.descriptors, *index, found},
                                                retrieval.templates, origin, call, &response));
  }
  if (request.with_sheet()) {
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sheet(),
                             fitted.empty()
                                 ? DrawSheet(*query, response, retrieval, origin)
                                 : DrawFitSheet({query->surface, CaptionOf(*query)}, fitted));
  }
  return response;
}

}  // namespace mortise::retrieval::methods
