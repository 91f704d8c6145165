#include "services/pareto/front/alpha_expansion.h"

#include <algorithm>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/property_map/property_map.hpp>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::pareto {
namespace {

constexpr double kMinGain = 1e-9;  // of energy, that a change is worth: more than rounding

// A network whose minimal cut is sought. Nodes 0 and 1 are source and sink.
class CutNetwork {
 public:
  static constexpr int kSource = 0, kSink = 1;

  void Reset(int nodes) {
    nodes_ = nodes + 2;
    arcs_.clear();
  }

  static int NodeOf(int index) { return index + 2; }

  // Capacities of u to v and of v to u.
  void Connect(int u, int v, double there, double back) {
    const int first = static_cast<int>(arcs_.size());
    arcs_.push_back({u, v, there, first + 1});
    arcs_.push_back({v, u, back, first});
  }

  // Whether each node, without source and sink, is on the side of the sink: of equal cuts in the
  // one where fewest are.
  std::vector<bool> OnSideOfSink();

 private:
  using Graph =
      boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, boost::no_property,
                                         boost::no_property, int, int>;
  using Edge = boost::graph_traits<Graph>::edge_descriptor;

  struct Arc {
    int from = 0, to = 0;
    double capacity = 0;
    int reverse = 0;
  };

  int nodes_ = 2;
  std::vector<Arc> arcs_;
};

std::vector<bool> CutNetwork::OnSideOfSink() {
  // Arcs by where they come from, as the graph stores them.
  std::vector<int> order(arcs_.size()), place(arcs_.size());
  std::vector<int> first(static_cast<std::size_t>(nodes_) + 1, 0);
  for (const Arc& arc : arcs_) ++first[arc.from + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  for (std::size_t a = 0; a < arcs_.size(); ++a) {
    place[a] = first[arcs_[a].from]++;
    order[place[a]] = static_cast<int>(a);
  }
  std::vector<std::pair<int, int>> ends(arcs_.size());
  std::vector<double> capacity(arcs_.size()), residual(arcs_.size());
  for (std::size_t e = 0; e < arcs_.size(); ++e) {
    const Arc& arc = arcs_[order[e]];
    ends[e] = {arc.from, arc.to};
    residual[e] = capacity[e] = arc.capacity;
  }
  const Graph graph(boost::edges_are_sorted, ends.begin(), ends.end(), nodes_);
  std::vector<Edge> by_index;
  by_index.reserve(arcs_.size());
  for (auto [edge, end] = boost::edges(graph); edge != end; ++edge) by_index.push_back(*edge);
  std::vector<Edge> reverse(arcs_.size());
  for (std::size_t e = 0; e < arcs_.size(); ++e) {
    reverse[e] = by_index[place[arcs_[order[e]].reverse]];
  }
  const auto edge_index = boost::get(boost::edge_index, graph);
  const auto vertex_index = boost::get(boost::vertex_index, graph);
  std::vector<Edge> predecessor(nodes_);
  std::vector<boost::default_color_type> colour(nodes_);
  std::vector<int> distance(nodes_);
  boost::boykov_kolmogorov_max_flow(
      graph, boost::make_iterator_property_map(capacity.begin(), edge_index),
      boost::make_iterator_property_map(residual.begin(), edge_index),
      boost::make_iterator_property_map(reverse.begin(), edge_index),
      boost::make_iterator_property_map(predecessor.begin(), vertex_index),
      boost::make_iterator_property_map(colour.begin(), vertex_index),
      boost::make_iterator_property_map(distance.begin(), vertex_index), vertex_index, kSource,
      kSink);
  std::vector<bool> with_sink(nodes_ - 2);
  for (int node = 2; node < nodes_; ++node) {
    with_sink[node - 2] = colour[node] == boost::white_color;  // the tree of the sink
  }
  return with_sink;
}

class Expansion {
 public:
  explicit Expansion(const LabelingProblem& problem)
      : problem_(problem), free_(problem.candidates.size(), -1), holders_(problem.labels) {
    const std::size_t sites = problem.candidates.size();
    first_.assign(sites + 1, 0);
    for (const auto& [j, k] : problem.neighbours) ++first_[j + 1], ++first_[k + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<int> next(first_.begin(), first_.end() - 1);
    adjacent_.resize(2 * problem.neighbours.size());
    for (const auto& [j, k] : problem.neighbours) {
      adjacent_[next[j]++] = k;
      adjacent_[next[k]++] = j;
    }
    for (std::size_t j = 0; j < sites; ++j) {
      const auto& candidates = problem.candidates[j];
      for (const LabelCost& candidate : candidates) {
        holders_[candidate.label].push_back({static_cast<int>(j), candidate.cost});
      }
      const auto cheapest = std::min_element(
          candidates.begin(), candidates.end(), [](const LabelCost& a, const LabelCost& b) {
            return std::pair(a.cost, a.label) < std::pair(b.cost, b.label);
          });
      label_.push_back(cheapest->label);
      cost_.push_back(cheapest->cost);
    }
  }

  std::vector<int> Run() {
    // A label need not be tried again before something has changed since.
    for (int unchanged = 0, label = 0; unchanged < problem_.labels;
         label = (label + 1) % problem_.labels) {
      unchanged = ExpandTo(label) ? 0 : unchanged + 1;
    }
    return std::move(label_);
  }

 private:
  struct Holder {
    int site = 0;
    double cost = 0;
  };

  // Lets sites change to a label if that brings the energy down.
  bool ExpandTo(int label);
  bool Change(const std::vector<Holder>& changing, int label);

  const LabelingProblem& problem_;
  std::vector<int> first_, adjacent_;  // neighbours of each site
  std::vector<int> free_;              // of a site: index among those that may change, or −1
  std::vector<std::vector<Holder>> holders_;  // of each label
  std::vector<int> label_;
  std::vector<double> cost_;  // of the label
  CutNetwork network_;
};

bool Expansion::ExpandTo(int label) {
  const double weight = problem_.weight;
  std::vector<Holder> movable;
  for (const Holder& holder : holders_[label]) {
    const int j = holder.site;
    // No more can be won than all that its neighbours may cost now.
    const double most = cost_[j] + weight * (first_[j + 1] - first_[j]);
    if (label_[j] == label || holder.cost >= most) continue;
    free_[j] = static_cast<int>(movable.size());
    movable.push_back(holder);
  }
  if (movable.empty()) return false;
  // Of each movable site what it costs to stay and to change; a pair that may both change costs
  //   stays with stays w [l_j != l_k], changes with changes 0, else w,
  // which is a sum of terms of one of them and one of a cut between them.
  network_.Reset(static_cast<int>(movable.size()));
  for (std::size_t m = 0; m < movable.size(); ++m) {
    const int j = movable[m].site;
    double stay = cost_[j], change = movable[m].cost;
    const int node = CutNetwork::NodeOf(static_cast<int>(m));
    for (int a = first_[j]; a < first_[j + 1]; ++a) {
      const int k = adjacent_[a];
      const bool differ = label_[j] != label_[k];
      if (free_[k] < 0) {
        if (label_[k] == label) {
          stay += weight;
        } else {
          change += weight;
          stay += differ ? weight : 0;
        }
        continue;
      }
      // Half of what both pay where they stay apart; the rest is cut between them.
      stay += differ ? weight / 2 : 0;
      const double between = differ ? weight / 2 : weight;
      if (j < k) network_.Connect(node, CutNetwork::NodeOf(free_[k]), between, between);
    }
    const double common = std::min(stay, change);
    // On the side of the sink it changes.
    network_.Connect(CutNetwork::kSource, node, change - common, 0);
    network_.Connect(node, CutNetwork::kSink, stay - common, 0);
  }
  const std::vector<bool> changes = network_.OnSideOfSink();
  std::vector<Holder> changing;
  for (std::size_t m = 0; m < movable.size(); ++m) {
    free_[movable[m].site] = -1;
    if (changes[m]) changing.push_back(movable[m]);
  }
  return Change(changing, label);
}

bool Expansion::Change(const std::vector<Holder>& changing, int label) {
  const std::vector<int> before = label_;
  double change = 0;
  for (const Holder& holder : changing) {
    const int j = holder.site;
    change += holder.cost - cost_[j];
    label_[j] = label;
  }
  // Pairs of which both change are met twice.
  for (const Holder& holder : changing) {
    const int j = holder.site;
    for (int a = first_[j]; a < first_[j + 1]; ++a) {
      const int k = adjacent_[a];
      const double share = before[k] != label_[k] ? 0.5 : 1;
      change += share * problem_.weight * ((label_[j] != label_[k]) - (before[j] != before[k]));
    }
  }
  if (!(change < -kMinGain)) {
    label_ = before;
    return false;
  }
  for (const Holder& holder : changing) cost_[holder.site] = holder.cost;
  return true;
}

absl::Status Check(const LabelingProblem& problem) {
  if (!(problem.weight >= 0) || !std::isfinite(problem.weight)) {
    return InvalidField("weight", "must be finite and not negative");
  }
  const auto sites = static_cast<int>(problem.candidates.size());
  for (int j = 0; j < sites; ++j) {
    const std::string field = absl::StrCat("candidates[", j, "]");
    std::vector<int> seen;
    for (const auto& [label, cost] : problem.candidates[j]) {
      if (label < 0 || label >= problem.labels) return InvalidField(field, "has an unknown label");
      if (!(cost >= 0) || !std::isfinite(cost)) {
        return InvalidField(field, "has a cost that is not finite, or negative");
      }
      seen.push_back(label);
    }
    if (seen.empty()) return InvalidField(field, "must not be empty");
    std::sort(seen.begin(), seen.end());
    if (std::adjacent_find(seen.begin(), seen.end()) != seen.end()) {
      return InvalidField(field, "has a label twice");
    }
  }
  for (std::size_t i = 0; i < problem.neighbours.size(); ++i) {
    const auto& [j, k] = problem.neighbours[i];
    if (j < 0 || k < 0 || j >= sites || k >= sites || j == k) {
      return InvalidField(absl::StrCat("neighbours[", i, "]"), "must be two sites");
    }
  }
  return absl::OkStatus();
}

}  // namespace

double LabelingEnergy(const LabelingProblem& problem, const std::vector<int>& labels) {
  double energy = 0;
  for (std::size_t j = 0; j < labels.size(); ++j) {
    const auto& candidates = problem.candidates[j];
    energy += std::find_if(candidates.begin(), candidates.end(), [&](const LabelCost& candidate) {
                return candidate.label == labels[j];
              })->cost;
  }
  for (const auto& [j, k] : problem.neighbours) energy += problem.weight * (labels[j] != labels[k]);
  return energy;
}

absl::StatusOr<std::vector<int>> MinimizeByExpansion(const LabelingProblem& problem) {
  MORTISE_RETURN_IF_ERROR(Check(problem));
  return Expansion(problem).Run();
}

}  // namespace mortise::pareto
