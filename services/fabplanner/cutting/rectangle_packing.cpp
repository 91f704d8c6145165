#include "services/fabplanner/cutting/rectangle_packing.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace mortise::fabplanner {
namespace {

constexpr double kTolerance = 1e-9;  // m: sums of lengths that should be equal differ by rounding

struct FreeRectangle {
  double x0, y0, x1, y1;
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
  bool Contains(const FreeRectangle& other) const {
    return x0 <= other.x0 + kTolerance && y0 <= other.y0 + kTolerance &&
           x1 >= other.x1 - kTolerance && y1 >= other.y1 - kTolerance;
  }
};

using Score = std::pair<double, double>;  // compared in this order; smaller is better

Score Measure(const FreeRectangle& free, double width, double height, FitMeasure measure) {
  const double left_x = free.width() - width;
  const double left_y = free.height() - height;
  switch (measure) {
    case FitMeasure::kShortSide:
      return {std::min(left_x, left_y), std::max(left_x, left_y)};
    case FitMeasure::kArea:
      return {free.width() * free.height() - width * height, std::min(left_x, left_y)};
    case FitMeasure::kBottomLeft:
      return {free.x0 + width, free.y0};
  }
  return {0, 0};
}

class Bin {
 public:
  Bin(double width, double height) { free_.push_back({0, 0, width, height}); }

  // Places the rectangle where it fits best; false if it fits nowhere.
  bool Place(const RectangleSize& size, int index, FitMeasure measure,
             std::vector<PlacedRectangle>* placed) {
    Score best{std::numeric_limits<double>::infinity(), 0};
    FreeRectangle where{};
    bool turned = false;
    for (bool turn : {false, true}) {
      if (turn && !size.may_turn) continue;
      const double width = turn ? size.height : size.width;
      const double height = turn ? size.width : size.height;
      for (const FreeRectangle& free : free_) {
        if (width > free.width() + kTolerance || height > free.height() + kTolerance) continue;
        const Score score = Measure(free, width, height, measure);
        if (score >= best) continue;
        best = score;
        where = {free.x0, free.y0, free.x0 + width, free.y0 + height};
        turned = turn;
      }
    }
    if (best.first == std::numeric_limits<double>::infinity()) return false;
    Occupy(where);
    placed->push_back({index, where.x0, where.y0, turned});
    return true;
  }

 private:
  void Occupy(const FreeRectangle& used) {
    std::vector<FreeRectangle> kept, pieces;
    for (const FreeRectangle& free : free_) {
      const bool apart = used.x0 >= free.x1 - kTolerance || used.x1 <= free.x0 + kTolerance ||
                         used.y0 >= free.y1 - kTolerance || used.y1 <= free.y0 + kTolerance;
      if (apart) {
        kept.push_back(free);
        continue;
      }
      if (used.x0 > free.x0 + kTolerance) pieces.push_back({free.x0, free.y0, used.x0, free.y1});
      if (used.x1 < free.x1 - kTolerance) pieces.push_back({used.x1, free.y0, free.x1, free.y1});
      if (used.y0 > free.y0 + kTolerance) pieces.push_back({free.x0, free.y0, free.x1, used.y0});
      if (used.y1 < free.y1 - kTolerance) pieces.push_back({free.x0, used.y1, free.x1, free.y1});
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const auto contains = [&](const FreeRectangle& other) { return other.Contains(pieces[i]); };
      bool redundant = std::any_of(kept.begin(), kept.end(), contains);
      for (std::size_t j = 0; j < pieces.size() && !redundant; ++j) {
        // Of two equal pieces the first stays.
        redundant = j != i && contains(pieces[j]) && (j < i || !pieces[i].Contains(pieces[j]));
      }
      if (!redundant) kept.push_back(pieces[i]);
    }
    free_ = std::move(kept);
  }

  std::vector<FreeRectangle> free_;
};

std::vector<int> Order(const std::vector<RectangleSize>& rectangles, PackingOrder order) {
  const auto key = [&](int i) {
    const RectangleSize& r = rectangles[i];
    switch (order) {
      case PackingOrder::kArea:
        return r.width * r.height;
      case PackingOrder::kLongSide:
        return std::max(r.width, r.height);
      case PackingOrder::kWidth:
        return r.width;
      case PackingOrder::kHeight:
        return r.height;
    }
    return 0.0;
  };
  std::vector<int> indices(rectangles.size());
  std::iota(indices.begin(), indices.end(), 0);
  std::stable_sort(indices.begin(), indices.end(), [&](int a, int b) {
    const RectangleSize& p = rectangles[a];
    const RectangleSize& q = rectangles[b];
    return std::make_tuple(key(a), p.width, p.height) > std::make_tuple(key(b), q.width, q.height);
  });
  return indices;
}

bool SameSize(const RectangleSize& a, const RectangleSize& b) {
  return a.width == b.width && a.height == b.height && a.may_turn == b.may_turn;
}

}  // namespace

PackedRectangles PackRectangles(const std::vector<RectangleSize>& rectangles, double bin_width,
                                double bin_height, PackingOrder order, FitMeasure measure) {
  PackedRectangles bins;
  std::vector<int> remaining = Order(rectangles, order);
  while (!remaining.empty()) {
    Bin bin(bin_width, bin_height);
    std::vector<PlacedRectangle>& placed = bins.emplace_back();
    std::vector<int> left;
    for (int index : remaining) {
      // Where one copy did not fit, its equals, which follow it, do not either.
      const bool hopeless = !left.empty() && SameSize(rectangles[left.back()], rectangles[index]);
      if (hopeless || !bin.Place(rectangles[index], index, measure, &placed)) left.push_back(index);
    }
    remaining = std::move(left);
  }
  return bins;
}

}  // namespace mortise::fabplanner
