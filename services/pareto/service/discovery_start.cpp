// Designs of stored fronts in the parameters of another problem.
#include "services/pareto/service/discovery_start.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/discovery/warm_start.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr double kSameAnswer = 1e-9;  // relative

using Key = std::vector<double>;

std::optional<int> IndexIn(const google::protobuf::RepeatedPtrField<std::string>& names,
                           const std::string& name) {
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) return std::nullopt;
  return static_cast<int>(at - names.begin());
}

// Of each parameter of the problem, its place among those of the front.
std::vector<std::optional<int>> PlacesOf(const DiscoveryProblem& problem, const v1::Front& front) {
  std::vector<std::optional<int>> places;
  for (const std::string& name : problem.parameter_names) {
    places.push_back(IndexIn(front.parameter_names(), name));
  }
  return places;
}

// The number of the same choice of parameter i of the problem, which may have others than the front
// or in another order; -1 if it has not.
double ChoiceIn(const DiscoveryProblem& problem, std::size_t i, const v1::Front& front, int place,
                double value) {
  const std::vector<std::string>& names = problem.choices[i];
  if (place >= front.parameter_choices_size()) return -1;
  const auto& before = front.parameter_choices(place).names();
  const auto number = static_cast<int>(value);
  if (number < 0 || number >= before.size()) return -1;
  const auto at = std::ranges::find(names, before[number]);
  return at == names.end() ? -1 : static_cast<double>(at - names.begin());
}

// Parameters that the front lacks have the subject's default.
VectorXd Translated(const v1::FrontPoint& point, const v1::Front& front,
                    const std::vector<std::optional<int>>& places,
                    const DiscoveryProblem& problem) {
  VectorXd x = problem.default_design;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i]) continue;
    const double value = point.parameters(*places[i]);
    x[static_cast<Eigen::Index>(i)] =
        problem.choices[i].empty() ? value : ChoiceIn(problem, i, front, *places[i], value);
  }
  return x;
}

// With choices that are not allowed at the default's, or the first that is: they have no nearest.
VectorXd Allowed(VectorXd x, const DiscoveryProblem& problem) {
  for (const DiscreteParameter& discrete : problem.discrete) {
    const Eigen::Index i = discrete.parameter;
    const auto allows = [&](double value) {
      return std::ranges::find(discrete.values, value) != discrete.values.end();
    };
    if (problem.choices[static_cast<std::size_t>(i)].empty() || allows(x[i])) continue;
    const double usual = problem.default_design[i];
    x[i] = allows(usual) ? usual : discrete.values.front();
  }
  return x;
}

EarlierFront EarlierOf(const v1::Front& front, const DiscoveryProblem& problem) {
  const std::vector<std::optional<int>> places = PlacesOf(problem, front);
  EarlierFront earlier;
  earlier.designs.resize(problem.space.size(), front.points_size());
  earlier.metrics.resize(front.metric_names_size(), front.points_size());
  for (int i = 0; i < front.points_size(); ++i) {
    earlier.designs.col(i) = Allowed(Translated(front.points(i), front, places, problem), problem);
    for (int k = 0; k < front.metric_names_size(); ++k) {
      const bool maximized = front.specification().objectives(k).maximize();
      earlier.metrics(k, i) = (maximized ? -1 : 1) * front.points(i).metrics(k);
    }
  }
  return earlier;
}

// Whether metrics of the same name must have the same values for the same design.
bool AsksTheSame(const v1::DiscoverySpecification& a, const v1::DiscoverySpecification& b) {
  const auto same = [](const auto& left, const auto& right) {
    return left.SerializeAsString() == right.SerializeAsString();
  };
  return a.subject() == b.subject() && a.revision() == b.revision() && same(a.mesh(), b.mesh()) &&
         same(a.airflow(), b.airflow()) && same(a.metric_definitions(), b.metric_definitions()) &&
         a.tolerances_size() == 0 && b.tolerances_size() == 0;
}

// The metrics that designs had, in the order of the objectives; none where one was not asked for.
std::map<Key, std::vector<double>> KnownMetrics(const v1::DiscoverySpecification& specification,
                                                const DiscoveryProblem& problem,
                                                const std::vector<v1::Front>& fronts) {
  std::map<Key, std::vector<double>> known;
  for (const v1::Front& front : fronts) {
    if (!AsksTheSame(front.specification(), specification)) continue;
    std::vector<int> metrics;
    for (const Objective& objective : problem.objectives) {
      if (const auto at = IndexIn(front.metric_names(), objective.metric)) metrics.push_back(*at);
    }
    if (metrics.size() != problem.objectives.size()) continue;
    const std::vector<std::optional<int>> places = PlacesOf(problem, front);
    for (const v1::FrontPoint& point : front.points()) {
      const VectorXd x = Translated(point, front, places, problem);
      std::vector<double>& values = known[Key(x.begin(), x.end())];
      values.clear();
      for (const int metric : metrics) values.push_back(point.metrics(metric));
    }
  }
  return known;
}

bool SharesAParameter(const v1::Front& front, const DiscoveryProblem& problem) {
  return std::ranges::any_of(problem.parameter_names, [&](const std::string& name) {
    return IndexIn(front.parameter_names(), name).has_value();
  });
}

}  // namespace

absl::StatusOr<v1::Front> SettleStart(const v1::DiscoverySpecification& specification,
                                      const DiscoveryProblem& problem,
                                      const std::vector<v1::Front>& fronts) {
  std::vector<EarlierFront> earlier;
  for (std::size_t k = 0; k < fronts.size(); ++k) {
    const std::string field = absl::StrCat("specification.start_from[", k, "]");
    if (fronts[k].points().empty()) {
      return InvalidField(field, absl::StrCat(fronts[k].name(), " has no points"));
    }
    if (!SharesAParameter(fronts[k], problem)) {
      return InvalidField(
          field, absl::StrCat(fronts[k].name(), " has no parameter of ", specification.subject()));
    }
    earlier.push_back(EarlierOf(fronts[k], problem));
  }
  const auto d = static_cast<Eigen::Index>(problem.objectives.size());
  const Eigen::MatrixXd designs =
      StartDesigns(problem.space, earlier, MostStartDesigns(problem.options.evaluations, d));
  const auto known = KnownMetrics(specification, problem, fronts);
  v1::Front start;
  for (const std::string& name : problem.parameter_names) start.add_parameter_names(name);
  for (const auto& design : designs.colwise()) {
    v1::FrontPoint& point = *start.add_points();
    point.mutable_parameters()->Add(design.begin(), design.end());
    const auto at = known.find(Key(design.begin(), design.end()));
    if (at != known.end()) point.mutable_metrics()->Add(at->second.begin(), at->second.end());
  }
  return start;
}

Eigen::MatrixXd DesignsOf(const v1::Front& start) {
  Eigen::MatrixXd designs(start.parameter_names_size(), start.points_size());
  for (int i = 0; i < start.points_size(); ++i) {
    designs.col(i) =
        VectorXd::Map(start.points(i).parameters().data(), start.points(i).parameters_size());
  }
  return designs;
}

std::vector<std::string> ChangedAnswers(const v1::Front& start, const DiscoveryProblem& problem,
                                        const Archive& archive) {
  const VectorXd signs = problem.Signs();
  std::vector<std::string> remarks;
  for (std::size_t k = 0; k < problem.objectives.size(); ++k) {
    const auto metric = static_cast<int>(k);
    int changed = 0;
    double then = 0, now = 0;
    for (int i = 0; i < start.points_size() && i < static_cast<int>(archive.size()); ++i) {
      const ArchiveEntry& entry = archive[static_cast<std::size_t>(i)];
      if (!entry.evaluated || start.points(i).metrics_size() == 0) continue;
      const double before = start.points(i).metrics(metric);
      const double after = signs[metric] * entry.metrics[metric];
      if (std::abs(after - before) <= kSameAnswer * std::max(std::abs(after), std::abs(before))) {
        continue;
      }
      if (++changed > 1) continue;
      then = before;
      now = after;
    }
    if (changed > 0) {
      remarks.push_back(absl::StrCat("the evaluator changed its answers: '",
                                     problem.objectives[k].metric, "' of ", changed,
                                     " designs is not what it was in the earlier front, such as ",
                                     now, " where it was ", then));
    }
  }
  return remarks;
}

}  // namespace mortise::pareto
