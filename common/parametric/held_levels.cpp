#include "common/parametric/held_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/mesh/round_faces.h"
#include "common/mesh/shape_levels.h"
#include "common/parametric/rest_pose.h"

namespace mortise::parametric {
namespace {

constexpr double kLeastShare = 0.5;   // of what lies between held levels, as drawn
constexpr double kWidestPlay = 2;     // a bore against what lies in it
constexpr double kWidestAlone = 0.5;  // a bore with nothing in it against its element
constexpr int kAll = std::numeric_limits<int>::max();

// A stretch of a shape along an axis that something fits into, or that keeps its size by itself.
struct Span {
  double low = 0, high = 0;  // m, as drawn
  // The element it goes by, and where from and to; -1 for none.
  int by = -1;
  LinearForm low_place, high_place;

  double length() const { return high - low; }
};

// Another place of an element, a plane or level, as drawn.
struct Place {
  double at = 0;  // m
  ElementPlane plane;
};

// The box of a round face of a part, as drawn in the design.
BoundingBox BoxOf(const AssemblyPart& part, const mesh::RoundFace& face) {
  Eigen::Vector3d half = Eigen::Vector3d::Constant(face.radius);
  half[face.axis] = face.length / 2;
  const Eigen::Vector3d factors = part.box.size().cwiseQuotient(part.shape->size);
  const Eigen::Vector3d middle = part.box.center() + factors.cwiseProduct(face.middle);
  half = half.cwiseProduct(factors);
  return {middle - half, middle + half};
}

// Whether a box reaches into a bore along `along`, and fills it but for some play across. What is
// in one place may be `near` apart, m.
bool LiesIn(const BoundingBox& inner, const BoundingBox& bore, int along, double near) {
  for (int axis = 0; axis < 3; ++axis) {
    const double low = inner.minimum[axis], high = inner.maximum[axis];
    if (axis == along) {
      if (low >= bore.maximum[axis] - near || high <= bore.minimum[axis] + near) return false;
      continue;
    }
    if (low < bore.minimum[axis] - near || high > bore.maximum[axis] + near) return false;
    if (kWidestPlay * (high - low) < bore.size()[axis]) return false;
  }
  return true;
}

// Of shapes, each looked at once: many parts share one.
class RoundFaces {
 public:
  const std::vector<mesh::RoundFace>& Of(const mesh::DrawnShape& shape) {
    const auto [found, is_new] = known_.try_emplace(&shape);
    if (is_new) found->second = mesh::RoundFacesOf(shape);
    return found->second;
  }

 private:
  std::map<const mesh::DrawnShape*, std::vector<mesh::RoundFace>> known_;
};

// Holds the levels of one element along one axis.
class LevelHolder {
 public:
  LevelHolder(const Assembly& assembly, std::vector<Element>& elements,
              const std::set<std::pair<int, int>>& neighbours, int element, Axis axis,
              double tolerance, int shares_kept, RoundFaces& round_faces)
      : assembly_(assembly),
        elements_(elements),
        neighbours_(neighbours),
        element_(element),
        axis_(axis),
        tolerance_(tolerance),
        shares_kept_(shares_kept),
        center_(At(element).box.center()[Index()]),
        size_(At(element).box.size()[Index()]) {
    for (const Place& place : PlacesOf(element)) {
      if (place.plane.divides) dividing_.push_back(place.plane.fraction);
    }
    std::sort(dividing_.begin(), dividing_.end());
    if (!dividing_.empty()) round_faces_ = &round_faces.Of(*PartOf(element).shape);
  }

  void Hold(HeldLevels& held) {
    if (dividing_.empty()) return;
    spans_ = Joined(FindSpans());
    std::erase_if(spans_,
                  [&](const Span& span) { return !Dividing(span.low) || !Dividing(span.high); });
    for (const Span& span : spans_) {
      if (span.by < 0) continue;
      Add(span.low, span.low_place);
      Add(span.high, span.high_place);
    }
    HoldEnds();
    HoldDepths();
    HoldEmpty();
    if (Levels().empty()) return;
    KeepShares(held);
    KeepDistances(held);
  }

 private:
  int Index() const { return static_cast<int>(axis_); }
  const Element& At(int element) const { return elements_[static_cast<std::size_t>(element)]; }
  const AssemblyPart& PartOf(int element) const {
    return assembly_.parts[static_cast<std::size_t>(At(element).parts.front())];
  }
  std::vector<HeldLevel>& Levels() {
    return elements_[static_cast<std::size_t>(element_)]
        .held_levels[static_cast<std::size_t>(axis_)];
  }
  bool IsNeighbour(int other) const {
    return neighbours_.count(std::minmax(element_, other)) != 0 &&
           !(At(other).pattern && LeadsAlong(*At(other).pattern, Index()));
  }

  // How far apart what is in one place may be drawn.
  double NearTo(int other) const {
    double near = tolerance_;
    for (const int element : {element_, other}) {
      const AssemblyPart& part = PartOf(element);
      if (part.shape != nullptr) {
        near += mesh::DeflectionIn(*part.shape, part.box.size());
      }
    }
    return near;
  }

  std::vector<Place> PlacesOf(int element) const {
    std::vector<Place> places;
    const BoundingBox& box = At(element).box;
    for (const auto* planes : {&At(element).planes, &At(element).levels}) {
      for (const ElementPlane& plane : *planes) {
        if (plane.axis != axis_) continue;
        places.push_back({box.center()[Index()] + plane.fraction * box.size()[Index()], plane});
      }
    }
    std::sort(places.begin(), places.end(),
              [](const Place& a, const Place& b) { return a.at < b.at; });
    return places;
  }

  // The fraction of the dividing level at a place, m.
  std::optional<double> Dividing(double at) const {
    for (const double fraction : dividing_) {
      if (std::abs(center_ + fraction * size_ - at) <= tolerance_) return fraction;
    }
    return std::nullopt;
  }

  // Where `at` lies, as drawn at a distance from a place of another element.
  LinearForm Beside(int other, const Place& place, double at) const {
    LinearForm form = PositionOf(elements_, other, place.plane);
    form.constant += at - place.at;
    return form;
  }

  Place BoxFace(int element, bool upper) const {
    const BoundingBox& box = At(element).box;
    return {(upper ? box.maximum : box.minimum)[Index()], {"", axis_, upper ? 0.5 : -0.5, false}};
  }

  void Add(double at, LinearForm place) {
    const std::optional<double> fraction = Dividing(at);
    std::vector<HeldLevel>& levels = Levels();
    const auto behind = std::find_if(levels.begin(), levels.end(), [&](const HeldLevel& level) {
      return level.fraction >= *fraction;
    });
    if (behind != levels.end() && behind->fraction == *fraction) return;
    levels.insert(behind, {*fraction, std::move(place)});
  }

  // ---- What fits into the shape

  std::vector<Span> FindSpans() const {
    std::vector<Span> spans;
    for (const mesh::RoundFace& face : *round_faces_) {
      if (face.is_hollow && face.is_whole && face.axis != Index()) AddBore(face, spans);
    }
    for (int other = 0; other < static_cast<int>(elements_.size()); ++other) {
      if (IsNeighbour(other) && Overlaps(other) &&
          At(other).box.size()[Index()] < size_ - tolerance_) {
        AddMortise(other, spans);
      }
    }
    return spans;
  }

  void AddBore(const mesh::RoundFace& face, std::vector<Span>& spans) const {
    const BoundingBox bore = BoxOf(PartOf(element_), face);
    Span span{bore.minimum[Index()], bore.maximum[Index()], -1, {}, {}};
    double largest = 0;
    for (int other = 0; other < static_cast<int>(elements_.size()); ++other) {
      if (!IsNeighbour(other) || !FitsInto(other, bore, face.axis)) continue;
      const double size = At(other).box.size()[Index()];
      if (size <= largest) continue;
      largest = size;
      GoBy(other, BoxFace(other, false), BoxFace(other, true), span);
    }
    const int across = 3 - Index() - face.axis;
    const BoundingBox& box = PartOf(element_).box;
    const bool is_small = span.length() <= kWidestAlone * box.size()[Index()] &&
                          bore.size()[across] <= kWidestAlone * box.size()[across];
    if (span.by >= 0 || is_small) spans.push_back(std::move(span));
  }

  // Whether an element lies in a bore along `along`, with little play.
  bool FitsInto(int other, const BoundingBox& bore, int along) const {
    for (const int element : {element_, other}) {
      for (int axis = 0; axis < 3; ++axis) {
        // Parts of rows are somewhere in the boxes of these.
        const auto& pattern = At(element).pattern;
        if (axis != along && pattern && LeadsAlong(*pattern, axis)) return false;
      }
    }
    return LiesIn(At(other).box, bore, along, NearTo(other));
  }

  // Whether an element's box reaches into this one's, and does not only touch it.
  bool Overlaps(int other) const {
    const BoundingBox& own = At(element_).box;
    const BoundingBox& box = At(other).box;
    const Eigen::Array3d overlap =
        own.maximum.cwiseMin(box.maximum) - own.minimum.cwiseMax(box.minimum);
    return overlap.minCoeff() > tolerance_;
  }

  // What reaches from one place of a neighbour to another.
  void AddMortise(int other, std::vector<Span>& spans) const {
    const double near = NearTo(other);
    std::optional<Place> first, last;
    Span span;
    for (const Place& place : PlacesOf(other)) {
      for (const double fraction : dividing_) {
        const double at = center_ + fraction * size_;
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
    spans.push_back(std::move(span));
  }

  void GoBy(int other, const Place& low, const Place& high, Span& span) const {
    span.by = other;
    span.low_place = Beside(other, low, span.low);
    span.high_place = Beside(other, high, span.high);
  }

  // Those that overlap as one, which goes by the longest that goes by something.
  std::vector<Span> Joined(std::vector<Span> spans) const {
    std::sort(spans.begin(), spans.end(),
              [](const Span& a, const Span& b) { return a.low < b.low; });
    std::vector<Span> joined;
    std::vector<double> longest;  // of those of each that it goes by
    for (Span& span : spans) {
      if (joined.empty() || span.low >= joined.back().high - tolerance_) {
        longest.push_back(span.by < 0 ? 0 : span.length());
        joined.push_back(std::move(span));
        continue;
      }
      Span& one = joined.back();
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

  // ---- What the shape fits into

  // Whether an element, but along the axis, is no wider than another where they meet.
  bool Enters(int element, int other) const {
    const BoundingBox& own = At(element).box;
    const BoundingBox& box = At(other).box;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == Index()) continue;
      for (const int one : {element, other}) {
        if (At(one).pattern && LeadsAlong(*At(one).pattern, axis)) return false;
      }
      if (own.minimum[axis] < box.minimum[axis] - tolerance_ ||
          own.maximum[axis] > box.maximum[axis] + tolerance_) {
        return false;
      }
    }
    return true;
  }

  bool IsInSpan(double at) const {
    return std::any_of(spans_.begin(), spans_.end(), [&](const Span& span) {
      return at >= span.low - tolerance_ && at <= span.high + tolerance_;
    });
  }

  // Shoulders against what the element enters, and bottoms of what is let into it.
  void HoldEnds() {
    for (int other = 0; other < static_cast<int>(elements_.size()); ++other) {
      if (!IsNeighbour(other) || At(other).box.size()[Index()] >= size_ - tolerance_) continue;
      const bool enters = Enters(element_, other);
      if (!enters && !(Overlaps(other) && Enters(other, element_))) continue;
      for (const bool upper : {false, true}) {
        const Place face = BoxFace(other, upper);
        for (const double fraction : dividing_) {
          const double at = center_ + fraction * size_;
          if (std::abs(at - face.at) > NearTo(other) || IsInSpan(at)) continue;
          Add(at, Beside(other, face, at));
          if (ends_.insert(fraction).second && !enters) bottoms_.emplace_back(fraction, other);
        }
      }
    }
  }

  // ---- Bores with nothing in them, or nothing at their bottom

  // A blind bore is as deep as it is drawn, from the face of the box where it begins.
  void HoldDepths() {
    const AssemblyPart& part = PartOf(element_);
    for (const mesh::RoundFace& face : *round_faces_) {
      if (!face.is_hollow || !face.is_whole || face.axis != Index()) continue;
      const BoundingBox bore = BoxOf(part, face);
      for (const bool upper : {false, true}) {
        const Place begin = BoxFace(element_, upper);
        const double mouth = (upper ? bore.maximum : bore.minimum)[Index()];
        const double bottom = (upper ? bore.minimum : bore.maximum)[Index()];
        const std::optional<double> fraction = Dividing(bottom);
        if (!fraction || std::abs(mouth - begin.at) > tolerance_ || IsInSpan(bottom) ||
            std::abs(bottom - begin.at) > kWidestAlone * size_) {
          continue;
        }
        Add(bottom, Beside(element_, begin, bottom));
        ends_.insert(*fraction);
      }
    }
  }

  void HoldEmpty() {
    std::vector<std::pair<const Span*, LinearForm>>
        middles;  // in proportion to what is held so far
    for (const Span& span : spans_) {
      if (span.by >= 0 || HoldsWithin(span)) continue;
      const double fraction = ((span.low + span.high) / 2 - center_) / size_;
      middles.emplace_back(&span, PositionOf(elements_, element_, {"", axis_, fraction, false}));
    }
    for (auto& [span, middle] : middles) {
      LinearForm low = middle, high = middle;
      low.constant -= span->length() / 2;
      high.constant += span->length() / 2;
      Add(span->low, std::move(low));
      Add(span->high, std::move(high));
    }
  }

  bool HoldsWithin(const Span& span) {
    return std::any_of(Levels().begin(), Levels().end(), [&](const HeldLevel& level) {
      const double at = center_ + level.fraction * size_;
      return at > span.low - tolerance_ && at < span.high + tolerance_;
    });
  }

  // ---- Relationships

  void Relate(RelationshipKind kind, bool equality, LinearForm form, std::string description,
              HeldLevels& held) const {
    if (form.terms.empty()) return;
    if (equality) form.constant -= form.At(DrawnParameters(assembly_, elements_));
    const int group = GroupIn(Pose{}, assembly_, elements_, At(element_), At(element_), form);
    held.relationships.push_back({kind, equality, std::move(form), group, std::move(description)});
  }

  std::string Label() const { return absl::StrCat("'", At(element_).name, "'"); }

  // Middles of what fits in, and bottoms, stay where they are in proportion.
  void KeepShares(HeldLevels& held) const {
    int kept = 0;
    const auto keep = [&](int other, const LinearForm& place, double fraction) {
      ++held.fits[{At(element_).parts.front(), axis_}];
      if (kept >= shares_kept_) return;
      ++kept;
      Relate(RelationshipKind::kProportion, true,
             place - PositionOf(element_, {"", axis_, fraction, false}),
             absl::StrCat("'", At(other).name, "' at its share of ", Label(), " along ",
                          AxisName(axis_)),
             held);
    };
    for (const Span& span : spans_) {
      if (span.by < 0) continue;
      keep(span.by, Combine(0.5, span.low_place, 0.5, span.high_place),
           ((span.low + span.high) / 2 - center_) / size_);
    }
    for (const auto& [fraction, other] : bottoms_) {
      keep(other, PositionOf(elements_, element_, {"", axis_, fraction, false}), fraction);
    }
  }

  bool IsSpan(double from, double to) const {
    return std::any_of(spans_.begin(), spans_.end(), [&](const Span& span) {
      return std::abs(center_ + from * size_ - span.low) <= tolerance_ &&
             std::abs(center_ + to * size_ - span.high) <= tolerance_;
    });
  }

  void KeepDistances(HeldLevels& held) {
    std::vector<HeldLevel> ends = Levels();
    ends.insert(ends.begin(), {-0.5, PositionOf(element_, {"", axis_, -0.5, false})});
    ends.push_back({0.5, PositionOf(element_, {"", axis_, 0.5, false})});
    const LinearForm size = LinearForm::Variable(SizeVariable(element_, axis_));
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const HeldLevel& low = ends[i];
      const HeldLevel& high = ends[i + 1];
      if (IsSpan(low.fraction, high.fraction)) continue;
      const double share = kLeastShare * (high.fraction - low.fraction);
      const bool is_tenon = (i == 0 && ends_.count(high.fraction) != 0) ||
                            (i + 2 == ends.size() && ends_.count(low.fraction) != 0);
      LinearForm form = low.place - high.place;
      if (is_tenon) {
        form.constant += share * size_;
      } else {
        form = Combine(1, form, share, size);
      }
      Relate(RelationshipKind::kOrder, false, std::move(form),
             absl::StrCat(Label(), " keeps something of what lies between two places along ",
                          AxisName(axis_)),
             held);
    }
  }

  const Assembly& assembly_;
  std::vector<Element>& elements_;
  const std::set<std::pair<int, int>>& neighbours_;
  const int element_;
  const Axis axis_;
  const double tolerance_;
  const int shares_kept_;
  const double center_, size_;                                 // as drawn, m
  std::vector<double> dividing_;                               // fractions, in order
  const std::vector<mesh::RoundFace>* round_faces_ = nullptr;  // of what something divides
  std::vector<Span> spans_;                                    // in order, apart from each other
  std::set<double> ends_;                                      // fractions of shoulders and bottoms
  std::vector<std::pair<double, int>> bottoms_;                // fractions, and what is let in
};

// Elements that touch, or whose boxes overlap.
std::set<std::pair<int, int>> NeighboursOf(const std::vector<Element>& elements,
                                           const Contacts& contacts, double tolerance) {
  std::set<std::pair<int, int>> neighbours(contacts.begin(), contacts.end());
  const int count = static_cast<int>(elements.size());
  for (int a = 0; a < count; ++a) {
    const BoundingBox& one = elements[static_cast<std::size_t>(a)].box;
    for (int b = a + 1; b < count; ++b) {
      const BoundingBox& other = elements[static_cast<std::size_t>(b)].box;
      const Eigen::Array3d overlap =
          one.maximum.cwiseMin(other.maximum) - one.minimum.cwiseMax(other.minimum);
      if (overlap.minCoeff() > tolerance) neighbours.emplace(a, b);
    }
  }
  return neighbours;
}

void DivideShape(Element& element) {
  std::vector<mesh::ShapeLevel> levels;
  for (int axis = 0; axis < 3; ++axis) {
    for (const HeldLevel& level : element.held_levels[static_cast<std::size_t>(axis)]) {
      levels.push_back({axis, level.fraction, true});
    }
  }
  if (levels.empty()) return;
  element.shape = std::make_shared<const mesh::DrawnShape>(mesh::DividedAt(*element.shape, levels));
}

}  // namespace

HeldLevels HoldLevels(const Assembly& assembly, std::vector<Element>& elements,
                      const Contacts& contacts, double tolerance, const Precautions& precautions) {
  std::set<int> fitted;  // parts
  for (const PosedPair& pair : precautions.fitted) fitted.insert({pair.first, pair.second});
  const std::set<std::pair<int, int>> neighbours = NeighboursOf(elements, contacts, tolerance);
  HeldLevels held;
  RoundFaces round_faces;
  for (const Axis axis : kAxes) {
    // What goes by others is larger than they are, whose own places are known by then.
    std::vector<int> order(elements.size());
    std::iota(order.begin(), order.end(), 0);
    const auto size = [&](int element) {
      return elements[static_cast<std::size_t>(element)].box.size()[static_cast<int>(axis)];
    };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size(a) < size(b); });
    for (const int index : order) {
      const Element& element = elements[static_cast<std::size_t>(index)];
      const int part = element.parts.front();
      if (element.shape == nullptr || fitted.count(part) != 0) continue;
      if (element.pattern && LeadsAlong(*element.pattern, static_cast<int>(axis))) continue;
      const auto kept = precautions.shares_kept.find({part, axis});
      LevelHolder(assembly, elements, neighbours, index, axis, tolerance,
                  kept == precautions.shares_kept.end() ? kAll : kept->second, round_faces)
          .Hold(held);
    }
  }
  for (Element& element : elements) DivideShape(element);
  return held;
}

std::set<int> RowsInBoresOfOne(const Assembly& assembly, const std::vector<Element>& elements,
                               double tolerance) {
  const std::vector<int> element_of = ElementsOfParts(assembly, elements);
  std::set<int> rows;  // elements
  RoundFaces round_faces;
  for (const AssemblyPart& bored : assembly.parts) {
    if (bored.shape == nullptr) continue;
    std::map<int, std::set<std::size_t>> within;  // parts, by their element
    for (const mesh::RoundFace& face : round_faces.Of(*bored.shape)) {
      if (!face.is_hollow || !face.is_whole) continue;
      const BoundingBox bore = BoxOf(bored, face);
      for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
        const AssemblyPart& part = assembly.parts[i];
        if (&part == &bored || !LiesIn(part.box, bore, face.axis, tolerance)) continue;
        within[element_of[i]].insert(i);
      }
    }
    for (const auto& [element, parts] : within) {
      if (parts.size() > 1) rows.insert(element);
    }
  }
  std::set<int> found;
  for (const int row : rows) {
    const std::vector<int>& parts = elements[static_cast<std::size_t>(row)].parts;
    found.insert(parts.begin(), parts.end());
  }
  return found;
}

std::vector<Relationship> KeepRound(const Assembly& assembly, const std::vector<Element>& elements,
                                    double tolerance) {
  std::vector<Relationship> kept;
  RoundFaces round_faces;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Element& element = elements[e];
    const AssemblyPart& part = assembly.parts[static_cast<std::size_t>(element.parts.front())];
    if (part.shape == nullptr) continue;
    const Eigen::Vector3d size = part.box.size();
    for (const mesh::RoundFace& face : round_faces.Of(*part.shape)) {
      const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;
      if (face.is_hollow || !face.is_whole) continue;
      const auto is_across = [&](int axis) {
        return std::abs(2 * face.radius - part.shape->size[axis]) <= tolerance;
      };
      if (!is_across(a) || !is_across(b) || std::abs(size[a] - size[b]) > tolerance) continue;
      if (element.pattern && (LeadsAlong(*element.pattern, a) || LeadsAlong(*element.pattern, b))) {
        continue;
      }
      const int index = static_cast<int>(e);
      LinearForm form = LinearForm::Variable(SizeVariable(index, static_cast<Axis>(a))) -
                        LinearForm::Variable(SizeVariable(index, static_cast<Axis>(b)));
      form.constant = size[b] - size[a];
      kept.push_back({RelationshipKind::kProportion, true, std::move(form), element.group,
                      absl::StrCat("'", element.name, "' stays round about ",
                                   AxisName(static_cast<Axis>(face.axis)))});
      break;
    }
  }
  return kept;
}

}  // namespace mortise::parametric
