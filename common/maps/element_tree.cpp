#include "common/maps/element_tree.h"

#include <algorithm>

namespace mortise::maps {
namespace {

// Finds the positions on the split plane in which, for every direction, an element ends.
class CornerSearch {
 public:
  CornerSearch(const ElementTree& tree, const LatticeBox& plane, int direction)
      : tree_(tree), plane_(plane), direction_(direction) {}

  std::vector<LatticePoint> Find() {
    LatticePoint point{};
    Enter(0, tree_.Touching(plane_), point);
    return std::move(found_);
  }

 private:
  void Enter(int d, const std::vector<int>& around, LatticePoint& point) {
    if (d == tree_.dimension()) {
      if (EndsEverywhere(around, point)) found_.push_back(point);
      return;
    }
    if (d == direction_) {
      point[d] = plane_.low[d];
      Enter(d + 1, around, point);
      return;
    }
    for (const std::int32_t end : EndsWithin(d, around)) {
      std::vector<int> remaining;
      for (const int element : around) {
        const LatticeBox& box = tree_.BoxOf(element);
        if (box.low[d] <= end && end <= box.high[d]) remaining.push_back(element);
      }
      point[d] = end;
      Enter(d + 1, remaining, point);
    }
  }

  std::vector<std::int32_t> EndsWithin(int d, const std::vector<int>& around) const {
    std::vector<std::int32_t> ends;
    for (const int element : around) {
      const LatticeBox& box = tree_.BoxOf(element);
      for (const std::int32_t end : {box.low[d], box.high[d]}) {
        if (plane_.low[d] <= end && end <= plane_.high[d]) ends.push_back(end);
      }
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    return ends;
  }

  bool EndsEverywhere(const std::vector<int>& around, const LatticePoint& point) const {
    for (int d = 0; d < tree_.dimension(); ++d) {
      if (d == direction_) continue;
      const bool ends = std::any_of(around.begin(), around.end(), [&](int element) {
        const LatticeBox& box = tree_.BoxOf(element);
        return box.low[d] == point[d] || box.high[d] == point[d];
      });
      if (!ends) return false;
    }
    return true;
  }

  const ElementTree& tree_;
  const LatticeBox& plane_;
  int direction_;
  std::vector<LatticePoint> found_;
};

bool Contains(int dimension, const LatticeBox& box, const LatticePoint& point) {
  for (int d = 0; d < dimension; ++d) {
    if (point[d] < box.low[d] || point[d] > box.high[d]) return false;
  }
  return true;
}

RationalPoint AsRational(const LatticePoint& point) {
  RationalPoint rational;
  std::copy(point.begin(), point.end(), rational.numerator.begin());
  return rational;
}

}  // namespace

ElementTree::ElementTree(int dimension) : dimension_(dimension) {
  Node root;
  for (int d = 0; d < dimension; ++d) root.box.high[d] = kBoxEdge;
  nodes_.push_back(root);
  LatticePoint step{};
  step.fill(kBoxEdge);
  ForEachGridPoint(dimension, root.box, step,
                   [&](const LatticePoint& corner) { AddSample(corner); });
}

int ElementTree::LeastDepthOf(int node) const {
  const auto& depth = nodes_[node].depth;
  return *std::min_element(depth.begin(), depth.begin() + dimension_);
}

int ElementTree::MostDepthOf(int node) const {
  const auto& depth = nodes_[node].depth;
  return *std::max_element(depth.begin(), depth.begin() + dimension_);
}

// Collects the elements below nodes whose children are entered: enters(direction, middle) says into
// which (bit 0: the lower one, bit 1: the upper one).
template <typename Enters>
std::vector<int> ElementTree::Collect(const Enters& enters) const {
  std::vector<int> found, open = {0};
  while (!open.empty()) {
    const int number = open.back();
    open.pop_back();
    const Node& node = nodes_[number];
    if (node.direction < 0) {
      found.push_back(number);
      continue;
    }
    const int sides = enters(node.direction, node.middle);
    if (sides & 2) open.push_back(node.first_child + 1);
    if (sides & 1) open.push_back(node.first_child);
  }
  return found;
}

std::vector<int> ElementTree::Touching(const LatticeBox& box) const {
  return Collect([&](int d, std::int32_t middle) {
    return (box.low[d] <= middle ? 1 : 0) | (box.high[d] >= middle ? 2 : 0);
  });
}

std::vector<int> ElementTree::Overlapping(const LatticeBox& box) const {
  return Collect([&](int d, std::int32_t middle) {
    return (box.low[d] < middle ? 1 : 0) | (box.high[d] > middle ? 2 : 0);
  });
}

std::vector<int> ElementTree::Containing(const RationalPoint& point) const {
  return Collect([&](int d, std::int32_t middle) {
    const std::int64_t scaled = middle * point.denominator;
    return (point.numerator[d] <= scaled ? 1 : 0) | (point.numerator[d] >= scaled ? 2 : 0);
  });
}

LatticeBox ElementTree::CommonCuboid(const RationalPoint& point) const {
  LatticeBox common = nodes_[0].box;
  for (const int element : Containing(point)) {
    const LatticeBox& box = nodes_[element].box;
    for (int d = 0; d < dimension_; ++d) {
      common.low[d] = std::max(common.low[d], box.low[d]);
      common.high[d] = std::min(common.high[d], box.high[d]);
    }
  }
  return common;
}

int ElementTree::Locate(const double* point) const {
  int number = 0;
  while (nodes_[number].direction >= 0) {
    const Node& node = nodes_[number];
    number = node.first_child + (point[node.direction] >= ToUnit(node.middle) ? 1 : 0);
  }
  return number;
}

std::vector<LatticePoint> ElementTree::NewSamples(int element, int direction) const {
  LatticeBox plane = nodes_[element].box;
  plane.low[direction] += (plane.high[direction] - plane.low[direction]) / 2;
  plane.high[direction] = plane.low[direction];
  std::vector<LatticePoint> corners = CornerSearch(*this, plane, direction).Find();
  corners.erase(std::remove_if(corners.begin(), corners.end(),
                               [&](const LatticePoint& corner) { return FindSample(corner) >= 0; }),
                corners.end());
  return corners;
}

std::vector<int> ElementTree::Split(int element, int direction) {
  const std::vector<LatticePoint> positions = NewSamples(element, direction);
  const int first_child = node_count();
  Node lower = nodes_[element];
  lower.depth[direction] = static_cast<std::int8_t>(lower.depth[direction] + 1);
  Node upper = lower;
  const std::int32_t middle =
      lower.box.low[direction] + (lower.box.high[direction] - lower.box.low[direction]) / 2;
  lower.box.high[direction] = middle;
  upper.box.low[direction] = middle;
  for (Node* child : {&lower, &upper}) {
    auto& samples = child->samples;
    samples.erase(std::remove_if(samples.begin(), samples.end(),
                                 [&](int sample) {
                                   return !Contains(dimension_, child->box, samples_[sample]);
                                 }),
                  samples.end());
  }
  Node& parent = nodes_[element];
  parent.direction = static_cast<std::int8_t>(direction);
  parent.middle = middle;
  parent.first_child = first_child;
  parent.samples = {};
  nodes_.push_back(std::move(lower));
  nodes_.push_back(std::move(upper));
  std::vector<int> added;
  added.reserve(positions.size());
  for (const LatticePoint& position : positions) added.push_back(AddSample(position));
  return added;
}

int ElementTree::FindSample(const LatticePoint& position) const {
  const auto found = sample_index_.find(position);
  return found == sample_index_.end() ? -1 : found->second;
}

int ElementTree::AddSample(const LatticePoint& position) {
  const int number = sample_count();
  samples_.push_back(position);
  sample_index_.emplace(position, number);
  for (const int element : Containing(AsRational(position)))
    nodes_[element].samples.push_back(number);
  return number;
}

}  // namespace mortise::maps
