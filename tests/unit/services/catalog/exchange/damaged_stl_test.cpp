// STL files: what is read of them, and files with random damage, each of which is refused, or
// gives the whole solid, or a note says what was repaired. MORTISE_DAMAGED_FILES sets how many
// are tried, 60 if it does not; the sums are printed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/mesh/files/stl.h"
#include "services/catalog/exchange/shape_import.h"
#include "tests/support/file_damage.h"

namespace mortise::catalog {
namespace {

using ::mortise::testing::Damage;
using ::testing::HasSubstr;

// A lens of two fans around its axis.
mesh::SurfaceMesh Lens(int sides) {
  mesh::SurfaceMesh lens;
  lens.vertices.resize(3, sides + 2);
  lens.triangles.resize(3, 2 * sides);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * M_PI * i / sides;
    lens.vertices.col(i) << 0.1 * std::cos(angle), 0.1 * std::sin(angle), 0;
    lens.triangles.col(2 * i) << i, (i + 1) % sides, sides;
    lens.triangles.col(2 * i + 1) << (i + 1) % sides, i, sides + 1;
  }
  lens.vertices.col(sides) << 0, 0, 0.05;
  lens.vertices.col(sides + 1) << 0, 0, -0.05;
  return lens;
}

std::string TextStl(const mesh::SurfaceMesh& surface) {
  std::string text = "solid lens of a test\n";
  for (const auto& triangle : surface.triangles.colwise()) {
    absl::StrAppend(&text, "  facet normal 0 0 0\n    outer loop\n");
    for (const int v : triangle) {
      absl::StrAppend(&text, "      vertex");
      for (const double x : surface.vertices.col(v)) absl::StrAppend(&text, " ", 1e3 * x);
      absl::StrAppend(&text, "\n");
    }
    absl::StrAppend(&text, "    endloop\n  endfacet\n");
  }
  return absl::StrCat(text, "endsolid lens of a test\n");
}

std::string Refusal(const std::string& bytes) {
  const auto surface = ReadStl(bytes);
  EXPECT_FALSE(surface.ok());
  EXPECT_EQ(DetailOf(surface.status()).field, "file");
  return std::string(surface.status().message());
}

TEST(StlFiles, TextIsReadWholeOrNotAtAll) {
  const std::string text = TextStl(Lens(6));
  const auto surface = ReadStl(text);
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->triangles.cols(), 12);
  EXPECT_EQ(ReadStl(absl::StrCat(text, text))->triangles.cols(), 24);
  const std::size_t half = text.find("  facet", text.size() / 2);
  EXPECT_THAT(Refusal(text.substr(0, half)), HasSubstr("is cut off"));
  EXPECT_THAT(Refusal(absl::StrReplaceAll(text, {{"vertex 100 0 0", "vertxe 100 0 0"}})),
              HasSubstr("has another word where vertex must come"));
  EXPECT_THAT(Refusal(absl::StrReplaceAll(text, {{"vertex 100 0 0", "vertex 0x64 0 0"}})),
              HasSubstr("a vertex without three numbers"));
  EXPECT_THAT(Refusal(absl::StrReplaceAll(text, {{"vertex 100 0 0", "vertex 1e99 0 0"}})),
              HasSubstr("not finite"));
}

TEST(StlFiles, MayBeginWithAByteOrderMark) {
  const std::string text = TextStl(Lens(6));
  const auto surface = ReadStl(absl::StrCat("\xEF\xBB\xBF", text));
  ASSERT_TRUE(surface.ok()) << surface.status();
  EXPECT_EQ(surface->triangles.cols(), 12);
  std::string wide;
  for (const char c : text) wide += {c, '\0'};
  EXPECT_THAT(Refusal(wide), HasSubstr("is UTF-16, not UTF-8"));
}

TEST(StlFiles, DamageIsRefusedOrNoted) {
  const mesh::SurfaceMesh lens = Lens(40);
  const auto binary = mesh::WriteStl(lens, "lens");
  ASSERT_TRUE(binary.ok());
  const std::map<std::string, std::string> files = {{"binary", *binary}, {"text", TextStl(lens)}};
  const char* const wanted = std::getenv("MORTISE_DAMAGED_FILES");
  const int count = wanted == nullptr ? 60 : std::max(1, std::atoi(wanted));
  std::mt19937 random(34);
  std::map<std::string, int> outcomes;
  double longest = 0;
  for (int i = 0; i < count; ++i) {
    const auto& [name, file] = *std::next(files.begin(), i % 2);
    const double whole = ShapeOfStl(file)->shape.volume;
    const auto damage = static_cast<Damage>(random() % mortise::testing::kDamages);
    const std::string damaged = mortise::testing::Damaged(file, damage, random);
    const auto begin = std::chrono::steady_clock::now();
    const auto shape = ShapeOfStl(damaged);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    longest = std::max(longest, time.count());
    if (!shape.ok()) {
      ++outcomes["refused"];
      continue;
    }
    const bool is_less = shape->shape.volume < whole * (1 - 1e-9);
    EXPECT_FALSE(is_less && shape->notes.empty()) << name << ": " << NameOf(damage);
    ++outcomes[!is_less               ? "read whole"
               : shape->notes.empty() ? "read with less and no note"
                                      : "read with less and a note"];
  }
  for (const auto& [outcome, times] : outcomes) std::cout << outcome << ": " << times << "\n";
  std::cout << "longest: " << longest << " s\n";
}

}  // namespace
}  // namespace mortise::catalog
