#include "common/assembly/relations/fit_spans.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace mortise::parametric {
namespace {

constexpr double kMaxAlone = 0.5;  // a bore with nothing in it against its element

class FitSpanSearch {
 public:
  FitSpanSearch(const ElementAlong& along, ShapeFeatures& known) : along_(along), known_(known) {}

  std::vector<FitSpan> Find() {
    for (const Bore& bore : BoresOf(along_.part(), known_)) {
      if (bore.axis != Index()) AddBore(bore);
    }
    for (int other = 0; other < std::ssize(along_.elements()); ++other) {
      if (along_.IsNeighbour(other) && along_.Overlaps(other) &&
          SizeOf(other) < along_.size() - along_.tolerance()) {
        AddMortise(other);
      }
    }
    std::vector<FitSpan> joined = Joined();
    std::erase_if(joined, [&](const FitSpan& span) {
      return !along_.DividingAt(span.low) || !along_.DividingAt(span.high);
    });
    return joined;
  }

 private:
  int Index() const { return static_cast<int>(along_.axis()); }
  double SizeOf(int element) const { return along_.At(element).box.size()[Index()]; }

  void AddBore(const Bore& bore) {
    FitSpan span{bore.box.minimum[Index()], bore.box.maximum[Index()], -1, {}, {}};
    double largest = 0;
    for (int other = 0; other < std::ssize(along_.elements()); ++other) {
      if (!along_.IsNeighbour(other) || IsSpreadAcross(other, bore)) continue;
      std::vector<BoundingBox> pins = PinsOf(along_.PartOf(other), bore.axis, known_);
      pins.push_back(along_.At(other).box);
      for (const BoundingBox& pin : pins) {
        const double size = pin.size()[Index()];
        if (size <= largest || !LiesIn(pin, bore, along_.NearTo(other)) ||
            !Fills(size, span.length())) {
          continue;
        }
        largest = size;
        GoBy(other, along_.PlaceIn(other, pin.minimum[Index()]),
             along_.PlaceIn(other, pin.maximum[Index()]), span);
      }
    }
    if (span.by >= 0 || IsSmall(bore)) spans_.push_back(std::move(span));
  }

  // Whether either is a row across a bore: its parts are somewhere in its box.
  bool IsSpreadAcross(int other, const Bore& bore) const {
    for (const int element : {along_.index(), other}) {
      const auto& pattern = along_.At(element).pattern;
      for (int axis = 0; axis < 3; ++axis) {
        if (axis != bore.axis && pattern && LeadsAlong(*pattern, axis)) return true;
      }
    }
    return false;
  }

  bool IsSmall(const Bore& bore) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == bore.axis || axis == bore.slot_axis) continue;
      if (bore.box.size()[axis] > kMaxAlone * along_.part().box.size()[axis]) return false;
    }
    return true;
  }

  // What reaches from one place of a neighbour to another.
  void AddMortise(int other) {
    const double near = along_.NearTo(other);
    std::optional<DrawnPlace> first, last;
    FitSpan span;
    for (const DrawnPlace& place : along_.PlacesOf(other)) {
      for (const double fraction : along_.dividing()) {
        const double at = along_.PlaceOf(fraction);
        if (std::abs(at - place.at) > near) continue;
        if (!first) {
          first = place;
          span.low = at;
        }
        last = place;
        span.high = at;
      }
    }
    if (!first || last->at - first->at <= near) return;
    GoBy(other, *first, *last, span);
    spans_.push_back(std::move(span));
  }

  void GoBy(int other, const DrawnPlace& low, const DrawnPlace& high, FitSpan& span) const {
    span.by = other;
    span.low_place = along_.AtDrawnDistance(other, low, span.low);
    span.high_place = along_.AtDrawnDistance(other, high, span.high);
  }

  std::vector<FitSpan> Joined() {
    std::sort(spans_.begin(), spans_.end(),
              [](const FitSpan& a, const FitSpan& b) { return a.low < b.low; });
    std::vector<FitSpan> joined;
    std::vector<double> longest;  // of those of each that it goes by
    for (FitSpan& span : spans_) {
      if (joined.empty() || span.low >= joined.back().high - along_.tolerance()) {
        longest.push_back(span.by < 0 ? 0 : span.length());
        joined.push_back(std::move(span));
        continue;
      }
      FitSpan& one = joined.back();
      const double low = one.low, high = std::max(one.high, span.high);
      if (span.by >= 0 && span.length() > longest.back()) {
        longest.back() = span.length();
        one = std::move(span);
      }
      if (one.by >= 0) {
        one.low_place.constant += low - one.low;
        one.high_place.constant += high - one.high;
      }
      one.low = low;
      one.high = high;
    }
    return joined;
  }

  const ElementAlong& along_;
  ShapeFeatures& known_;
  std::vector<FitSpan> spans_;
};

}  // namespace

std::vector<FitSpan> FindFitSpans(const ElementAlong& along, ShapeFeatures& known) {
  return FitSpanSearch(along, known).Find();
}

}  // namespace mortise::parametric
