// Whatever somebody draws of rails, slats, screws, pegs, posts and lids: each of its designs holds
// together as it was drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "common/assembly/model/rest_pose.h"
#include "common/assembly/parametric_assembly.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

// Draws something of a seed.
class Draughtsman {
 public:
  explicit Draughtsman(std::uint64_t seed) : random_(seed) {}

  Assembly Draw() {
    assembly_ = Named("drawn", {});
    assembly_.groups.push_back({"lid", 0});
    DrawRails();
    const int slats = DrawSlats();
    DrawScrews(slats);
    if (OneIn(2)) DrawPegs();
    if (OneIn(3)) DrawOn(slats);
    if (OneIn(3)) DrawBetween(slats);
    if (OneIn(2)) DrawLid();
    return assembly_;
  }

 private:
  bool OneIn(int count) { return std::uniform_int_distribution<int>(1, count)(random_) == 1; }
  int Count(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  // To the millimetre, as people draw.
  double Length(double low, double high) {
    return std::round(1000 * std::uniform_real_distribution<double>(low, high)(random_)) / 1000;
  }

  AssemblyPart Add(const std::string& name, const std::string& item, const Eigen::Vector3d& minimum,
                   const Eigen::Vector3d& size, int group = 0) {
    AssemblyPart part = ResizablePart(name, minimum, minimum + size, group);
    part.item = "items/" + item;
    return part;
  }

  // Sizes that an item fixes, resizes, or leaves to the designer.
  void Limit(AssemblyPart& part, int kind) {
    for (int axis = 0; axis < 3; ++axis) {
      const double size = part.box.size()[axis];
      SizeLimits& limits = part.limits[static_cast<std::size_t>(axis)];
      if (kind == 0 || (kind == 1 && axis == 1)) limits = {size, size};
      if (kind == 3) limits = {1e-3, 10};
    }
  }

  void Keep(AssemblyPart part) { assembly_.parts.push_back(std::move(part)); }

  void DrawRails() {
    length_ = Length(1, 2.5);
    const int kind = Count(1, 3);
    for (const double x : {0.0, 0.96}) {
      AssemblyPart rail =
          Add(absl::StrCat("rail ", x > 0 ? 2 : 1), "rail", {x, 0, 0}, {0.04, length_, 0.1});
      Limit(rail, kind);
      Keep(rail);
    }
  }

  // Across both rails; they may stand beyond their ends.
  int DrawSlats() {
    const int count = Count(3, 7);
    first_ = OneIn(4) ? -Length(0.01, 0.04) : Length(0, 0.1);
    const double room = length_ - first_ + (OneIn(4) ? Length(0, 0.04) : -Length(0, 0.1));
    spacing_ = std::round(1000 * room / count) / 1000;
    width_ = OneIn(5) ? spacing_ : Length(0.3, 0.9) * spacing_;
    const int kind = Count(0, 3);
    for (int i = 0; i < count; ++i) {
      AssemblyPart slat = Add(absl::StrCat("slat ", i + 1), "slat", {0, first_ + i * spacing_, 0.1},
                              {1, width_, 0.02});
      Limit(slat, kind);
      Keep(slat);
    }
    return count;
  }

  // In all slats, in every second or in one.
  void DrawScrews(int slats) {
    const int step = Count(0, 3);
    const double within = Length(0.1, 0.8) * width_;
    for (int i = step == 3 ? Count(0, slats - 1) : 0; step > 0 && i < slats;
         i += step == 3 ? slats : step) {
      AssemblyPart screw = Add(absl::StrCat("screw ", i + 1), "screw",
                               {0.01, first_ + i * spacing_ + within, 0.07}, {0.004, 0.004, 0.05});
      screw.connecting = true;
      Limit(screw, 0);
      Keep(screw);
    }
  }

  // A board beside the rails with a grid of pegs that may reach over its edges.
  void DrawPegs() {
    AssemblyPart board = Add("board", "board", {1, 0, 0}, {0.02, length_, 0.6});
    Limit(board, Count(0, 3));
    Keep(board);
    const int along = Count(3, 5), up = Count(3, 4), kind = Count(0, 3);
    const double first = Length(0.01, 0.2), last = length_ - Length(-0.01, 0.2);
    const double apart = (last - first) / (along - 1);
    const double above = Length(0.13, 0.2), rise = Length(0.08, 0.15);
    for (int i = 0; i < up; ++i) {
      for (int j = 0; j < along; ++j) {
        AssemblyPart peg = Add(absl::StrCat("peg ", i + 1, ".", j + 1), "peg",
                               {1.02, first + j * apart, above + i * rise}, {0.1, 0.02, 0.02});
        Limit(peg, kind);
        Keep(peg);
      }
    }
  }

  // Something on one slat or on several.
  void DrawOn(int slats) {
    const int on = Count(0, slats - 1);
    AssemblyPart box = Add("box", "box", {Length(0.1, 0.4), first_ + on * spacing_, 0.12},
                           {0.3, OneIn(2) ? width_ : Length(0.05, 0.6), 0.2});
    Limit(box, Count(0, 3));
    Keep(box);
  }

  // A post in the gap behind a slat.
  void DrawBetween(int slats) {
    const double gap = spacing_ - width_;
    if (gap < 0.03) return;
    const int behind = Count(0, slats - 2);
    AssemblyPart post =
        Add("post", "post", {0.005, first_ + behind * spacing_ + width_ + 0.005, 0.1},
            {0.03, gap - 0.01, 0.4});
    Limit(post, Count(0, 3));
    Keep(post);
  }

  // Behind the rails, on a hinge; open at any angle.
  void DrawLid() {
    AssemblyPart lid = Add("lid", "lid", {0, length_, 0.08}, {1, Length(0.2, 0.5), 0.02}, 1);
    Limit(lid, Count(0, 3));
    Keep(lid);
    Joint hinge;
    hinge.name = "hinge";
    hinge.kind = JointKind::kHinge;
    hinge.group = 1;
    hinge.center = {0.5, length_, 0.1};
    hinge.axis = {1, 0, 0};
    hinge.upper = 3.1;
    assembly_.joints.push_back(hinge);
    if (OneIn(2)) {
      for (int i = 0; i < 5; ++i) {
        SetPose(Length(0.5, 3));
        if (IsClear()) return;
      }
    }
    SetPose(std::acos(-1.0) / 2);
  }

  void SetPose(double angle) {
    assembly_.joints[0].rest_poses = {{"open", angle * assembly_.joints[0].axis}};
  }

  // Whether the lid, the last part, runs into nothing when it is open.
  bool IsClear() const {
    const std::vector<Element> elements = MakeElements(assembly_, 1e-6, {{}, AllParts()});
    const Eigen::VectorXd q = DrawnParameters(assembly_, elements);
    const Pose open = PosesOf(assembly_)[1];
    const int lid = static_cast<int>(elements.size()) - 1;
    for (int e = 0; e < lid; ++e) {
      if (Separation(BoxIn(open, assembly_, elements, e, q),
                     BoxIn(open, assembly_, elements, lid, q)) < 0) {
        return false;
      }
    }
    return true;
  }

  std::set<int> AllParts() const {
    std::set<int> all;
    for (std::size_t i = 0; i < assembly_.parts.size(); ++i) all.insert(static_cast<int>(i));
    return all;
  }

  std::mt19937_64 random_;
  Assembly assembly_;
  double length_ = 0;
  double first_ = 0;
  double spacing_ = 0;
  double width_ = 0;
};

TEST(RandomDesigns, HoldTogetherAsDrawn) {
  constexpr int kDrawings = 150;
  int parametrised = 0;
  for (int seed = 0; seed < kDrawings; ++seed) {
    const Assembly drawn = Draughtsman(static_cast<std::uint64_t>(seed)).Draw();
    const auto assembly = ParametricAssembly::Create(drawn);
    if (DetailOf(assembly.status()).reason == "FEASIBLE_SET_UNBOUNDED") continue;
    ASSERT_OK(assembly.status()) << seed;
    ++parametrised;
    ASSERT_OK_AND_ASSIGN(std::vector<Eigen::VectorXd> designs, assembly->Sample(40, 3));
    ASSERT_OK_AND_ASSIGN(const std::vector<Eigen::VectorXd> corners,
                         assembly->feasible_set().Corners(40, 5));
    designs.insert(designs.end(), corners.begin(), corners.end());
    int at_fault = 0;
    std::string example;
    for (const Eigen::VectorXd& q : designs) {
      if (!assembly->CheckParameters(q).ok()) continue;  // more parts than anybody may ask for
      ASSERT_OK_AND_ASSIGN(const std::vector<ContactFault> faults, assembly->FaultsAt(q));
      if (faults.empty()) continue;
      ++at_fault;
      example = Describe(faults.front());
    }
    EXPECT_EQ(at_fault, 0) << "drawing " << seed << ": " << example;
  }
  EXPECT_GE(parametrised, kDrawings / 2);
}

}  // namespace
}  // namespace mortise::parametric
