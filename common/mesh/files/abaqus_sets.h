// Collects the sets and surfaces of Abaqus' input files, whose members are found out in the end;
// for abaqus_reader.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/mesh/files/grouped_mesh_builder.h"

namespace mortise::mesh {

// Every set is a group of the builder's. Members that lines list wait until everything they may
// name has been read; sets are known by what they are of, whose they are, and their names in upper
// or lower case. All failures are INVALID_ARGUMENT naming "mesh_file", with the line.
class AbaqusSets {
 public:
  using Owner = GroupedMeshBuilder::Owner;

  // The kinds of members of sets. A surface of faces of elements is a set of faces, and so is a set
  // of triangles. A set of lines marks their nodes.
  enum class Kind : std::uint8_t { kNodes, kElements, kFaces, kLines };

  static constexpr int kNoSet = -1;

  // Says how the lines after a keyword list the members of a set.
  struct List {
    int set = kNoSet;          // as Open gave it
    Owner of = Owner::kWhole;  // whose the members are that do not name the instance
    bool is_range = false;     // a line is first, last and step
    bool has_weights = false;  // a line is one member, and perhaps a weight
  };

  // `text` is the whole file, of which `places` tells and all lines are parts. All must outlive
  // this.
  AbaqusSets(std::string_view text, const FilePlaces& places, GroupedMeshBuilder& builder)
      : text_(text), places_(places), builder_(builder) {}

  // Returns the set of this name, which is made if it is new and may stay empty. `place`: the
  // keyword's.
  absl::StatusOr<int> Open(Kind kind, const std::string& name, Owner owner, std::size_t place);

  // Adds a node or element, which was read at `place`, to a set of nodes or elements.
  absl::Status AddMember(int set, std::int64_t number, std::size_t place);

  // Adds an element that only marks: a triangle of 3 or 6 nodes marks faces, and a line of 2 or 3
  // nodes marks these. What it marks is in `set`, a set of faces or lines, unless that is kNoSet,
  // and in the sets of elements that list its number.
  absl::Status AddMark(int set, std::int64_t number, std::span<const std::int64_t> nodes,
                       bool is_line, std::size_t place);

  // Notes a node of the assembly, which is left out of the whole's sets.
  void AddAssemblyNode(std::int64_t number) { assembly_nodes_.push_back(number); }

  // Adds a line of members, without space round it. All sets together have up to ten million.
  absl::Status AddLine(const List& list, std::string_view line);

  // Adds all nodes of the elements of another set, named by the keyword whose line is `line`.
  void AddNodesOf(const List& list, const std::string& elements, std::string_view line);

  // Sets the instance's name: "Part-1-1.Set-1" and "Part-1-1.5" are the part's, wherever they
  // stand.
  void SetInstance(std::string name) { instance_ = std::move(name); }
  const std::string& instance() const { return instance_; }

  // Puts the members of all lines into the builder's groups, in the order of the file, and notes if
  // nodes were left out or a set seems to have lost some. It is called once everything has been
  // read.
  absl::Status Resolve();

 private:
  struct Set {
    Kind kind;
    std::string name;  // as it was written first
    Owner owner;
    std::size_t place;  // of its first line
    std::vector<std::int64_t> members;
    int group, face_group, node_group;  // the builder's, -1 before it is made
  };
  struct Entry {
    std::string_view text;  // a member; or a line, of a range or of a surface of element faces
    int set;
    bool is_range;
    Owner of;
    int elements = -1;  // into named_, of a set of nodes that are those of elements
  };
  // The nodes of an element that only marks; the first, or first two, are its corners.
  struct Mark {
    std::array<std::int64_t, 6> nodes;
    int count;
    bool is_line;
  };
  using Index = std::map<std::pair<Owner, std::string>, int>;  // into sets_, by upper case

  std::size_t PlaceOf(std::string_view part) const {
    return static_cast<std::size_t>(part.data() - text_.data());
  }
  absl::Status Fault(const Entry& entry, std::string_view message) const {
    return places_.Fault(PlaceOf(entry.text), message);
  }
  absl::Status Spend(std::size_t members, std::size_t place);
  absl::Status AddFaceGroup(Set& set, std::size_t place);
  absl::Status AddNodeGroup(Set& set, std::size_t place);
  absl::Status AddMarked(Set& set, const Mark& mark, std::size_t place);
  std::pair<std::string_view, Owner> WithoutInstance(std::string_view name, Owner of) const;
  int FindSet(Kind kind, std::string_view name, Owner of, std::size_t place, int except) const;
  absl::Status ResolveMember(const Entry& entry, std::int64_t number, Owner of);
  void NoteDoubts();
  absl::Status ResolveEntry(const Entry& entry);
  absl::Status ResolveNodesOf(const Entry& entry);
  int FindElements(std::string_view name, Owner of, std::size_t place, int except) const;
  std::span<const std::int64_t> NodesOf(std::int64_t element) const;
  absl::Status ResolveRange(const Entry& entry);
  absl::Status ResolveSurface(const Entry& entry);

  const std::string_view text_;
  const FilePlaces& places_;
  GroupedMeshBuilder& builder_;
  std::string instance_;
  std::vector<Set> sets_;
  std::array<Index, 4> index_;  // by kind
  std::vector<Entry> entries_;
  std::vector<std::string> named_;            // sets of elements
  std::size_t members_ = 0;                   // of all sets, as far as they are known
  std::vector<std::int64_t> assembly_nodes_;  // in the end, ascending
  std::map<std::int64_t, Mark> marks_;        // by number
};

}  // namespace mortise::mesh
