#include "services/retrieval/service/match_fits.h"

#include <algorithm>
#include <memory>
#include <numbers>
#include <optional>
#include <thread>
#include <utility>

#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "services/retrieval/catalog/template_names.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/families/family_surfaces.h"
#include "services/retrieval/fit/fit.h"
#include "services/retrieval/index/family_primitives.h"

namespace mortise::retrieval {
namespace {

constexpr int kStarts = 5;  // nearest primitives of a family
constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kMillimetres = 1000;

// What became of one match.
struct MatchFit {
  std::shared_ptr<const CompiledTemplate> compiled;
  absl::StatusOr<FittedDesign> fitted;
  mesh::SurfaceMesh surface;  // in the query's frame
};

absl::StatusOr<std::vector<FitStart>> StartsOf(const FitTask& task, const IndexMatch& match) {
  const IndexQuery query{.descriptors = task.descriptors, .count = kStarts, .allowed = nullptr};
  MORTISE_ASSIGN_OR_RETURN(const std::vector<IndexMatch> nearest,
                           NearestOfFamily(task.index.primitives, query, match.family));
  std::vector<FitStart> starts;
  for (const IndexMatch& each : nearest) {
    starts.push_back({task.index.primitives.PrimitiveOf(each).parameters});
  }
  return starts;
}

absl::StatusOr<FittedDesign> Fit(const FitTask& task, const FitQuery& query,
                                 const IndexMatch& match, const rpc::Call& call, MatchFit* fit) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<FitStart> starts, StartsOf(task, match));
  MORTISE_ASSIGN_OR_RETURN(const ParameterDomain domain, fit->compiled->domain->Get());
  const FitFamily family = SurfacesOf(fit->compiled->function, domain);
  FitOptions options;
  options.scale_is_free = !task.query.unit_is_known;
  options.descriptor = task.index.descriptor.get();
  options.descriptor_vectors = task.descriptors;
  options.is_given_up = [&call] { return call.cancelled(); };
  MORTISE_ASSIGN_OR_RETURN(const FittedDesign fitted, FitDesign(query, family, starts, options));
  MORTISE_ASSIGN_OR_RETURN(fit->surface, family.surfaces.surface(fitted.q));
  fit->surface.vertices = fitted.pose.ToQuery(fit->surface.vertices);
  return fitted;
}

void Tell(const FittedDesign& fitted, const templates::Template& function, bool scale_is_free,
          v1::ShapeFit* told) {
  const std::vector<parametric::Parameter>& parameters = function.parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    v1::ParameterValue& value = *told->add_parameters();
    value.set_name(parameters[i].name);
    value.set_value(fitted.q[static_cast<Eigen::Index>(i)]);
  }
  told->set_remaining(fitted.remaining.root_mean_square);
  told->set_remaining_95(fitted.remaining.percentile_95);
  told->set_beyond(fitted.beyond.root_mean_square);
  told->set_beyond_95(fitted.beyond.percentile_95);
  told->set_scale(fitted.pose.scale);
  told->set_scale_is_free(scale_is_free);
  told->set_turn(kDegrees * fitted.pose.turn);
  told->mutable_translation()->set_x(fitted.pose.translation.x());
  told->mutable_translation()->set_y(fitted.pose.translation.y());
  told->mutable_translation()->set_z(fitted.pose.translation.z());
  told->set_converged(fitted.converged);
}

std::string CaptionOf(const v1::ShapeMatch& match) {
  return absl::StrFormat("%s: %.3g, %.3g mm off", ShownName(match.template_(), match.group()),
                         match.distance(), kMillimetres * match.fit().remaining());
}

}  // namespace

absl::StatusOr<std::vector<SheetEntry>> FitMatches(const FitTask& task, TemplateSource& templates,
                                                   const rpc::Origin& origin, const rpc::Call& call,
                                                   v1::SearchShapesResponse* response) {
  const absl::StatusOr<FitQuery> query = FitQuery::Create(task.query.surface);
  std::vector<MatchFit> fits(task.matches.size());
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const v1::ShapeMatch& match = response->matches(static_cast<int>(i));
    auto compiled =
        templates.Get(match.template_(), match.template_revision(), origin, match.group());
    if (compiled.ok()) {
      fits[i].compiled = *std::move(compiled);
      continue;
    }
    if (IsPassingFailure(compiled.status())) return compiled.status();
    fits[i].fitted = compiled.status();
  }
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  ParallelFor(static_cast<int>(fits.size()), threads, [&](int i) {
    MatchFit& fit = fits[static_cast<std::size_t>(i)];
    if (fit.compiled == nullptr) return;
    fit.fitted = query.ok()
                     ? Fit(task, *query, task.matches[static_cast<std::size_t>(i)], call, &fit)
                     : query.status();
  });
  std::vector<SheetEntry> drawn;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    v1::ShapeMatch& match = *response->mutable_matches(static_cast<int>(i));
    const absl::StatusOr<FittedDesign>& fitted = fits[i].fitted;
    if (absl::IsCancelled(fitted.status())) return fitted.status();
    if (!fitted.ok()) {
      match.mutable_fit()->set_fault(std::string(fitted.status().message()));
      continue;
    }
    Tell(*fitted, *fits[i].compiled->function, !task.query.unit_is_known, match.mutable_fit());
    drawn.push_back({std::move(fits[i].surface), CaptionOf(match)});
  }
  return drawn;
}

}  // namespace mortise::retrieval
