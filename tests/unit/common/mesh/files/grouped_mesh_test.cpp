// Meshes of Gmsh, Abaqus and CalculiX: what is read of them, and how bad files are refused.
#include "common/mesh/files/grouped_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "common/mesh/element_faces.h"
#include "common/mesh/files/abaqus_reader.h"
#include "common/mesh/files/gmsh_reader.h"
#include "tests/support/bad_changes.h"
#include "tests/support/mesh_files.h"

namespace mortise::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <typename Group>
const Group* Find(const std::vector<Group>& groups, const std::string& name) {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const Group& group) { return group.name == name; });
  return found == groups.end() ? nullptr : &*found;
}

template <typename Group>
auto Members(const std::vector<Group>& groups, const std::string& name) {
  const Group* const group = Find(groups, name);
  EXPECT_NE(group, nullptr) << name;
  return group == nullptr ? decltype(Group::members)() : group->members;
}

template <typename Group>
void ExpectSameGroups(const std::vector<Group>& read, const std::vector<Group>& written) {
  for (const Group& group : written) {
    const Group* const found = Find(read, group.name);
    ASSERT_NE(found, nullptr) << group.name;
    EXPECT_EQ(found->members, group.members) << group.name;
  }
}

void ExpectSame(const absl::StatusOr<GroupedMesh>& read, const GroupedMesh& written) {
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->nodes, written.nodes);
  EXPECT_EQ(read->node_numbers, written.node_numbers);
  // Files may list elements group by group.
  ASSERT_EQ(read->tetrahedra.cols(), written.tetrahedra.cols());
  std::map<std::int64_t, int> index;
  for (int e = 0; e < read->tetrahedra.cols(); ++e) index[read->element_numbers[e]] = e;
  GroupedMesh ordered = *read;
  std::vector<int> old_to_new(read->tetrahedra.cols(), -1);
  for (int e = 0; e < written.tetrahedra.cols(); ++e) {
    ASSERT_TRUE(index.contains(written.element_numbers[e]));
    const int from = index[written.element_numbers[e]];
    EXPECT_EQ(read->tetrahedra.col(from), written.tetrahedra.col(e)) << e;
    old_to_new[from] = e;
  }
  for (ElementGroup& group : ordered.element_groups) {
    for (int& e : group.members) e = old_to_new[e];
    std::sort(group.members.begin(), group.members.end());
  }
  for (FaceGroup& group : ordered.face_groups) {
    for (ElementSide& side : group.members) side.element = old_to_new[side.element];
    std::sort(group.members.begin(), group.members.end());
  }
  ExpectSameGroups(ordered.element_groups, written.element_groups);
  ExpectSameGroups(ordered.face_groups, written.face_groups);
  ExpectSameGroups(ordered.node_groups, written.node_groups);
}

GroupedMesh Box(bool quadratic) { return testing::GroupedBox({2, 1, 1}, {4, 2, 3}, quadratic); }

// Everything a file of one tetrahedron has that tests replace.
constexpr char kOldGmsh[] =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"body\"\n$EndPhysicalNames\n"
    "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
    "$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";
constexpr char kAbaqus[] =
    "*NODE\n1, 0, 0, 0\n2, 1.D0, 0, 0\n3, 0, 1\n4, , , 1e0\n"
    "*ELEMENT, TYPE=C3D4, ELSET=body\n7, 1, 2, 3, 4\n";

std::string Message(const std::string& file) {
  const auto mesh = ReadGroupedMesh(file);
  EXPECT_FALSE(mesh.ok());
  EXPECT_EQ(DetailOf(mesh.status()).field, "mesh_file");
  return std::string(mesh.status().message());
}

TEST(GroupedMesh, EveryFormatGivesWhatWasWritten) {
  for (const bool quadratic : {false, true}) {
    const GroupedMesh box = Box(quadratic);
    for (const bool is_binary : {false, true}) {
      SCOPED_TRACE(absl::StrCat(quadratic, " ", is_binary));
      ExpectSame(ReadGroupedMesh(testing::WriteGmsh22(box, is_binary)), box);
      ExpectSame(ReadGroupedMesh(testing::WriteGmsh41(box, is_binary)), box);
    }
    ExpectSame(ReadGroupedMesh(testing::WriteAbaqus(box)), box);
  }
}

// The formats' own numbering, from their manuals: 10-node tetrahedra whose middle nodes lie in the
// middles of their edges, as the places tell.
TEST(GroupedMesh, MiddleNodesComeInOurOrder) {
  // The middles of 01, 12, 02, 03, 13, 23 of the unit tetrahedron are nodes 5 to 10.
  const std::string places =
      "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n"
      "9 .5 0 .5\n10 0 .5 .5\n";
  const std::string gmsh =
      absl::StrCat("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n", places,
                   "$EndNodes\n$Elements\n1\n1 11 2 0 1 1 2 3 4 5 6 7 8 10 9\n$EndElements\n");
  const std::string abaqus =
      absl::StrCat("*NODE\n", absl::StrReplaceAll(places, {{" ", ", "}}),
                   "*ELEMENT, TYPE=C3D10M\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n");
  for (const std::string& file : {gmsh, abaqus}) {
    const auto mesh = ReadGroupedMesh(file);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    for (int edge = 0; edge < 6; ++edge) {
      const auto [a, b] = kTetrahedronEdges[edge];
      const Eigen::Vector3d middle =
          0.5 * (mesh->nodes.col(mesh->tetrahedra(a, 0)) + mesh->nodes.col(mesh->tetrahedra(b, 0)));
      EXPECT_EQ(Eigen::Vector3d(mesh->nodes.col(mesh->tetrahedra(4 + edge, 0))), middle) << edge;
    }
  }
}

// S1 to S4 of the unit tetrahedron, by the places of their corners.
TEST(GroupedMesh, SurfacesOfElementFacesAreTheRightOnes) {
  std::string file = kAbaqus;
  for (int s = 1; s <= 4; ++s) absl::StrAppend(&file, "*SURFACE, NAME=S", s, "\nbody, S", s, "\n");
  const auto mesh = ReadAbaqus(file);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  // Which corner does not lie on S1: z = 0, S2: y = 0, S3: x + y + z = 1, S4: x = 0.
  const std::array<int, 4> opposite{3, 2, 0, 1};
  for (int s = 0; s < 4; ++s) {
    const FaceGroup* group = Find(mesh->face_groups, absl::StrCat("S", s + 1));
    ASSERT_NE(group, nullptr);
    EXPECT_THAT(group->members, ElementsAre(ElementSide{0, opposite[s]}));
    const Eigen::VectorXi nodes = SideNodes(mesh->tetrahedra, group->members[0]);
    EXPECT_EQ((nodes.array() == mesh->tetrahedra(opposite[s], 0)).count(), 0);
  }
}

TEST(GroupedMesh, SetsHaveRangesAndNameOthers) {
  const std::string file =
      absl::StrCat(kAbaqus,
                   "*NSET, NSET=Odd, GENERATE\n1, 3, 2\n*NSET, NSET=both\nODD, 4\n"
                   "*SURFACE, TYPE=NODE, NAME=free\nboth, 1.\n*NSET, NSET=nobody\n"
                   "*ELEMENT, TYPE=CPS3, ELSET=bottom\n90, 1, 2, 3\n*ELSET, ELSET=Lid\n90,\n"
                   "*ELSET, ELSET=Cover\nlid\n"
                   "*MATERIAL, NAME=x\n*ELASTIC\n1, 2\n*SOLID SECTION, ELSET=body, "
                   "MATERIAL=x\n*TIE\nthis, that\n");
  const auto mesh = ReadAbaqus(file);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(Members(mesh->node_groups, "Odd"), ElementsAre(0, 2));
  EXPECT_THAT(Members(mesh->node_groups, "both"), ElementsAre(0, 2, 3));
  EXPECT_THAT(Members(mesh->node_groups, "free"), ElementsAre(0, 2, 3));
  EXPECT_TRUE(Members(mesh->node_groups, "nobody").empty());
  EXPECT_THAT(Members(mesh->face_groups, "bottom"), ElementsAre(ElementSide{0, 3}));
  EXPECT_THAT(Members(mesh->face_groups, "Lid"), ElementsAre(ElementSide{0, 3}));
  EXPECT_THAT(Members(mesh->face_groups, "Cover"), ElementsAre(ElementSide{0, 3}));
  EXPECT_THAT(mesh->notes, ElementsAre(HasSubstr("not used: *ELASTIC (line ")));
  const std::string repeated =
      absl::StrCat(kAbaqus, "*STEP\n*TIE\n1\n*BOUNDARY\n1\n*TIE\n2\n*TIE\n");
  const auto lines = std::count(kAbaqus, kAbaqus + std::strlen(kAbaqus), '\n');
  EXPECT_THAT(ReadAbaqus(repeated)->notes,
              ElementsAre(absl::StrCat("not used: *BOUNDARY (line ", lines + 4, "), *STEP (line ",
                                       lines + 1, "), *TIE (line ", lines + 2, ", 3 times)")));
}

// As Abaqus/CAE writes one part in an assembly.
TEST(GroupedMesh, OnePartInAnAssemblyIsRead) {
  const std::string assembly = absl::StrCat(
      "*Heading\n** Job name: x\n*Part, name=P\n", kAbaqus, "*End Part\n*Assembly, name=A\n",
      "*Instance, name=P-1, part=P\n*End Instance\n*Nset, nset=Set-1, instance=P-1\n 1, 2\n",
      "*End Assembly\n");
  const auto mesh = ReadAbaqus(assembly);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(Members(mesh->node_groups, "Set-1"), ElementsAre(0, 1));
  EXPECT_THAT(
      Message(absl::StrReplaceAll(assembly, {{"*End Instance", "1., 0., 0.\n*End Instance"}})),
      HasSubstr("a moved *INSTANCE"));
  EXPECT_THAT(Message(absl::StrCat(assembly, "*PART, NAME=Q\n")), HasSubstr("second *PART"));
}

// As Abaqus/CAE writes one part of two elements: the sets of the section's assignment are called as
// those of the support, and the point of reference has a number that a node of the part has too.
constexpr char kCae[] =
    "*Heading\n** Generated by: Abaqus/CAE 2023\n*Preprint, echo=NO, model=NO\n"
    "*Part, name=Part-1\n*Node\n 1, 0., 0., 0.\n 2, 1., 0., 0.\n 3, 0., 1., 0.\n"
    " 4, 0., 0., 1.\n 5, 1., 1., 1.\n*Element, type=C3D4\n1, 1, 2, 3, 4\n2, 2, 3, 4, 5\n"
    "*Nset, nset=Set-1, generate\n 1, 5, 1\n*Elset, elset=Set-1, generate\n 1, 2, 1\n"
    "*Nset, nset=Only\n 5,\n** Section: s\n*Solid Section, elset=Set-1, material=Steel\n,\n"
    "*End Part\n**\n*Assembly, name=Assembly\n**\n*Instance, name=Part-1-1, part=Part-1\n"
    "*End Instance\n**\n*Node\n 1, 0., 0., 10.\n*Nset, nset=SET-1, instance=Part-1-1\n 1, 3\n"
    "*Nset, nset=Point\n 1,\n*Nset, nset=All, instance=Part-1-1\n Set-1,\n"
    "*Nset, nset=Named\n Part-1-1.2, part-1-1.Only, SET-1\n"
    "*Elset, elset=_Surf-1_S1, internal, instance=Part-1-1\n 1,\n"
    "*Surface, type=ELEMENT, name=Surf-1\n_Surf-1_S1, S1\n*End Assembly\n";

TEST(GroupedMesh, SetsOfThePartAndOfTheAssemblyAreKeptApart) {
  const std::string independent =  // CAE writes the mesh into the instance then
      absl::StrReplaceAll(kCae, {{"*Part, name=Part-1\n",
                                  "*Part, name=Part-1\n*End Part\n"
                                  "*Instance, name=Part-1-1\n"},
                                 {"*End Part\n**\n", "*End Instance\n"},
                                 {"*Instance, name=Part-1-1, part=Part-1\n*End Instance\n", ""}});
  for (const std::string& file : {std::string(kCae), independent}) {
    const auto mesh = ReadAbaqus(file);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_EQ(mesh->nodes.cols(), 5);
    EXPECT_THAT(Members(mesh->node_groups, "SET-1"), ElementsAre(0, 2));
    EXPECT_THAT(Members(mesh->node_groups, "Part-1.Set-1"), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(Members(mesh->element_groups, "Part-1.Set-1"), ElementsAre(0, 1));
    EXPECT_EQ(Find(mesh->node_groups, "Set-1"), nullptr);
    EXPECT_EQ(Find(mesh->element_groups, "Set-1"), nullptr);
    EXPECT_THAT(Members(mesh->node_groups, "Only"), ElementsAre(4));
    EXPECT_TRUE(Members(mesh->node_groups, "Point").empty());
    EXPECT_THAT(Members(mesh->node_groups, "All"), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(Members(mesh->node_groups, "Named"), ElementsAre(0, 1, 2, 4));
    EXPECT_THAT(Members(mesh->face_groups, "Surf-1"), ElementsAre(ElementSide{0, 3}));
    EXPECT_THAT(mesh->notes,
                ElementsAre(HasSubstr("not used: *SOLID SECTION (line "),
                            "1 node of the assembly belongs to no element and was left out",
                            "sets of the part, called so because the assembly has their names "
                            "too: Part-1.Set-1"));
  }
}

TEST(GroupedMesh, ANameThatIsTakenIsNotGivenToAPartsSet) {
  const auto mesh = ReadAbaqus(absl::StrReplaceAll(kCae, {{"nset=Point", "nset=Part-1.Set-1"}}));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_TRUE(Members(mesh->node_groups, "Part-1.Set-1").empty());
  EXPECT_EQ(Members(mesh->node_groups, "Part-1.Part-1.Set-1").size(), 5u);
}

TEST(GroupedMesh, AssembliesOfMoreThanOneUnmovedPartAreRefusedByName) {
  testing::ExpectRefused(
      kCae,
      {
          {"*Assembly,", "*Part, name=Part-2\n*End Part\n*Assembly,",
           "line 25: there is a second *PART, 'Part-2'"},
          {"*End Assembly", "*Instance, name=Part-1-2, part=Part-1\n*End Assembly",
           "there is a second *INSTANCE, 'Part-1-2'"},
          {"*End Instance", "0., 0., 5.\n*End Instance", "line 28: a moved *INSTANCE, 'Part-1-1'"},
          {"All, instance=Part-1-1", "All, instance=Part-1-2", "there is no *INSTANCE 'Part-1-2'"},
          {"All, instance=Part-1-1", "All, instance=\xff", "'?'"},
          {"*End Part\n", "", "*END PART is missing before *ASSEMBLY"},
          {"*End Instance\n**\n*Node\n 1, 0., 0., 10.\n", "",
           "*END INSTANCE is missing before *END ASSEMBLY"},
          {"*End Assembly", "*Element, type=C3D4\n9, 1, 2, 3, 4\n*End Assembly",
           "elements of the assembly"},
      },
      Message);
}

// Sets are resolved in the file's order: one that comes later would still be empty.
TEST(GroupedMesh, MembersAreEarlierSets) {
  EXPECT_THAT(Message(absl::StrCat(kAbaqus, "*NSET, NSET=a\nb\n*NSET, NSET=b\n1\n")),
              HasSubstr("line 9: a member is neither"));
  EXPECT_THAT(Message(absl::StrCat(kAbaqus, "*NSET, NSET=a\n1,,2\n")),
              HasSubstr("line 9: a member of a set is missing"));
}

TEST(GroupedMesh, LongLinesOfAbaqusAreRefused) {
  const std::string blank(1000, ' ');
  std::string file = absl::StrCat("*", blank, "NODE,");
  for (int i = 0; i < 1000; ++i) absl::StrAppend(&file, blank, "\n");
  const auto mesh =
      ReadAbaqus(absl::StrReplaceAll(kAbaqus, {{"*NODE", absl::StrCat(file, "NSET=all")}}));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(Members(mesh->node_groups, "all").size(), 4u);

  for (int i = 0; i < 70'000; ++i) absl::StrAppend(&file, ",\n");
  EXPECT_THAT(Message(file), HasSubstr("line 1: a keyword takes more than 65536 bytes"));
  const std::string commas(70'000, ',');
  EXPECT_THAT(Message(absl::StrCat(kAbaqus, "*NSET, NSET=a\n1\n", commas)),
              HasSubstr("line 10: a line of data is longer than 65536 bytes"));
  EXPECT_TRUE(ReadAbaqus(absl::StrCat(kAbaqus, "*STEP\n", commas)).ok());
}

// One tetrahedron of MSH 4.1 with these physical tags, and so many like it.
std::string NewGmsh(const std::string& tags, int elements) {
  std::string file = absl::StrCat(
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 ", tags,
      " 0\n$EndEntities\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
      "$EndNodes\n$Elements\n1 ",
      elements, " 1 ", elements, "\n3 1 4 ", elements, "\n");
  for (int e = 1; e <= elements; ++e) absl::StrAppend(&file, e, " 1 2 3 4\n");
  return absl::StrCat(file, "$EndElements\n");
}

TEST(GroupedMesh, RepeatedTagsOfAnEntityAreOneGroup) {
  std::string tags = "100001";
  for (int i = 0; i < 100'000; ++i) absl::StrAppend(&tags, " ", i % 2 == 0 ? "7" : "-7");
  const auto mesh = ReadGmsh(NewGmsh(absl::StrCat(tags, " 8"), 1));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_EQ(mesh->element_groups.size(), 2u);
  EXPECT_THAT(Members(mesh->element_groups, "7"), ElementsAre(0));
  EXPECT_THAT(Members(mesh->element_groups, "8"), ElementsAre(0));
}

TEST(GroupedMesh, GroupsTimesElementsAreLimited) {
  constexpr int kGroups = 5000, kElements = 2048;  // 10.24 million members of 200 kB
  std::string tags = absl::StrCat(kGroups);
  for (int i = 1; i <= kGroups; ++i) absl::StrAppend(&tags, " ", i);
  EXPECT_THAT(Message(NewGmsh(tags, kElements)), HasSubstr("the groups have more than 100"));
}

TEST(GroupedMesh, TagsAndEntitiesOfGmshAreChecked) {
  EXPECT_TRUE(ReadGmsh(NewGmsh("1 5", 1)).ok());
  for (const char* tag : {"-9223372036854775808", "9223372036854775807", "2147483648"}) {
    EXPECT_THAT(Message(NewGmsh(absl::StrCat("1 ", tag), 1)), HasSubstr("line 6: the number of a"));
    testing::ExpectRefused(
        kOldGmsh,
        {{"1 4 2 1 1", absl::StrCat("1 4 2 ", tag, " 1"), "line 17: the number of a group"}},
        Message);
  }
  EXPECT_THAT(Message(absl::StrReplaceAll(NewGmsh("0", 1),
                                          {{"0 0 0 1\n", "0 0 0 2\n1 0 0 0 1 1 1 0 0\n"}})),
              HasSubstr("an entity 1 of dimension 3 already"));
}

// MSH 2.2 repeats elements that are in two groups.
TEST(GroupedMesh, ElementsInTwoGroupsAreOne) {
  GroupedMesh box = Box(true);
  box.element_groups.push_back({"some", {2, 3, 40}});
  const auto mesh = ReadGmsh(testing::WriteGmsh22(box, true));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->tetrahedra.cols(), box.tetrahedra.cols());
  EXPECT_EQ(Members(mesh->element_groups, "some").size(), 3u);
  EXPECT_THAT(Message(testing::WriteGmsh41(box, true)), HasSubstr("has the corners of element"));
}

TEST(GroupedMesh, NodesOfNoElementAreLeftOut) {
  const auto mesh = ReadGmsh(
      absl::StrReplaceAll(kOldGmsh, {{"$Nodes\n4\n", "$Nodes\n6\n77 9 9 9\n78 9 9 8\n"},
                                     {"$Elements\n1\n", "$Elements\n2\n5 15 2 8 1 77\n"}}));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->nodes.cols(), 4);
  EXPECT_TRUE(Members(mesh->node_groups, "8").empty());
  EXPECT_THAT(mesh->notes, ElementsAre(HasSubstr("2 nodes belong to no element")));
}

TEST(GroupedMesh, BadGmshFilesAreRefusedWithTheLine) {
  testing::ExpectRefused(
      kOldGmsh,
      {
          {"2.2 0 8", "4 0 8", "version 4"},
          {"2.2 0 8", "2.2 1 8", "byte order"},
          {"3 0 1 0", "3 0 nan 0", "line 12: a coordinate of node 3"},
          {"3 0 1 0", "3 0 x 0", "line 12"},
          {"3 0 1 0", "3 0 1e999 0", "line 12"},
          {"3 0 1 0", "2 0 1 0", "a node 2 already"},
          {"1 2 3 4\n", "1 2 3 5\n", "line 17: element 1 names node 5"},
          {"1 2 3 4\n", "1 2 3 3\n", "node 3 twice"},
          {"1 4 2 1 1", "1 5 2 1 1", "hexahedra of 8 nodes"},
          {"1 4 2 1 1", "1 99 2 1 1", "type 99"},
          {"1 4 2 1 1", "1 4 1000000000 1 1", "number of tags"},
          {"$Nodes\n4\n", "$Nodes\n4000000000000000000\n", "too short"},
          {"$Nodes\n4\n", "$Nodes\n-4\n", "too short"},
          {"$Nodes\n4\n", "$Nodes\n3\n", "$EndNodes is missing"},
          {"$Nodes\n4\n", "$Nodes\n5\n", "line 14"},
          {"$Elements\n1\n1 4 2 1 1 1 2 3 4\n", "$Elements\n0\n", "no tetrahedra"},
          {"$Nodes", "$PartitionedEntities\n$EndPartitionedEntities\n$Nodes", "partitioned"},
          {"\"body\"", "\"bo\xffy\"", "name of a group"},
          {"$Elements\n1\n", "$Elements\n2\n8 2 2 5 1 1 2 9\n", "there is no node 9"},
      },
      Message);
}

TEST(GroupedMesh, TrianglesMustBeSides) {
  const std::string file =
      absl::StrReplaceAll(kOldGmsh, {{"$Nodes\n4\n", "$Nodes\n5\n5 2 2 2\n"},
                                     {"$Elements\n1\n", "$Elements\n2\n8 2 2 5 1 1 2 5\n"}});
  EXPECT_THAT(Message(file), HasSubstr("line 18: a triangle of group '5' is no face"));
}

TEST(GroupedMesh, BadAbaqusFilesAreRefusedWithTheLine) {
  testing::ExpectRefused(kAbaqus,
                         {
                             {"*NODE\n", "*NODE, SYSTEM=C\n", "line 1: *NODE with SYSTEM"},
                             {"*NODE\n", "*INCLUDE, INPUT=other.inp\n*NODE\n", "line 1: *INCLUDE"},
                             {"*NODE\n", "*NGEN\n1,2\n*NODE\n", "*NGEN"},
                             {"TYPE=C3D4", "TYPE=C3D8R", "line 6: elements of type 'C3D8R'"},
                             {"7, 1, 2, 3, 4", "7, 1, 2, 3, 5", "names node 5"},
                             {"7, 1, 2, 3, 4", "7, 1, 2, 3", "fewer than 4"},
                             {"7, 1, 2, 3, 4", "7, 1, 2, 3, 4, 4", "more than 4"},
                             {"7, 1, 2, 3, 4", "7, 1, 2, x, 4", "line 7"},
                             {"7, 1, 2, 3, 4", "7, 1, 2, 3, 4\n7, 1, 2, 3, 4",
                              "line 8: there is an element 7 already"},
                             {"3, 0, 1", "3, 0, inf", "node 3 is not finite"},
                             {"3, 0, 1", "3, 0, 1x", "line 4"},
                         },
                         Message);
  const auto more = [](const std::string& text) { return Message(absl::StrCat(kAbaqus, text)); };
  EXPECT_THAT(more("*NSET, NSET=a\n99\n"), HasSubstr("line 9: group 'a' names node 99"));
  EXPECT_THAT(more("*NSET, NSET=a\nnone\n"), HasSubstr("line 9"));
  EXPECT_THAT(more("*NSET, NSET=a\na\n"), HasSubstr("line 9"));
  EXPECT_THAT(more("*NSET, NSET=a, GENERATE\n1, 1000000000000, 1\n"), HasSubstr("more than"));
  EXPECT_THAT(more("*NSET, NSET=a, GENERATE\n-9223372036854775807, 9223372036854775807\n"),
              HasSubstr("a range"));
  EXPECT_THAT(more("*NSET, NSET=a, GENERATE\n1, 8, 0\n"), HasSubstr("a range"));
  EXPECT_THAT(more("*NSET, NSET=a, GENERATE\n0, 9223372036854775807\n"), HasSubstr("more than"));
  EXPECT_THAT(more("*SURFACE, NAME=a\n7, S5\n"), HasSubstr("S1 to S4"));
  EXPECT_THAT(more("*SURFACE, NAME=a\n9, S1\n"), HasSubstr("element 9"));
  EXPECT_THAT(more("*SURFACE, NAME=a, TYPE=CUTTING\n"), HasSubstr("TYPE"));
  EXPECT_THAT(more("*ELSET, ELSET=a\n8\n"), HasSubstr("element 8"));
  EXPECT_THAT(more("*\n"), HasSubstr("keyword"));
  EXPECT_THAT(Message("hello"), HasSubstr("neither"));
  EXPECT_THAT(Message(" \n"), HasSubstr("empty"));
}

// Wherever a file is cut off or changed, the answer is a mesh or a refusal.
TEST(GroupedMesh, DamagedFilesAreReadOrRefused) {
  const GroupedMesh box = testing::GroupedBox({1, 1, 1}, {2, 1, 1}, true);
  std::mt19937 random(7);
  for (const std::string& whole :
       {testing::WriteGmsh22(box, false), testing::WriteGmsh22(box, true),
        testing::WriteGmsh41(box, false), testing::WriteGmsh41(box, true),
        testing::WriteAbaqus(box)}) {
    for (int i = 0; i < 150; ++i) {
      const auto cut = ReadGroupedMesh(whole.substr(0, random() % whole.size()));
      EXPECT_TRUE(cut.ok() || DetailOf(cut.status()).field == "mesh_file") << cut.status();
      std::string damaged = whole;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      const auto mesh = ReadGroupedMesh(damaged);
      EXPECT_TRUE(mesh.ok() || DetailOf(mesh.status()).field == "mesh_file") << mesh.status();
    }
  }
}

}  // namespace
}  // namespace mortise::mesh
