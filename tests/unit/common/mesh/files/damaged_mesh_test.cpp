// Mesh files with random damage: each is refused, or gives what the whole file gives, or a note
// says what is amiss. MORTISE_DAMAGED_FILES sets how many files are tried, 180 if it does not; the
// sums are printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/files/grouped_mesh.h"
#include "tests/support/file_damage.h"
#include "tests/support/mesh_files.h"

namespace mortise::mesh {
namespace {

using testing::Damage;

int FilesToTry() {
  const char* const wanted = std::getenv("MORTISE_DAMAGED_FILES");
  return wanted == nullptr ? 180 : std::max(1, std::atoi(wanted));
}

// What a mesh holds, as far as it can become less.
struct Holdings {
  Eigen::Index elements = 0, nodes = 0;
  std::map<std::string, std::size_t> groups;  // members, by kind and name
  double volume = 0;
  bool is_inverted = false;  // analyses refuse it
  std::set<std::string> notes;
};

Holdings HoldingsOf(const GroupedMesh& mesh) {
  Holdings holdings;
  holdings.elements = mesh.tetrahedra.cols();
  holdings.nodes = mesh.nodes.cols();
  for (const auto& group : mesh.element_groups) {
    holdings.groups["elements " + group.name] = group.members.size();
  }
  for (const auto& group : mesh.face_groups) {
    holdings.groups["faces " + group.name] = group.members.size();
  }
  for (const auto& group : mesh.node_groups) {
    holdings.groups["nodes " + group.name] = group.members.size();
  }
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return mesh.nodes.col(mesh.tetrahedra(k, e));
    };
    const Eigen::Vector3d a = corner(1) - corner(0), b = corner(2) - corner(0);
    const double volume = a.cross(b).dot(corner(3) - corner(0)) / 6;
    holdings.is_inverted = holdings.is_inverted || !(volume > 0);
    holdings.volume += volume;
  }
  holdings.notes.insert(mesh.notes.begin(), mesh.notes.end());
  return holdings;
}

// What is less than in the whole file; empty for nothing.
std::string LessOf(const Holdings& damaged, const Holdings& whole) {
  if (damaged.elements < whole.elements) return "elements";
  if (damaged.nodes < whole.nodes) return "nodes";
  // One that is called otherwise is not less; who names it is told.
  if (damaged.groups.size() < whole.groups.size()) return "groups";
  for (const auto& [name, members] : whole.groups) {
    const auto found = damaged.groups.find(name);
    if (found != damaged.groups.end() && found->second < members) return "members";
  }
  return damaged.volume < whole.volume * (1 - 1e-9) ? "volume" : "";
}

bool HasNewNote(const Holdings& damaged, const Holdings& whole) {
  return std::any_of(damaged.notes.begin(), damaged.notes.end(),
                     [&](const std::string& note) { return !whole.notes.contains(note); });
}

bool IsLostMember(const std::string& name, const std::string& less) {
  return name.starts_with("inp") && (less == "members" || less == "groups");
}

std::map<std::string, std::string> WholeFiles() {
  std::map<std::string, std::string> files;
  for (const bool is_quadratic : {false, true}) {
    const GroupedMesh box = testing::GroupedBox({1, 2, 1}, {2, 2, 1}, is_quadratic);
    const std::string order = is_quadratic ? " quadratic" : "";
    for (const bool is_binary : {false, true}) {
      const std::string form = absl::StrCat(is_binary ? " binary" : " text", order);
      files["msh 2.2" + form] = testing::WriteGmsh22(box, is_binary);
      files["msh 4.1" + form] = testing::WriteGmsh41(box, is_binary);
    }
    files["inp" + order] = testing::WriteAbaqus(box);
  }
  return files;
}

TEST(DamagedMeshes, AreRefusedOrWholeOrNoted) {
  const std::map<std::string, std::string> files = WholeFiles();
  std::mt19937 random(34);
  std::map<std::string, int> outcomes;
  double longest = 0;
  const int count = FilesToTry();
  for (int i = 0; i < count; ++i) {
    const auto& [name, file] = *std::next(files.begin(), i % static_cast<int>(files.size()));
    const auto whole = ReadGroupedMesh(file);
    ASSERT_TRUE(whole.ok()) << name << ": " << whole.status();
    const auto damage = static_cast<Damage>(random() % testing::kDamages);
    const std::string damaged = testing::Damaged(file, damage, random);
    const auto begin = std::chrono::steady_clock::now();
    const auto mesh = ReadGroupedMesh(damaged);
    longest = std::max(
        longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    if (!mesh.ok()) {
      EXPECT_EQ(DetailOf(mesh.status()).field, "mesh_file") << name << ": " << mesh.status();
      ++outcomes["refused"];
      continue;
    }
    const Holdings before = HoldingsOf(*whole), after = HoldingsOf(*mesh);
    const std::string less = LessOf(after, before);
    const bool is_untold = !after.is_inverted && !less.empty() && !HasNewNote(after, before);
    // Abaqus' lists of members tell nothing of what was in them: a file without some of their lines
    // is a file that somebody may have written.
    EXPECT_FALSE(is_untold && !IsLostMember(name, less))
        << name << ": " << NameOf(damage) << ": less " << less;
    if (after.is_inverted) {
      ++outcomes["refused by analyses: inverted"];
    } else if (less.empty()) {
      ++outcomes["read whole"];
    } else if (HasNewNote(after, before)) {
      ++outcomes["read with less and a note"];
    } else {
      ++outcomes[absl::StrCat("read with less ", less, " and no note: ", name, ", ",
                              NameOf(damage))];
    }
  }
  for (const auto& [outcome, times] : outcomes) std::cout << outcome << ": " << times << "\n";
  std::cout << "longest: " << longest << " s\n";
}

}  // namespace
}  // namespace mortise::mesh
