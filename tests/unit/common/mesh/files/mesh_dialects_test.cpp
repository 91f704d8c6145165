// Mesh files as people and other programs write them: read as they are meant, or refused by name
// and line; never with less than they hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/mesh/files/grouped_mesh.h"

namespace mortise::mesh {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr char kNodes[] =
    "*NODE\n1, 0, 0, 0\n2, 10, 0, 0\n3, 10, 10, 0\n4, 0, 10, 0\n5, 0, 0, 10\n6, 10, 0, 10\n"
    "7, 10, 10, 10\n8, 0, 10, 10\n";
constexpr char kElements[] =
    "*ELEMENT, TYPE=C3D4, ELSET=cube\n1, 1, 2, 3, 7\n2, 1, 3, 4, 7\n3, 1, 4, 8, 7\n"
    "4, 1, 8, 5, 7\n5, 1, 5, 6, 7\n6, 1, 6, 2, 7\n";

std::string Cube() { return absl::StrCat(kNodes, kElements); }

std::string CubeWith(const std::string& from, const std::string& to) {
  const std::string changed = absl::StrReplaceAll(Cube(), {{from, to}});
  EXPECT_NE(changed, Cube()) << from;
  return changed;
}

GroupedMesh Read(const std::string& file) {
  const auto mesh = ReadGroupedMesh(file);
  EXPECT_TRUE(mesh.ok()) << mesh.status() << "\n" << file;
  return mesh.value_or(GroupedMesh());
}

std::string Refusal(const std::string& file) {
  const auto mesh = ReadGroupedMesh(file);
  EXPECT_FALSE(mesh.ok()) << file;
  EXPECT_EQ(DetailOf(mesh.status()).field, "mesh_file");
  return std::string(mesh.status().message());
}

template <typename Group>
auto Members(const std::vector<Group>& groups, const std::string& name) {
  for (const Group& group : groups) {
    if (group.name == name) return group.members;
  }
  ADD_FAILURE() << "no group " << name;
  return decltype(Group::members)();
}

TEST(MeshDialects, ACommaBehindAKeywordSwallowsNothing) {
  EXPECT_EQ(Read(CubeWith("ELSET=cube\n", "ELSET=cube,\n")).tetrahedra.cols(), 6);
  EXPECT_EQ(Read(CubeWith("*NODE\n", "*NODE,\n")).nodes.cols(), 8);
  // A line that only goes on with parameters, with blank lines and comments between.
  const GroupedMesh mesh = Read(CubeWith(", ELSET=cube\n", ",\n\n** the set\nELSET=cube,\n"));
  EXPECT_THAT(Members(mesh.element_groups, "cube"), SizeIs(6));
  // Half a loaded surface would be gone.
  const GroupedMesh loaded = Read(Cube() + "*SURFACE, NAME=top, TYPE=ELEMENT,\n5, S2\n4, S2\n");
  EXPECT_THAT(Members(loaded.face_groups, "top"), SizeIs(2));
  const GroupedMesh named = Read(Cube() + "*SURFACE, NAME=some,\ncube, S1\n*NSET, NSET=a,\n1, 2\n" +
                                 "*NSET, NSET=b,\nGENERATE\n1, 3\n*NSET, NSET=c,\na\n");
  EXPECT_THAT(Members(named.face_groups, "some"), SizeIs(6));
  EXPECT_THAT(Members(named.node_groups, "a"), ElementsAre(0, 1));
  EXPECT_THAT(Members(named.node_groups, "b"), ElementsAre(0, 1, 2));
  EXPECT_THAT(Members(named.node_groups, "c"), ElementsAre(0, 1));
  // Nor is a keyword swallowed.
  EXPECT_EQ(Read(Cube() + "*NSET, NSET=none,\n*NSET, NSET=all, ELSET=cube,\n").node_groups.size(),
            2u);
  // What is neither is refused at its line.
  EXPECT_THAT(Refusal(CubeWith("ELSET=cube\n", "ELSET=cube,\nfoo\n")), HasSubstr("line 11"));
}

TEST(MeshDialects, DataOfOtherFilesIsRefusedByName) {
  EXPECT_THAT(Refusal(CubeWith("*NODE\n", "*NODE, INPUT=nodes.txt\n")),
              HasSubstr("line 1: *NODE with INPUT"));
  EXPECT_THAT(Refusal(CubeWith("ELSET=cube", "ELSET=cube, INPUT=e.txt")),
              HasSubstr("line 10: *ELEMENT with INPUT"));
  EXPECT_THAT(Refusal(Cube() + "*NSET, NSET=a, INPUT=a.txt\n"), HasSubstr("line 17: *NSET with"));
  EXPECT_THAT(Refusal(Cube() + "*INSTANCE, NAME=a, LIBRARY=old\n"),
              HasSubstr("line 17: *INSTANCE with LIBRARY"));
}

TEST(MeshDialects, ParametersThatAreNotKnownAreRefusedByName) {
  EXPECT_THAT(Refusal(CubeWith("ELSET=cube", "ELSTE=cube")),
              HasSubstr("line 10: *ELEMENT with ELSTE is not read"));
  EXPECT_THAT(Refusal(CubeWith("ELSET=cube", "ELSET=cube, OFFSET=100")), HasSubstr("OFFSET"));
  EXPECT_THAT(Refusal(CubeWith("ELSET=cube", "ELSET=cube, elset=b")), HasSubstr("ELSET twice"));
  EXPECT_THAT(Refusal(CubeWith("ELSET=cube", "ELSET")), HasSubstr("ELSET without a value"));
  EXPECT_THAT(Refusal(Cube() + "*SURFACE, NAME=s, CROP\n1, S1\n"), HasSubstr("CROP"));
  EXPECT_THAT(Refusal(Cube() + "*SURFACE, NAME=s, COMBINE=UNION\na, b\n"), HasSubstr("COMBINE"));
  EXPECT_THAT(Refusal(Cube() + "*SURFACE, NAME=s\n1, S1, 4\n"), HasSubstr("line 18"));
  EXPECT_THAT(Refusal(Cube() + "*NSET, NSET=n, GENERATE\n1, 4, 1, 8\n"), HasSubstr("line 18"));
  // Those that change nothing.
  EXPECT_EQ(Read(CubeWith("*NODE\n", "*NODE, SYSTEM=R\n")).nodes.cols(), 8);
  EXPECT_THAT(Members(Read(Cube() + "*NSET, NSET=n, UNSORTED, INTERNAL\n4, 1\n").node_groups, "n"),
              ElementsAre(0, 3));
}

TEST(MeshDialects, ASetOfNodesIsThatOfElements) {
  const std::string file = Cube() + "*NSET, NSET=all, ELSET=cube\n";
  EXPECT_THAT(Members(Read(file).node_groups, "all"), SizeIs(8));
  const GroupedMesh some = Read(Cube() + "*ELSET, ELSET=one\n1\n*NSET, NSET=of, ELSET=ONE\n");
  EXPECT_THAT(Members(some.node_groups, "of"), ElementsAre(0, 1, 2, 6));
  const GroupedMesh face = Read(Cube() + "*ELEMENT, TYPE=CPS3, ELSET=face\n20, 1, 2, 3\n" +
                                "*NSET, NSET=of, ELSET=face\n*ELSET, ELSET=more\nface\n");
  EXPECT_THAT(Members(face.node_groups, "of"), ElementsAre(0, 1, 2));
  EXPECT_THAT(Members(face.face_groups, "more"), SizeIs(1));
  EXPECT_THAT(Refusal(Cube() + "*NSET, NSET=all, ELSET=cubes\n"), HasSubstr("line 17: *NSET with"));
  EXPECT_THAT(Refusal(file + "1, 2\n"), HasSubstr("line 18"));
}

// Gmsh writes the curves of a model so.
TEST(MeshDialects, LinesMarkTheirNodes) {
  const std::string lines = "*ELEMENT, TYPE=T3D2, ELSET=Line1\n100, 1, 2\n101, 2, 3\n";
  const GroupedMesh mesh = Read(absl::StrCat(kNodes, lines, kElements,
                                             "*ELSET, ELSET=edge\n100, 101\n"
                                             "*ELSET, ELSET=same\nLine1\n"));
  EXPECT_EQ(mesh.tetrahedra.cols(), 6);
  for (const char* const name : {"Line1", "edge", "same"}) {
    EXPECT_THAT(Members(mesh.node_groups, name), ElementsAre(0, 1, 2)) << name;
  }
  EXPECT_THAT(mesh.notes, Contains(HasSubstr("line 10: elements of type T3D2 only mark")));
  const GroupedMesh curved =
      Read(absl::StrCat(kNodes, "*ELEMENT, TYPE=T3D3, ELSET=Line1\n100, 1, 2, 3\n", kElements));
  EXPECT_THAT(Members(curved.node_groups, "Line1"), ElementsAre(0, 1, 2));
  EXPECT_THAT(Refusal(absl::StrCat(kNodes, lines, "100, 3, 4\n", kElements)),
              HasSubstr("line 13: there is an element 100 already"));
  EXPECT_THAT(Refusal(CubeWith("TYPE=C3D4", "TYPE=B31")), HasSubstr("'B31'"));
}

TEST(MeshDialects, AnInstanceMayBeMovedByNothing) {
  const auto file = [](const std::string& move) {
    return absl::StrCat("*PART, NAME=Cube\n", Cube(), "*END PART\n*ASSEMBLY, NAME=A\n",
                        "*INSTANCE, NAME=Cube-1, PART=Cube\n", move,
                        "*END INSTANCE\n*END ASSEMBLY\n");
  };
  for (const char* const move :
       {"0., 0., 0.\n", "0.\n", "-0., 0, 0.E0\n0., 0., 0., 0., 0., 1., 0.\n"}) {
    EXPECT_EQ(Read(file(move)).tetrahedra.cols(), 6);
  }
  for (const char* const move :
       {"0., 0., 1.\n", "0., 0., 0.\n0., 0., 0., 0., 0., 1., 90.\n", "0., 0., 0., 0.\n", "a\n"}) {
    EXPECT_THAT(Refusal(file(move)), HasSubstr("a moved *INSTANCE, 'Cube-1'")) << move;
  }
  EXPECT_THAT(Refusal(absl::StrReplaceAll(file(""), {{"PART=Cube\n*END", "PART=Cub\n*END"}})),
              HasSubstr("there is no *PART 'Cub'"));
  EXPECT_THAT(
      Refusal(absl::StrReplaceAll(file(""), {{"*END PART\n", "*END PART\n9, 1, 2, 3, 4\n"}})),
      HasSubstr("line 19: a line of data follows a keyword that has none"));
}

TEST(MeshDialects, WhatMayBeMissingIsNoted) {
  EXPECT_THAT(Read(Cube()).notes, IsEmpty());
  EXPECT_THAT(Read(CubeWith("3, 1, 4, 8, 7\n", "")).notes,
              ElementsAre("the numbers of tetrahedra run from 1 to 6 by 1, and 1 is missing: the "
                          "file may have lost some"));
  const std::string file = Cube();
  EXPECT_THAT(Read(file.substr(0, file.size() - 1)).notes,
              ElementsAre(HasSubstr("the last line does not end")));
  EXPECT_THAT(Read(Cube() + "*NSET, NSET=a\n1, 2, 1\n*NSET, NSET=b\n1, 2\n").notes,
              ElementsAre(HasSubstr("line 18: up to here a set lists 1 member twice")));
  EXPECT_THAT(Read(Cube() + "*SURFACE, NAME=s\n1, S1\n1, S2\n1, S1\n").notes,
              ElementsAre(HasSubstr("line 20: up to here a set lists 1 member twice")));
  EXPECT_THAT(Read(Cube() + "*NSET, NSET=a\n1, 2\n*NSET, NSET=b\na, 1\n").notes, IsEmpty());
  EXPECT_THAT(Read(Cube() + "*NSET, NSET=a\n1, 2, 3, 8\n1, 2, 4\n").notes,
              ElementsAre(HasSubstr("lists 2 members twice"),  //
                          HasSubstr("line 19: up to here the members of a set are in order but")));
  EXPECT_THAT(Read(Cube() + "*NSET, NSET=a\n8, 2, 3, 1, 4\n").notes, IsEmpty());
  // Shells beside solids.
  const GroupedMesh shell = Read(Cube() + "*ELEMENT, TYPE=CPS3\n20, 1, 3, 6\n21, 1, 2, 3\n");
  EXPECT_THAT(shell.notes,
              ElementsAre(HasSubstr("line 18: 1 triangle is no face of a tetrahedron")));
}

constexpr char kOld[] =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n4\n1 0 0 0 0 1\n2 1 0 0 1 2 0.5\n"
    "3 0 1 0 2 3 0.5 0.5\n4 0 0 1 3 4\n$EndParametricNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n"
    "$EndElements\n";

TEST(MeshDialects, ParametricNodesAreRead) {
  const GroupedMesh mesh = Read(kOld);
  EXPECT_EQ(mesh.nodes.cols(), 4);
  EXPECT_EQ(mesh.nodes(2, 3), 1);
  EXPECT_THAT(Refusal(absl::StrReplaceAll(kOld, {{"1 0 0 0 0 1", "1 0 0 0 4 1"}})),
              HasSubstr("line 6: the dimension is not 0 to 3"));
  EXPECT_THAT(Refusal(absl::StrReplaceAll(
                  kOld, {{"$Elements", "$Nodes\n1\n5 1 1 1\n$EndNodes\n$Elements"}})),
              HasSubstr("there is a second $Nodes"));
}

TEST(MeshDialects, LinesOfGmshHoldWhatBelongsToThem) {
  EXPECT_THAT(Refusal(absl::StrReplaceAll(kOld, {{"1 4 2 1 1 1 2 3 4", "1 4 1 1 1 2 3 4 5"}})),
              HasSubstr("line 13: there is more in this line"));
  EXPECT_THAT(Refusal(absl::StrReplaceAll(kOld, {{"$Elements\n1\n", "$Elements\n1 1\n"}})),
              HasSubstr("line 12: a number must be alone"));
}

std::string New(const std::string& entities, const std::string& names) {
  return absl::StrCat("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", names, entities,
                      "$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n",
                      "$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n");
}

constexpr char kEntities[] = "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 5 0\n$EndEntities\n";
constexpr char kNames[] = "$PhysicalNames\n1\n3 5 \"body\"\n$EndPhysicalNames\n";

TEST(MeshDialects, GroupsOfMsh41NeedEntities) {
  EXPECT_THAT(Members(Read(New(kEntities, kNames)).element_groups, "body"), ElementsAre(0));
  EXPECT_THAT(Refusal(New("", kNames)), HasSubstr("no $Entities"));
  EXPECT_THAT(Read(New("", "")).notes, ElementsAre(HasSubstr("has no $Entities")));
  EXPECT_THAT(Refusal(absl::StrReplaceAll(New(kEntities, kNames), {{"3 1 4 1\n", "3 2 4 1\n"}})),
              HasSubstr("entity 2 of dimension 3, which $Entities does not have"));
  EXPECT_THAT(Refusal(absl::StrCat(New("", ""), kEntities)),
              HasSubstr("$Entities must come before $Elements"));
  EXPECT_THAT(Refusal(absl::StrCat(New(kEntities, ""), kNames)),
              HasSubstr("$PhysicalNames must come before $Elements"));
}

TEST(MeshDialects, CountsOfMsh41AreHeld) {
  const std::string file = New(kEntities, kNames);
  EXPECT_THAT(
      Refusal(absl::StrReplaceAll(file, {{"$Elements\n1 1 1 1\n", "$Elements\n1 2 1 2\n"}})),
      HasSubstr("there should be 2 elements, and the blocks hold 1"));
  EXPECT_THAT(Refusal(absl::StrReplaceAll(file, {{"$Nodes\n1 4 1 4\n", "$Nodes\n1 5 1 5\n"}})),
              HasSubstr("there should be 5 nodes"));
}

TEST(MeshDialects, GroupsWithoutNamesAmongNamedOnesAreNoted) {
  const std::string file = absl::StrReplaceAll(New(kEntities, kNames), {{"3 5 \"", "3 4 \""}});
  EXPECT_THAT(Read(file).notes,
              ElementsAre(HasSubstr("the physical group 5 of dimension 3 has no name")));
  EXPECT_THAT(Read(absl::StrReplaceAll(New(kEntities, kNames), {{" 1 5 0\n", " 0 0\n"}})).notes,
              ElementsAre("1 element of dimension 3 is in no physical group, where others are"));
}

TEST(MeshDialects, GroupsOfOneNameAreNoted) {
  const std::string names = absl::StrReplaceAll(kNames, {{"\n1\n", "\n2\n3 4 \"body\"\n"}});
  EXPECT_THAT(Read(New(kEntities, names)).notes,
              ElementsAre("line 7: the physical group 5 has the name of another of its dimension; "
                          "they are one"));
}

TEST(MeshDialects, SectionsThatAreNotUsedAreNotedWithTheirLine) {
  const std::string file =
      absl::StrReplaceAll(kOld, {{"$Elements\n", "$Periodic\n0\n$EndPeriodic\n$Elements\n"}});
  EXPECT_THAT(Read(file).notes, ElementsAre("line 11: $Periodic was not used"));
}

TEST(MeshDialects, ByteOrderMarksAreSkippedAndOtherEncodingsNamed) {
  EXPECT_EQ(Read(absl::StrCat("\xEF\xBB\xBF", Cube())).tetrahedra.cols(), 6);
  EXPECT_EQ(Read(absl::StrCat("\xEF\xBB\xBF", kOld)).tetrahedra.cols(), 1);
  EXPECT_THAT(Refusal(absl::StrCat("\xEF\xBB\xBF", CubeWith("TYPE=C3D4", "TYPE=B31"))),
              HasSubstr("line 10"));
  std::string wide = "\xFF\xFE";
  for (const char c : Cube()) wide += {c, '\0'};
  EXPECT_THAT(Refusal(wide), HasSubstr("UTF-16, not UTF-8; save it as UTF-8"));
}

}  // namespace
}  // namespace mortise::mesh
