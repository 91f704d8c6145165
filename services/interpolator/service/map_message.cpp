#include "services/interpolator/service/map_message.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace mortise::interpolator {
namespace {

void AddParameters(const MapPlan& plan, v1::DesignMap& map) {
  std::set<Eigen::Index> varying;
  for (const PlannedParameter& parameter : plan.parameters) {
    varying.insert(parameter.index);
    v1::MapParameter& to = *map.add_parameters();
    to.set_name(parameter.name);
    to.set_unit(parameter.unit);
    to.set_minimum(parameter.minimum);
    to.set_maximum(parameter.maximum);
    to.set_whole(parameter.whole);
    to.mutable_choices()->Add(parameter.choices.begin(), parameter.choices.end());
  }
  for (Eigen::Index i = 0; i < plan.base.size(); ++i) {
    if (varying.contains(i)) continue;
    v1::ParameterValue& fixed = *map.add_fixed();
    fixed.set_name(plan.names[static_cast<std::size_t>(i)]);
    fixed.set_value(plan.base[i]);
  }
}

// How many halvings made the smallest element.
int DepthOf(const maps::RefinementTree& tree) {
  int most = 0;
  for (const int element : tree.Elements()) {
    int depth = 0;
    for (int d = 0; d < tree.dimension(); ++d) depth += tree.DepthOf(element, d);
    most = std::max(most, depth);
  }
  return most;
}

// How many elements have metrics and no shapes; 0 of a map of metrics alone.
std::int64_t CountShapeless(const StoredStructure& structure) {
  const std::vector<std::uint8_t>& cut_off = structure.map.content().cut_off;
  std::int64_t count = 0;
  for (std::size_t e = 0; e < structure.shapes.element_meshes.size(); ++e) {
    count += structure.shapes.element_meshes[e] < 0 && cut_off[e] == 0 ? 1 : 0;
  }
  return count;
}

void AddStructures(const MapPlan& plan, const MapBuilding& building,
                   const std::vector<StoredStructure>& structures, v1::DesignMap& map) {
  const std::vector<std::size_t> wholes = plan.WholeParameters();
  StopReason first_of_all = StopReason::kConverged;
  for (std::size_t s = 0; s < building.structures().size(); ++s) {
    const maps::MapSamplingProgress sampled = building.structures()[s]->Progress();
    const maps::MapContent& content = structures[s].map.content();
    v1::MapStructure& to = *map.add_structures();
    for (std::size_t i = 0; i < wholes.size(); ++i) {
      v1::ParameterValue& value = *to.add_values();
      value.set_name(plan.parameters[wholes[i]].name);
      value.set_value(plan.structures(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(s)));
    }
    to.set_samples(content.values.cols());
    to.set_probes(std::max<std::int64_t>(0, sampled.told - to.samples()));
    to.set_failed_evaluations(sampled.failed);
    to.set_elements(static_cast<std::int64_t>(content.cut_off.size()));
    to.set_cut_off_elements(std::ranges::count(content.cut_off, 1));
    to.set_shapeless_elements(CountShapeless(structures[s]));
    to.set_depth(DepthOf(structures[s].map.tree()));
    to.set_stop_reason(StopReasonName(building.ReasonOf(s)));
    map.set_samples(map.samples() + to.samples());
    map.set_probes(map.probes() + to.probes());
    map.set_failed_evaluations(map.failed_evaluations() + to.failed_evaluations());
    map.set_elements(map.elements() + to.elements());
    map.set_cut_off_elements(map.cut_off_elements() + to.cut_off_elements());
    map.set_shapeless_elements(map.shapeless_elements() + to.shapeless_elements());
    map.set_depth(std::max(map.depth(), to.depth()));
    first_of_all = std::max(first_of_all, building.ReasonOf(s));
  }
  map.set_stop_reason(StopReasonName(first_of_all));
}

// What the map was off at its probes.
struct ProbedErrors {
  Eigen::ArrayXd largest;
  Eigen::ArrayXd sum;
  double probes = 0;

  // Of one structure. Sampling may have ended while the elements of a round had no probes yet: then
  // those of the elements that are served say it, and never less than they do.
  void Add(const maps::MapErrors& present, const maps::MapContent& served) {
    Eigen::ArrayXd of_elements = Eigen::ArrayXd::Zero(largest.size());
    double elements = 0;
    for (Eigen::Index e = 0; e < served.errors.cols(); ++e) {
      if (served.cut_off[static_cast<std::size_t>(e)] != 0) continue;
      largest = largest.max(served.errors.col(e).array());
      of_elements += served.errors.col(e).array();
      ++elements;
    }
    if (present.probes > 0) {
      largest = largest.max(present.largest.array());
      sum += present.probes * present.mean.array();
      probes += present.probes;
    } else {
      sum += of_elements;
      probes += elements;
    }
  }
};

// The errors of all structures: the mean weighs each by its probes.
void AddMetrics(const MapPlan& plan, const MapBuilding& building,
                const std::vector<StoredStructure>& structures, v1::DesignMap& map) {
  const auto metrics = static_cast<Eigen::Index>(plan.metrics.size());
  Eigen::ArrayXd least = Eigen::ArrayXd::Constant(metrics, std::numeric_limits<double>::infinity());
  Eigen::ArrayXd most = -least;
  ProbedErrors errors{Eigen::ArrayXd::Zero(metrics), Eigen::ArrayXd::Zero(metrics)};
  for (std::size_t s = 0; s < structures.size(); ++s) {
    const maps::MapSampling& structure = *building.structures()[s];
    const maps::MapSamplingCheckpoint told = structure.Checkpoint();
    for (Eigen::Index i = 0; i < told.values.cols(); ++i) {
      if (!told.failures[static_cast<std::size_t>(i)].empty()) continue;
      least = least.min(told.values.col(i).array());
      most = most.max(told.values.col(i).array());
    }
    errors.Add(structure.Progress().errors, structures[s].map.content());
  }
  for (Eigen::Index i = 0; i < metrics; ++i) {
    const PlannedMetric& metric = plan.metrics[static_cast<std::size_t>(i)];
    v1::MapMetric& to = *map.add_metrics();
    to.set_name(metric.name);
    to.set_unit(metric.unit);
    to.set_minimum(least[i]);
    to.set_maximum(most[i]);
    to.set_largest_error(errors.largest[i]);
    to.set_mean_error(errors.probes > 0 ? errors.sum[i] / errors.probes : 0);
    const std::vector<std::optional<double>>& noise = building.noise().metrics;
    const bool is_estimated =
        static_cast<std::size_t>(i) < noise.size() && noise[static_cast<std::size_t>(i)];
    to.set_noise_estimated(is_estimated);
    to.set_noise_floor(is_estimated ? *noise[static_cast<std::size_t>(i)] : metric.noise_floor);
  }
}

void AddFailures(const std::vector<evaluation::FailureCount>& failures,
                 google::protobuf::RepeatedPtrField<v1::MapFailure>& messages) {
  for (const evaluation::FailureCount& failure : failures) {
    v1::MapFailure& to = *messages.Add();
    to.set_reason(failure.reason);
    to.set_count(failure.count);
    to.set_message(failure.message);
    to.mutable_parameters()->Add(failure.x.begin(), failure.x.end());
  }
}

}  // namespace

v1::DesignMap MakeMap(const v1::MapSpecification& specification, const MapPlan& plan,
                      const MapBuilding& building, const std::vector<StoredStructure>& structures) {
  v1::DesignMap map;
  *map.mutable_specification() = specification;
  AddParameters(plan, map);
  AddStructures(plan, building, structures, map);
  AddMetrics(plan, building, structures, map);
  map.set_noise_evaluations(building.noise().evaluations);
  const BuildProgress progress = building.progress();
  AddFailures(progress.failures, *map.mutable_failures());
  if (specification.has_shape()) {
    AddFailures(progress.unmapped_failures, *map.mutable_shapes()->mutable_unmapped_failures());
  }
  return map;
}

}  // namespace mortise::interpolator
