// Collects what a mesh file numbers, and puts it together once all of it is known.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/files/grouped_mesh.h"

namespace mortise::mesh {

// Tells people where in a file something is.
class FilePlaces {
 public:
  FilePlaces(std::string_view bytes, bool is_text) : bytes_(bytes), is_text_(is_text) {}

  // Returns INVALID_ARGUMENT naming "mesh_file": "line 12: …" or "byte 345: …" for the byte
  // `place`.
  absl::Status Fault(std::size_t place, std::string_view message) const;

  // Returns "line 12" or "byte 345".
  std::string Where(std::size_t place) const;

  // Returns the size of the whole file, bytes.
  std::size_t size() const { return bytes_.size(); }

 private:
  const std::string_view bytes_;
  const bool is_text_;
};

// Whether the bytes are UTF-8 without control characters, as what goes into messages must be.
bool IsPlainText(std::string_view text);

// Nodes and elements are known by the file's numbers, which may come in any order. Each `place` is
// the byte of the file that failures tell of.
class GroupedMeshBuilder {
 public:
  enum class Repeats { kRefused, kMerged };

  // `repeats` says what becomes of elements on the same nodes; MSH 2.2 repeats those in two groups.
  GroupedMeshBuilder(const FilePlaces& places, Repeats repeats)
      : places_(places), repeats_(repeats) {}

  absl::Status AddNode(std::int64_t number, const Eigen::Vector3d& position, std::size_t place);

  // Adds an element. `nodes` are 4 or 10 numbers in the order of TetrahedralMesh.
  absl::Status AddElement(std::int64_t number, std::span<const std::int64_t> nodes,
                          std::size_t place);

  // The owner of a group. Names are distinct for each owner. Where a part and the whole have groups
  // of one name, in upper or lower case and of whatever kind, the part's are called "<part>.<name>"
  // in the mesh, and a note says so.
  enum class Owner { kWhole, kPart };

  // Return the group of this name, which is made if it is new and may stay empty. A name is 1 to
  // 200 bytes of UTF-8.
  absl::StatusOr<int> AddNodeGroup(const std::string& name, std::size_t place,
                                   Owner owner = Owner::kWhole);
  absl::StatusOr<int> AddElementGroup(const std::string& name, std::size_t place,
                                      Owner owner = Owner::kWhole);
  absl::StatusOr<int> AddFaceGroup(const std::string& name, std::size_t place,
                                   Owner owner = Owner::kWhole);

  // Add members to a group of nodes, of elements, and, the last two, of faces. Nodes and elements
  // must exist in the end; a triangle must be a side of an element. INVALID_ARGUMENT if all groups
  // together have more than ten million members and one for each 16 bytes of the file: a few bytes
  // may put every element into every group.
  absl::Status AddNodeMember(int group, std::int64_t number, std::size_t place);
  absl::Status AddElementMember(int group, std::int64_t number, std::size_t place);
  absl::Status AddSideMember(int group, std::int64_t element, int side, std::size_t place);
  absl::Status AddTriangle(int group, const std::array<std::int64_t, 3>& corners,
                           std::size_t place);

  // Adds a triangle of no group, which marks nothing. Where it is no side of an element it is a
  // part of the body that cannot be analysed, and a note says so.
  absl::Status AddLooseTriangle(const std::array<std::int64_t, 3>& corners, std::size_t place);

  // Sets the name of the part, by which its groups are called; "Part" until this is called.
  void SetPartName(std::string name) { part_name_ = std::move(name); }

  // Adds a note for people. Notes beyond the fiftieth are dropped.
  void AddNote(std::string note) {
    if (notes_.size() < 50) notes_.push_back(std::move(note));
  }

  bool HasElement(std::int64_t number) const { return element_index_.contains(number); }

  // Returns the numbers of the nodes of an element, as they were added; none if there is no such
  // element.
  std::span<const std::int64_t> ElementNodes(std::int64_t number) const;

  // Makes the mesh; the builder is empty afterwards.
  absl::StatusOr<GroupedMesh> Build();

 private:
  struct Member {
    std::int64_t number;
    std::size_t place;
    int side;  // of an element, or -1
  };
  struct Triangle {
    std::array<std::int64_t, 3> corners;
    std::size_t place;
  };
  struct Group {
    Owner owner;
    std::string name;
    std::vector<Member> members;
    std::vector<Triangle> triangles;  // of faces
  };
  struct Groups {
    std::vector<Group> groups;
    std::map<std::pair<Owner, std::string>, int> index;
  };

  using Corners = std::array<int, 3>;  // of a triangle, nodes of the mesh, ascending
  struct CornersHash {
    std::size_t operator()(const Corners& corners) const;
  };
  // The element is -1 where a triangle is no side of any.
  using SidesByCorners = std::unordered_map<Corners, ElementSide, CornersHash>;

  absl::StatusOr<int> AddGroup(Groups& groups, const std::string& name, std::size_t place,
                               Owner owner);
  absl::Status SpendMember(std::size_t place);
  void NamePartGroups();
  absl::Status ResolveElements(GroupedMesh& mesh);
  absl::Status MergeRepeats(GroupedMesh& mesh);
  absl::Status ResolveElementGroups(GroupedMesh& mesh) const;
  absl::StatusOr<Corners> CornersOf(const Triangle& triangle) const;
  absl::StatusOr<SidesByCorners> FindSides(const GroupedMesh& mesh) const;  // of all triangles
  absl::Status ResolveFaceGroups(GroupedMesh& mesh);
  absl::Status NoteTrianglesApart(const SidesByCorners& sides);
  absl::Status ResolveNodeGroups(const std::vector<int>& kept, GroupedMesh& mesh) const;

  const FilePlaces& places_;
  const Repeats repeats_;
  std::vector<Eigen::Vector3d> nodes_;
  std::vector<std::int64_t> node_numbers_;
  std::unordered_map<std::int64_t, int> node_index_;
  int nodes_of_element_ = 0;
  std::vector<std::int64_t> element_nodes_;  // numbers, those of an element in a row
  std::vector<std::int64_t> element_numbers_;
  std::vector<std::size_t> element_places_;
  std::unordered_map<std::int64_t, int> element_index_;  // by number; after Build's merging, final
  Groups node_groups_, element_groups_, face_groups_;
  std::vector<Triangle> loose_triangles_;
  std::size_t members_ = 0;  // of all groups
  std::string part_name_ = "Part";
  std::vector<std::string> notes_;
};

}  // namespace mortise::mesh
