#include "common/assembly/relations/feature_anchors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/bores.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/relations/element_along.h"
#include "common/assembly/relations/fit_spans.h"
#include "common/mesh/shapes/shape_levels.h"

namespace mortise::parametric {
namespace {

constexpr double kMinShare = 0.5;  // of what lies between held levels, as drawn
constexpr double kMaxAlone = 0.5;  // a blind bore with nothing in it against its element
constexpr int kAll = std::numeric_limits<int>::max();

// Holds the levels of one element along one axis.
class LevelHolder {
 public:
  LevelHolder(const Assembly& assembly, std::vector<Element>& elements,
              const std::set<std::pair<int, int>>& neighbours, int element, Axis axis,
              double tolerance, int shares_kept)
      : assembly_(assembly),
        elements_(elements),
        along_(assembly, elements, neighbours, element, axis, tolerance),
        shares_kept_(shares_kept) {}

  void Hold(ShapeFeatures& known, FeatureAnchors& held) {
    if (along_.dividing().empty()) return;
    spans_ = FindFitSpans(along_, known);
    for (const FitSpan& span : spans_) {
      if (span.by < 0) continue;
      Add(span.low, span.low_place);
      Add(span.high, span.high_place);
    }
    HoldEnds();
    HoldDepths(BoresOf(along_.part(), known));
    HoldEmpty();
    if (Levels().empty()) return;
    KeepShares(held);
    KeepDistances(held);
  }

 private:
  int Index() const { return static_cast<int>(along_.axis()); }
  std::vector<FeatureAnchor>& Levels() {
    return elements_[static_cast<std::size_t>(along_.index())]
        .feature_anchors[static_cast<std::size_t>(Index())];
  }

  void Add(double at, LinearForm place) {
    const std::optional<double> fraction = along_.DividingAt(at);
    std::vector<FeatureAnchor>& levels = Levels();
    const auto behind = std::find_if(levels.begin(), levels.end(), [&](const FeatureAnchor& level) {
      return level.fraction >= *fraction;
    });
    if (behind != levels.end() && behind->fraction == *fraction) return;
    levels.insert(behind, {*fraction, std::move(place)});
  }

  bool IsInSpan(double at) const {
    return std::any_of(spans_.begin(), spans_.end(), [&](const FitSpan& span) {
      return at >= span.low - along_.tolerance() && at <= span.high + along_.tolerance();
    });
  }

  // Where a share of the element is, in proportion to what of it is held so far.
  LinearForm ShareOf(double fraction) const {
    return PositionOf(elements_, along_.index(), {"", along_.axis(), fraction, false});
  }
  // The same, were it stretched as a whole.
  LinearForm PlainShareOf(double fraction) const {
    return PositionOf(along_.index(), {"", along_.axis(), fraction, false});
  }

  // Shoulders against what the element enters, and bottoms of what is let into it.
  void HoldEnds() {
    const int element = along_.index();
    for (int other = 0; other < std::ssize(elements_); ++other) {
      if (!along_.IsNeighbour(other)) continue;
      const bool is_shorter =
          along_.At(other).box.size()[Index()] < along_.size() - along_.tolerance();
      const bool enters = is_shorter && along_.Enters(element, other);
      if (!enters && !(along_.Overlaps(other) && along_.Enters(other, element))) continue;
      for (const bool upper : {false, true}) {
        const DrawnPlace face = along_.BoxFace(other, upper);
        for (const double fraction : along_.dividing()) {
          const double at = along_.PlaceOf(fraction);
          if (std::abs(at - face.at) > along_.NearTo(other) || IsInSpan(at)) continue;
          Add(at, along_.AtDrawnDistance(other, face, at));
          if (ends_.insert(fraction).second && !enters) bottoms_.emplace_back(fraction, other);
        }
      }
    }
  }

  // ---- Bores with nothing in them, or nothing at their bottom

  // A blind bore is as deep as it is drawn, from the face of the box where it begins.
  void HoldDepths(const std::vector<Bore>& bores) {
    for (const Bore& bore : bores) {
      if (bore.axis != Index()) continue;
      for (const bool upper : {false, true}) {
        const DrawnPlace begin = along_.BoxFace(along_.index(), upper);
        const double mouth = (upper ? bore.box.maximum : bore.box.minimum)[Index()];
        const double bottom = (upper ? bore.box.minimum : bore.box.maximum)[Index()];
        const std::optional<double> fraction = along_.DividingAt(bottom);
        if (!fraction || std::abs(mouth - begin.at) > along_.tolerance() || IsInSpan(bottom) ||
            std::abs(bottom - begin.at) > kMaxAlone * along_.size()) {
          continue;
        }
        Add(bottom, along_.AtDrawnDistance(along_.index(), begin, bottom));
        ends_.insert(*fraction);
      }
    }
  }

  void HoldEmpty() {
    std::vector<std::pair<const FitSpan*, LinearForm>> middles;
    for (const FitSpan& span : spans_) {
      if (span.by >= 0 || HoldsWithin(span)) continue;
      middles.emplace_back(&span, ShareOf(along_.FractionAt((span.low + span.high) / 2)));
    }
    for (auto& [span, middle] : middles) {
      LinearForm low = middle, high = middle;
      low.constant -= span->length() / 2;
      high.constant += span->length() / 2;
      Add(span->low, std::move(low));
      Add(span->high, std::move(high));
    }
  }

  bool HoldsWithin(const FitSpan& span) {
    return std::any_of(Levels().begin(), Levels().end(), [&](const FeatureAnchor& level) {
      const double at = along_.PlaceOf(level.fraction);
      return at > span.low - along_.tolerance() && at < span.high + along_.tolerance();
    });
  }

  // ---- Relationships

  void Relate(RelationshipKind kind, bool equality, LinearForm form, std::string description,
              FeatureAnchors& held) const {
    if (form.terms.empty()) return;
    if (equality) form.constant -= form.At(DrawnParameters(assembly_, elements_));
    const int group =
        GroupIn(Pose{}, assembly_, elements_, along_.element(), along_.element(), form);
    held.relationships.push_back({kind, equality, std::move(form), group, std::move(description)});
  }

  std::string Label() const { return absl::StrCat("'", along_.element().name, "'"); }

  // Middles of what fits in, and bottoms, stay where they are in proportion.
  void KeepShares(FeatureAnchors& held) const {
    int kept = 0;
    const auto keep = [&](int other, const LinearForm& place, double fraction) {
      ++held.fits[{along_.element().parts.front(), along_.axis()}];
      if (kept >= shares_kept_) return;
      ++kept;
      Relate(RelationshipKind::kProportion, true, place - PlainShareOf(fraction),
             absl::StrCat("'", along_.At(other).name, "' at its share of ", Label(), " along ",
                          AxisName(along_.axis())),
             held);
    };
    for (const FitSpan& span : spans_) {
      if (span.by < 0) continue;
      keep(span.by, Combine(0.5, span.low_place, 0.5, span.high_place),
           along_.FractionAt((span.low + span.high) / 2));
    }
    for (const auto& [fraction, other] : bottoms_) keep(other, ShareOf(fraction), fraction);
  }

  bool IsSpan(double from, double to) const {
    const auto is_at = [&](double fraction, double at) {
      return std::abs(along_.PlaceOf(fraction) - at) <= along_.tolerance();
    };
    return std::any_of(spans_.begin(), spans_.end(), [&](const FitSpan& span) {
      return is_at(from, span.low) && is_at(to, span.high);
    });
  }

  void KeepDistances(FeatureAnchors& held) {
    std::vector<FeatureAnchor> ends = Levels();
    ends.insert(ends.begin(), {-0.5, PlainShareOf(-0.5)});
    ends.push_back({0.5, PlainShareOf(0.5)});
    const LinearForm size = LinearForm::Variable(SizeVariable(along_.index(), along_.axis()));
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const FeatureAnchor& low = ends[i];
      const FeatureAnchor& high = ends[i + 1];
      if (IsSpan(low.fraction, high.fraction)) continue;
      const double share = kMinShare * (high.fraction - low.fraction);
      const bool is_tenon = (i == 0 && ends_.count(high.fraction) != 0) ||
                            (i + 2 == ends.size() && ends_.count(low.fraction) != 0);
      LinearForm form = low.place - high.place;
      if (is_tenon) {
        form.constant += share * along_.size();
      } else {
        form = Combine(1, form, share, size);
      }
      Relate(RelationshipKind::kOrder, false, std::move(form),
             absl::StrCat(Label(), " keeps something of what lies between two places along ",
                          AxisName(along_.axis())),
             held);
    }
  }

  const Assembly& assembly_;
  std::vector<Element>& elements_;
  const ElementAlong along_;
  const int shares_kept_;
  std::vector<FitSpan> spans_;
  std::set<double> ends_;                        // fractions of shoulders and bottoms
  std::vector<std::pair<double, int>> bottoms_;  // fractions, and what is let in
};

void DivideShape(Element& element) {
  std::vector<mesh::ShapeLevel> levels;
  for (int axis = 0; axis < 3; ++axis) {
    for (const FeatureAnchor& level : element.feature_anchors[static_cast<std::size_t>(axis)]) {
      levels.push_back({axis, level.fraction, true});
    }
  }
  if (levels.empty()) return;
  element.shape = std::make_shared<const mesh::DrawnShape>(mesh::DividedAt(*element.shape, levels));
}

}  // namespace

FeatureAnchors AnchorFeatures(const Assembly& assembly, std::vector<Element>& elements,
                              const Contacts& contacts, double tolerance,
                              const KnownConflicts& known_conflicts, ShapeFeatures& known) {
  std::set<int> fitted;  // parts
  for (const PosedPair& pair : known_conflicts.fitted) fitted.insert({pair.first, pair.second});
  const std::set<std::pair<int, int>> neighbours = NeighboursOf(elements, contacts, tolerance);
  FeatureAnchors held;
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
      const auto kept = known_conflicts.shares_kept.find({part, axis});
      LevelHolder(assembly, elements, neighbours, index, axis, tolerance,
                  kept == known_conflicts.shares_kept.end() ? kAll : kept->second)
          .Hold(known, held);
    }
  }
  for (Element& element : elements) DivideShape(element);
  return held;
}

std::vector<Relationship> KeepRound(const Assembly& assembly, const std::vector<Element>& elements,
                                    double tolerance, ShapeFeatures& known) {
  std::vector<Relationship> kept;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Element& element = elements[e];
    const AssemblyPart& part = assembly.parts[static_cast<std::size_t>(element.parts.front())];
    if (part.shape == nullptr) continue;
    const Eigen::Vector3d size = part.box.size();
    for (const mesh::RoundFace& face : known.RoundFacesOf(*part.shape)) {
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
