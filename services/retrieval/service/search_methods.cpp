#include "services/retrieval/service/search_methods.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "services/retrieval/catalog/template_names.h"
#include "services/retrieval/families/design_surface.h"
#include "services/retrieval/families/match_sheet.h"
#include "services/retrieval/service/filter_names.h"
#include "services/retrieval/service/match_designs.h"
#include "services/retrieval/service/match_fits.h"
#include "services/retrieval/service/query_shape.h"
#include "services/retrieval/service/search_filter.h"

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
  } else if (request.fit() && request.limit() > kMaxFits) {
    status = InvalidField("limit", absl::StrCat("must be 0 to ", kMaxFits, " with fit"));
  }
  return status;
}

// The match of a family, with the parameters of the primitive that is nearest.
absl::StatusOr<v1::ShapeMatch> MatchOf(const IndexMatch& found, const LoadedIndex& index) {
  const v1::ShapeIndex::Family& family = index.record.families(found.family);
  v1::ShapeMatch match;
  match.set_template_(family.template_());
  match.set_template_revision(family.template_revision());
  match.set_group(family.group());
  match.set_title(family.title());
  match.set_distance(found.distance);
  match.set_turn(kDegreesOfTurn * found.turn);
  const Primitive primitive = index.primitives.PrimitiveOf(found);
  if (primitive.parameters.size() != family.parameters_size()) {
    return StorageFailed(index.record.name(),
                         absl::StrCat(family.template_(), " has other parameters in its cover"));
  }
  for (int i = 0; i < family.parameters_size(); ++i) {
    v1::ParameterValue& value = *match.add_parameters();
    value.set_name(family.parameters(i));
    value.set_value(primitive.parameters[i]);
  }
  return match;
}

std::string CaptionOf(const QueryShape& query) {
  return query.title.empty() ? "query" : absl::StrCat("query: ", query.title);
}

absl::StatusOr<std::string> DrawSheet(const QueryShape& query, const std::vector<IndexMatch>& found,
                                      const LoadedIndex& index, const Retrieval& retrieval,
                                      const rpc::Origin& origin) {
  std::vector<SheetEntry> entries = {{query.surface, CaptionOf(query)}};
  for (const IndexMatch& match : found) {
    if (entries.size() > kMaxDrawn) break;
    const absl::StatusOr<MatchDesign> made = DesignOf(match, index, retrieval.templates, origin);
    if (IsPassingFailure(made.status())) return made.status();
    if (!made.ok()) continue;  // its template has been deleted meanwhile
    const v1::ShapeIndex::Family& family = index.record.families(match.family);
    entries.push_back({DesignSurface(made->design),
                       absl::StrFormat("%s: %.3g", ShownName(family.template_(), family.group()),
                                       match.distance)});
  }
  return DrawMatchSheet(entries);
}

// The descriptors of the query, one for each turn that is compared, and which families may match.
absl::StatusOr<IndexQuery> IndexQueryOf(const v1::SearchShapesRequest& request,
                                        const QueryShape& query, const LoadedIndex& index,
                                        const SearchFilter& filter) {
  const absl::StatusOr<Eigen::VectorXd> described = index.descriptor->Describe(query.surface);
  if (!described.ok()) {
    return UnderField(request.has_mesh() ? "mesh" : "design", described.status());
  }
  IndexQuery wanted;
  wanted.count = request.limit() == 0 ? kDefaultLimit : request.limit();
  const Eigen::MatrixXd turns = index.descriptor->QuarterTurns(*described);
  for (const auto& turned : turns.colwise()) wanted.descriptors.emplace_back(turned);
  wanted.allowed = [&](int family) { return MayBeFound(filter, index.record.families(family)); };
  return wanted;
}

// The nearest families that may be found, and how many designs were looked at for that.
absl::StatusOr<FilteredMatches> FindMatches(const DesignFilter& filter, IndexQuery wanted,
                                            const LoadedIndex& index, MatchFacts& facts,
                                            const rpc::Call& call, FilterTally* tally) {
  if (!IsEmpty(filter)) {
    return NearestThatMeet(filter, std::move(wanted), index, facts, call, tally);
  }
  FilteredMatches found;
  MORTISE_ASSIGN_OR_RETURN(found.matches, index.primitives.Nearest(wanted));
  return found;
}

void AddNotes(const QueryShape& query, const LoadedIndex& index, const FilteredMatches& found,
              v1::SearchShapesResponse* response) {
  for (const std::string& note : query.notes) response->add_notes(note);
  if (!index.record.current()) {
    response->add_notes("Templates have changed since the index was built.");
  }
  if (!index.record.every_template()) {
    response->add_notes("The index has only the templates that it was built of.");
  }
  if (found.ended_early) {
    response->add_notes(absl::StrCat(
        "The search ended after ", found.looked_at,
        " designs were looked at for what the filter asks: others that meet it may be further "
        "away. What was looked at is known for a while: the same search soon gets further."));
  }
}

}  // namespace

absl::StatusOr<v1::SearchShapesResponse> SearchShapes(const Retrieval& retrieval,
                                                      const rpc::Call& call,
                                                      const v1::SearchShapesRequest& request) {
  const rpc::Origin origin = rpc::ForwardedFrom(call);
  const absl::StatusOr<SearchFilter> filter = ReadSearchFilter(request);
  const absl::Status checked = CombineViolations(CheckSearch(request), filter.status());
  const absl::StatusOr<QueryShape> query = ReadQuery(request, retrieval, origin);
  MORTISE_RETURN_IF_ERROR(CombineViolations(checked, query.status()));
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const LoadedIndex> index,
                           retrieval.indexes.Get(request.shape_descriptor()));
  MORTISE_RETURN_IF_ERROR(CheckFilterNames(request, index->record, retrieval.templates, origin));
  MORTISE_ASSIGN_OR_RETURN(IndexQuery wanted, IndexQueryOf(request, *query, *index, *filter));
  const std::vector<Eigen::VectorXd> turned = wanted.descriptors;
  FilterTally tally;
  MORTISE_ASSIGN_OR_RETURN(
      const FilteredMatches found,
      FindMatches(filter->design, std::move(wanted), *index, retrieval.facts, call, &tally));
  v1::SearchShapesResponse response;
  for (const IndexMatch& each : found.matches) {
    MORTISE_ASSIGN_OR_RETURN(*response.add_matches(), MatchOf(each, *index));
  }
  AddNotes(*query, *index, found, &response);
  if (found.matches.empty()) {
    response.add_notes(WhyNothingIsFound(*filter, index->record, tally, found.looked_at));
  }
  response.set_shape_descriptor(index->record.shape_descriptor());
  response.set_families(index->record.family_count());
  response.set_designs_looked_at(found.looked_at);
  response.set_ended_early(found.ended_early);
  std::vector<FitEntry> fitted;
  if (request.fit()) {
    MORTISE_ASSIGN_OR_RETURN(fitted, FitMatches({*query, turned, *index, found.matches},
                                                retrieval.templates, origin, call, &response));
  }
  if (request.with_sheet()) {
    MORTISE_ASSIGN_OR_RETURN(*response.mutable_sheet(),
                             fitted.empty()
                                 ? DrawSheet(*query, found.matches, *index, retrieval, origin)
                                 : DrawFitSheet({query->surface, CaptionOf(*query)}, fitted));
  }
  return response;
}

}  // namespace mortise::retrieval::methods
