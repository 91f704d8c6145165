#include "services/retrieval/service/match_fits.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <thread>
#include <utility>

#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/base/errors.h"
#include "common/design/parameter_values.h"
#include "services/retrieval/catalog/template_names.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/families/family_surfaces.h"
#include "services/retrieval/fit/fit.h"
#include "services/retrieval/fit/mesh_points.h"
#include "services/retrieval/index/family_primitives.h"

namespace mortise::retrieval {
namespace {

constexpr int kStarts = 5;  // nearest primitives of a family
constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kMillimetres = 1000;
constexpr double kOfTheAnswer = 0.15;  // of the time left: for all that comes after the fits
constexpr absl::Duration kLongest = absl::Minutes(10);  // where nobody says when it must be done
// How many times larger or smaller than all designs a query is whose unit may be wrong.
constexpr double kOfAnotherUnit = 8;

// What became of one match.
struct MatchFit {
  std::shared_ptr<const SearchedTemplate> compiled;
  absl::StatusOr<FittedDesign> fitted;
  mesh::SurfaceMesh surface;  // in the query's frame
  double size = 0;            // m, of the design: its box's diagonal
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

// Shares the time out among fits.
class SharedTime {
 public:
  SharedTime(absl::Time deadline, int fits, int threads) : threads_(threads), left_(fits) {
    const absl::Time now = absl::Now();
    end_ = now + (1 - kOfTheAnswer) * std::min(deadline - now, kLongest);
  }

  // When a fit that begins now ends: it may take as long as all that are left, as many at a time as
  // there are threads.
  absl::Time EndOfNext() {
    const int left = left_.fetch_sub(1);
    const int rounds = (left + threads_ - 1) / threads_;
    const absl::Time now = absl::Now();
    return now + (end_ - now) / std::max(1, rounds);
  }

 private:
  absl::Time end_;
  const int threads_;
  std::atomic<int> left_;
};

absl::Status OutOfTime(absl::Duration taken) {
  return absl::DeadlineExceededError(absl::StrFormat(
      "ran out of time after %.0f s: designs of this template take long to make; look for fewer "
      "matches, or for this template alone",
      absl::ToDoubleSeconds(taken)));
}

absl::StatusOr<FittedDesign> Fit(const FitTask& task, const FitQuery& query,
                                 const IndexMatch& match, const rpc::Call& call, int threads,
                                 SharedTime& time, MatchFit* fit) {
  const absl::Time begin = absl::Now(), end = time.EndOfNext();
  MORTISE_ASSIGN_OR_RETURN(const std::vector<FitStart> starts, StartsOf(task, match));
  MORTISE_ASSIGN_OR_RETURN(const ParameterDomain domain, fit->compiled->domain->Get());
  const FitFamily family = SurfacesOf(fit->compiled->design_template, domain);
  FitOptions options;
  options.scale_is_free = !task.query.unit_is_known;
  options.descriptor = task.index.descriptor.get();
  options.descriptor_vectors = task.descriptors;
  options.threads = threads;
  options.is_given_up = [&call] { return call.cancelled(); };
  options.is_out_of_time = [end] { return absl::Now() >= end; };
  absl::StatusOr<FittedDesign> fitted = FitDesign(query, family, starts, options);
  if (absl::IsDeadlineExceeded(fitted.status())) return OutOfTime(absl::Now() - begin);
  MORTISE_RETURN_IF_ERROR(fitted.status());
  fit->size = BoxAround(fitted->surface.vertices).diagonal().norm();
  fit->surface = std::move(fitted->surface);
  fit->surface.vertices = fitted->pose.ToQuery(fit->surface.vertices);
  return fitted;
}

void Tell(const FittedDesign& fitted, const templates::Template& function, bool scale_is_free,
          v1::ShapeFit* told) {
  const std::vector<parametric::Parameter>& parameters = function.parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    v1::ParameterValue& value = *told->add_parameters();
    value.set_name(parameters[i].name);
    const double fit = fitted.q[static_cast<Eigen::Index>(i)];
    value.set_value(parametric::IsWhole(parameters[i]) ? std::round(fit) : fit);
    value.set_choice(parametric::ChoiceAt(parameters[i], value.value()));
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

FitEntry EntryOf(const v1::ShapeMatch& match, mesh::SurfaceMesh surface) {
  const v1::ShapeFit& fit = match.fit();
  return {{std::move(surface),
           absl::StrFormat("%s: %.3g%s", ShownName(match.template_(), match.group()),
                           match.distance(), fit.converged() ? "" : ", not converged")},
          absl::StrFormat("%.3g mm off, beyond %.3g mm", kMillimetres * fit.remaining(),
                          kMillimetres * fit.beyond())};
}

// Asks for the unit where every fitted design is of quite another size than the query. A single one
// may well be: a part looks like a whole.
void AddNoteOfSize(const FitTask& task, const std::vector<MatchFit>& fits,
                   v1::SearchShapesResponse* response) {
  if (!task.query.unit_is_known) return;
  const double size = BoxAround(task.query.surface.vertices).diagonal().norm();
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const MatchFit& fit : fits) {
    if (!fit.fitted.ok()) continue;
    least = std::min(least, fit.size);
    most = std::max(most, fit.size);
  }
  const bool is_smaller = most > 0 && size * kOfAnotherUnit < least;
  if (!is_smaller && !(most > 0 && size > kOfAnotherUnit * most)) return;
  response->add_notes(absl::StrFormat(
      "The query is %.3g m from corner to corner, about %.2g times %s than every design that was "
      "fitted to it: is its unit right?",
      size, is_smaller ? least / size : size / most, is_smaller ? "smaller" : "larger"));
}

}  // namespace

absl::StatusOr<std::vector<FitEntry>> FitMatches(const FitTask& task, TemplateSource& templates,
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
  const int count = static_cast<int>(fits.size());
  SharedTime time(call.deadline(), count, threads);
  ParallelFor(count, threads, [&](int i) {
    MatchFit& fit = fits[static_cast<std::size_t>(i)];
    if (fit.compiled == nullptr) return;
    fit.fitted = query.ok() ? Fit(task, *query, task.matches[static_cast<std::size_t>(i)], call,
                                  std::max(1, threads / count), time, &fit)
                            : query.status();
  });
  AddNoteOfSize(task, fits, response);
  std::vector<FitEntry> drawn;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    v1::ShapeMatch& match = *response->mutable_matches(static_cast<int>(i));
    const absl::StatusOr<FittedDesign>& fitted = fits[i].fitted;
    if (absl::IsCancelled(fitted.status())) return fitted.status();
    if (!fitted.ok()) {
      match.mutable_fit()->set_fault(std::string(fitted.status().message()));
      continue;
    }
    Tell(*fitted, *fits[i].compiled->design_template, !task.query.unit_is_known,
         match.mutable_fit());
    drawn.push_back(EntryOf(match, std::move(fits[i].surface)));
  }
  return drawn;
}

}  // namespace mortise::retrieval
