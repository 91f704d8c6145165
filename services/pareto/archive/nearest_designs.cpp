#include "services/pareto/archive/nearest_designs.h"

#include <algorithm>
#include <bit>
#include <iterator>

namespace mortise::pareto {

using Eigen::Index;
using Eigen::VectorXd;

void NearestDesigns::Add(std::size_t number, const Designs& designs) {
  order_.emplace(designs(parameter_, static_cast<Index>(number)), number);
  if (std::has_single_bit(order_.size())) SortBySpread(designs);
}

void NearestDesigns::SortBySpread(const Designs& designs) {
  const auto count = static_cast<double>(order_.size());
  VectorXd mean = VectorXd::Zero(designs.rows()), spread = mean;
  for (const auto& [value, number] : order_) mean += designs.col(static_cast<Index>(number));
  mean /= count;
  for (const auto& [value, number] : order_) {
    spread += (designs.col(static_cast<Index>(number)) - mean).cwiseAbs2();
  }
  Index widest = 0;
  spread.maxCoeff(&widest);
  if (widest == parameter_) return;
  parameter_ = widest;
  std::vector<std::pair<double, std::size_t>> order;
  for (const auto& [value, number] : order_) {
    order.emplace_back(designs(widest, static_cast<Index>(number)), number);
  }
  order_ = {order.begin(), order.end()};
}

std::vector<std::size_t> NearestDesigns::Nearest(const VectorXd& u, const VectorXd& weights,
                                                 std::size_t count, const Designs& designs) const {
  std::vector<std::pair<double, std::size_t>> nearest;  // a heap, the farthest first
  count = std::min(count, order_.size());
  if (count == 0) return {};
  const double from = u[parameter_], weight = weights[parameter_];
  auto above = order_.lower_bound({from, 0});
  auto below = above;  // the one before it is next
  while (below != order_.begin() || above != order_.end()) {
    const bool goes_up =
        below == order_.begin() ||
        (above != order_.end() && above->first - from < from - std::prev(below)->first);
    const auto& [value, number] = goes_up ? *above++ : *--below;
    const double apart = (value - from) * weight;
    if (nearest.size() == count && apart * apart > nearest.front().first) break;
    const double square =
        (designs.col(static_cast<Index>(number)) - u).cwiseProduct(weights).squaredNorm();
    const std::pair found(square, number);
    if (nearest.size() == count) {
      if (!(found < nearest.front())) continue;
      std::ranges::pop_heap(nearest);
      nearest.pop_back();
    }
    nearest.push_back(found);
    std::ranges::push_heap(nearest);
  }
  std::ranges::sort_heap(nearest);
  std::vector<std::size_t> numbers;
  numbers.reserve(nearest.size());
  for (const auto& [square, number] : nearest) numbers.push_back(number);
  return numbers;
}

}  // namespace mortise::pareto
