#include "services/composer/holding/bearing_surfaces.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::AssemblyPart;
using parametric::BoundingBox;

constexpr double kThin = 0.5;       // of its length and width
constexpr double kLevel = 1e-3;     // m
constexpr double kLiesOn = 0.01;    // m, above a surface: what is no higher covers it
constexpr double kUncovered = 0.5;  // of a surface
constexpr double kTogether = 0.4;   // of the box around boards of one surface
constexpr double kMinSide = 0.1;    // m, of a surface
constexpr double kHeadroom = 0.6;   // m, above what is sat on, and what is no shelf
constexpr double kLowestSeat = 0.35, kHighestSeat = 0.52;  // m

constexpr BearingLoad kLoads[] = {
    {1300, 0, "EN 12520, static load of a seat", 600, 0.06, "EN 1022, vertical force on a seat"},
    {2600, 0, "EN 14183, test load of a step", 1500, 0.05,
     "EN 14183, a person of 150 kg; where, our own"},
    {0, 1000, "our own: full of books", 0, 0, "our own: full of books, all else empty"},
    {1000, 0, "EN 12521, vertical static load of a table", 300, 0.05,
     "our own: somebody who leans on it"},
};

struct KindWords {
  std::optional<BearingKind> kind;  // nothing: no surface
  std::set<std::string> words;
};

const std::vector<KindWords>& Words() {
  static const auto* const all = new std::vector<KindWords>{
      {BearingKind::kSeat, {"seat", "bench"}},
      {BearingKind::kStep, {"step", "tread", "rung"}},
      {BearingKind::kShelf, {"shelf", "shelves", "bottom", "tray", "deck", "floor", "base"}},
      {BearingKind::kTop, {"top", "tabletop", "worktop", "desktop", "counter"}},
      {std::nullopt, {"back", "side", "door", "lid", "roof"}}};
  return *all;
}

std::set<std::string> WordsOf(const std::string& name) {
  std::set<std::string> words;
  std::string word;
  for (const char letter : absl::StrCat(absl::AsciiStrToLower(name), " ")) {
    if (std::isalpha(static_cast<unsigned char>(letter)) != 0) {
      word += letter;
    } else if (!word.empty()) {
      words.insert(std::move(word));
      word.clear();
    }
  }
  return words;
}

const KindWords* KindOfName(const std::string& name) {
  const std::set<std::string> words = WordsOf(name);
  for (const KindWords& kind : Words()) {
    for (const std::string& word : kind.words) {
      if (words.contains(word)) return &kind;
    }
  }
  return nullptr;
}

double CommonArea(const BoundingBox& a, const BoundingBox& b) {
  const Eigen::Vector3d common = a.maximum.cwiseMin(b.maximum) - a.minimum.cwiseMax(b.minimum);
  return std::max(common.x(), 0.0) * std::max(common.y(), 0.0);
}

double AreaOf(const BoundingBox& box) { return box.size().x() * box.size().y(); }

bool IsThin(const BoundingBox& box) {
  return box.size().z() <= kThin * std::min(box.size().x(), box.size().y());
}

class SurfaceSearch {
 public:
  SurfaceSearch(const Assembly& drawn, double floor) : drawn_(drawn), floor_(floor) {}

  std::vector<BearingSurface> Find() {
    std::vector<const AssemblyPart*> boards;
    for (const AssemblyPart& part : drawn_.parts) {
      if (!part.connecting && IsThin(part.box) && IsOpenAbove(part)) boards.push_back(&part);
    }
    std::set<const AssemblyPart*> taken;
    for (const AssemblyPart* const board : boards) {
      if (taken.contains(board)) continue;
      std::vector<const AssemblyPart*> level;
      for (const AssemblyPart* const other : boards) {
        if (!taken.contains(other) && AreLevel(*board, *other)) level.push_back(other);
      }
      taken.insert(level.begin(), level.end());
      if (Covers(level)) {
        Add(level);
      } else {
        for (const AssemblyPart* const each : level) Add({each});
      }
    }
    return std::move(found_);
  }

 private:
  static bool AreLevel(const AssemblyPart& a, const AssemblyPart& b) {
    return a.group == b.group && std::abs(a.box.maximum.z() - b.box.maximum.z()) <= kLevel;
  }

  bool IsOpenAbove(const AssemblyPart& part) const {
    double covered = 0;
    for (const AssemblyPart& other : drawn_.parts) {
      const double above = other.box.minimum.z() - part.box.maximum.z();
      if (&other == &part || other.connecting || above < -kLevel || above > kLiesOn) continue;
      covered += CommonArea(part.box, other.box);
    }
    return covered < kUncovered * AreaOf(part.box);
  }

  static BoundingBox TopOf(const std::vector<const AssemblyPart*>& boards) {
    BoundingBox box = boards.front()->box;
    for (const AssemblyPart* const board : boards) {
      box.minimum = box.minimum.cwiseMin(board->box.minimum);
      box.maximum = box.maximum.cwiseMax(board->box.maximum);
    }
    box.minimum.z() = box.maximum.z();
    return box;
  }

  static double AreaOfAll(const std::vector<const AssemblyPart*>& boards) {
    double area = 0;
    for (const AssemblyPart* const board : boards) area += AreaOf(board->box);
    return area;
  }

  static bool Covers(const std::vector<const AssemblyPart*>& boards) {
    return AreaOfAll(boards) >= kTogether * AreaOf(TopOf(boards));
  }

  void Add(const std::vector<const AssemblyPart*>& boards) {
    BearingSurface surface;
    surface.box = TopOf(boards);
    surface.area = AreaOfAll(boards);
    if (surface.box.size().head<2>().minCoeff() < kMinSide) return;
    for (const AssemblyPart* const board : boards) surface.parts.push_back(board->name);
    if (SetKind(*boards.front(), surface)) found_.push_back(std::move(surface));
  }

  // Whether it is a surface at all.
  bool SetKind(const AssemblyPart& board, BearingSurface& surface) const {
    if (const KindWords* const named = KindOfName(board.name)) {
      surface.because = "by its name";
      surface.kind = named->kind.value_or(BearingKind::kTop);
      return named->kind.has_value();
    }
    for (int group = board.group; group > 0;
         group = drawn_.groups[static_cast<std::size_t>(group)].parent) {
      const std::string& name = drawn_.groups[static_cast<std::size_t>(group)].name;
      const KindWords* const named = KindOfName(name);
      if (named == nullptr || !named->kind) continue;
      surface.because = absl::StrCat("by the name of its group '", name, "'");
      surface.kind = *named->kind;
      return true;
    }
    const double height = surface.box.maximum.z() - floor_;
    surface.because = absl::StrFormat("by its height of %.2f m", height);
    if (!HasHeadroom(surface)) {
      surface.kind = BearingKind::kShelf;
      surface.because += ", under something else";
    } else {
      surface.kind =
          height >= kLowestSeat && height <= kHighestSeat ? BearingKind::kSeat : BearingKind::kTop;
    }
    return true;
  }

  bool HasHeadroom(const BearingSurface& surface) const {
    double covered = 0;
    for (const AssemblyPart& other : drawn_.parts) {
      const double above = other.box.minimum.z() - surface.box.maximum.z();
      if (other.connecting || above < -kLevel || above > kHeadroom) continue;
      covered += CommonArea(surface.box, other.box);
    }
    return covered < kUncovered * AreaOf(surface.box);
  }

  const Assembly& drawn_;
  const double floor_;
  std::vector<BearingSurface> found_;
};

}  // namespace

const char* BearingKindName(BearingKind kind) {
  constexpr const char* kNames[] = {"seat", "step", "shelf", "top"};
  return kNames[static_cast<std::size_t>(kind)];
}

const BearingLoad& LoadOf(BearingKind kind) { return kLoads[static_cast<std::size_t>(kind)]; }

std::vector<BearingSurface> FindBearingSurfaces(const Assembly& drawn, double floor) {
  return SurfaceSearch(drawn, floor).Find();
}

}  // namespace mortise::composer
