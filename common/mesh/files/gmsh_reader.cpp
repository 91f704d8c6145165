#include "common/mesh/files/gmsh_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/files/gmsh_cursor.h"
#include "common/mesh/files/gmsh_element_kinds.h"
#include "common/mesh/files/gmsh_groups.h"
#include "common/mesh/files/grouped_mesh_builder.h"

namespace mortise::mesh {
namespace {

class Reader {
 public:
  Reader(std::string_view bytes, bool is_text, bool is_version_22)
      : places_(bytes, is_text),
        cursor_(bytes, is_text, places_),
        builder_(places_, is_version_22 ? GroupedMeshBuilder::Repeats::kMerged
                                        : GroupedMeshBuilder::Repeats::kRefused),
        groups_(places_, builder_),
        is_version_22_(is_version_22) {}

  absl::StatusOr<GroupedMesh> Read() {
    while (true) {
      cursor_.SkipSpace();
      section_place_ = cursor_.at();
      MORTISE_ASSIGN_OR_RETURN(const std::string_view section, cursor_.Section());
      if (section.empty()) break;
      MORTISE_RETURN_IF_ERROR(ReadSection(std::string(section.substr(1))));
    }
    groups_.AddNotes();
    return builder_.Build();
  }

 private:
  absl::Status ReadSection(const std::string& name) {
    const std::string end = "$End" + name;
    if (name == "PartitionedEntities") {
      return cursor_.Fault("partitioned meshes are not read; save it without partitions");
    }
    const bool is_nodes = name == "Nodes" || (name == "ParametricNodes" && is_version_22_);
    const bool is_known = name == "MeshFormat" || name == "PhysicalNames" || is_nodes ||
                          name == "Elements" || (name == "Entities" && !is_version_22_);
    if (!is_known) {
      const bool is_word = !name.empty() && name.size() <= 40 &&
                           std::all_of(name.begin(), name.end(),
                                       [](unsigned char c) { return std::isalnum(c) != 0; });
      if (!is_word) return cursor_.Fault("a section has no name");
      if (name != "Comments") {
        builder_.AddNote(absl::StrCat(places_.Where(section_place_), ": $", name, " was not used"));
      }
      return cursor_.SkipTo(end);
    }
    if (name == "MeshFormat") return cursor_.SkipTo(end);  // read by ReadGmsh
    if (!seen_.insert(is_nodes ? "Nodes" : name).second) {
      return cursor_.Fault("there is a second $" + name);
    }
    // Groups are known by these when elements are read.
    if ((name == "PhysicalNames" || name == "Entities") && seen_.contains("Elements")) {
      return cursor_.Fault(absl::StrCat("$", name, " must come before $Elements"));
    }
    if (name == "PhysicalNames") MORTISE_RETURN_IF_ERROR(ReadNames());
    if (name == "Entities") {
      groups_.BeginEntities();
      MORTISE_RETURN_IF_ERROR(ReadEntities());
    }
    if (is_nodes) {
      MORTISE_RETURN_IF_ERROR(is_version_22_ ? ReadNodes22(name != "Nodes") : ReadNodes());
    }
    if (name == "Elements") {
      MORTISE_RETURN_IF_ERROR(is_version_22_ ? ReadElements22() : ReadElements());
    }
    return cursor_.Expect(end);
  }

  // Text in all files.
  absl::Status ReadNames() {
    MORTISE_ASSIGN_OR_RETURN(std::int64_t count, cursor_.Parse<std::int64_t>());
    MORTISE_ASSIGN_OR_RETURN(count, cursor_.CheckCount(count, 6));
    for (std::int64_t i = 0; i < count; ++i) {
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t dimension, cursor_.Parse<std::int64_t>());
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t tag, cursor_.Parse<std::int64_t>());
      cursor_.SkipSpace();
      const std::size_t place = cursor_.at();
      const std::string_view line = cursor_.Line();
      if (line.size() < 2 || line.front() != '"' || line.back() != '"') {
        return places_.Fault(place, "a name in quotes is missing here");
      }
      if (dimension < 0 || dimension > 3) {
        return places_.Fault(place, "the dimension is not 0 to 3");
      }
      const std::string name(line.substr(1, line.size() - 2));
      MORTISE_RETURN_IF_ERROR(groups_.Name({static_cast<int>(dimension), tag}, name, place));
    }
    return absl::OkStatus();
  }

  // Negative where the group turns the entity round.
  absl::StatusOr<std::int64_t> PhysicalTag() {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t tag, cursor_.Int());
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    if (tag < -kMost || tag > kMost) return cursor_.Fault("the number of a group is too large");
    return std::abs(tag);
  }

  absl::Status ReadEntities() {
    std::array<std::int64_t, 4> counts{};
    for (std::int64_t& count : counts) {
      MORTISE_ASSIGN_OR_RETURN(count, cursor_.Count(cursor_.is_text() ? 10 : 36));
    }
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (std::int64_t i = 0; i < counts[dimension]; ++i) {
        MORTISE_RETURN_IF_ERROR(ReadEntity(dimension));
      }
    }
    return absl::OkStatus();
  }

  absl::Status ReadEntity(int dimension) {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t tag, cursor_.Int());
    for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) {  // its place, or box
      MORTISE_RETURN_IF_ERROR(cursor_.Double().status());
    }
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t groups, cursor_.Count(cursor_.is_text() ? 2 : 4));
    std::vector<std::int64_t> tags;
    for (std::int64_t i = 0; i < groups; ++i) {
      MORTISE_ASSIGN_OR_RETURN(tags.emplace_back(), PhysicalTag());
    }
    if (!groups_.AddEntity({dimension, tag}, std::move(tags))) {
      return cursor_.Fault(
          absl::StrCat("there is an entity ", tag, " of dimension ", dimension, " already"));
    }
    if (dimension == 0) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t bounds, cursor_.Count(cursor_.is_text() ? 2 : 4));
    for (std::int64_t i = 0; i < bounds; ++i) MORTISE_RETURN_IF_ERROR(cursor_.Int().status());
    return absl::OkStatus();
  }

  absl::Status ReadNode(std::int64_t number, std::size_t place) {
    Eigen::Vector3d position;
    for (double& x : position) {
      MORTISE_ASSIGN_OR_RETURN(x, cursor_.Double());
    }
    return builder_.AddNode(number, position, place);
  }

  // Parametric nodes tell besides on which entity they lie, and where on a curve or surface.
  absl::Status ReadNodes22(bool is_parametric) {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t count, Count22(cursor_.is_text() ? 8 : 28));
    for (std::int64_t i = 0; i < count; ++i) {
      if (cursor_.is_text()) cursor_.SkipSpace();
      const std::size_t place = cursor_.at();
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t number, cursor_.Int());
      MORTISE_RETURN_IF_ERROR(ReadNode(number, place));
      if (is_parametric) MORTISE_RETURN_IF_ERROR(SkipParameters22());
      MORTISE_RETURN_IF_ERROR(cursor_.EndLine());
    }
    return absl::OkStatus();
  }

  absl::Status SkipParameters22() {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t dimension, cursor_.Int());
    MORTISE_RETURN_IF_ERROR(cursor_.Int().status());  // the entity
    if (dimension < 0 || dimension > 3) return cursor_.Fault("the dimension is not 0 to 3");
    for (int k = 0; k < (dimension == 3 ? 0 : dimension); ++k) {
      MORTISE_RETURN_IF_ERROR(cursor_.Double().status());
    }
    return absl::OkStatus();
  }

  // A count on a line of its own, text in all files of version 2.
  absl::StatusOr<std::int64_t> Count22(std::size_t least) {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t count, cursor_.Parse<std::int64_t>());
    const std::size_t place = cursor_.at();
    if (!cursor_.Line().empty()) return places_.Fault(place, "a number must be alone in this line");
    return cursor_.CheckCount(count, least);
  }

  absl::Status ReadNodes() {
    const std::size_t least = cursor_.is_text() ? 2 : 8;
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t blocks, cursor_.Count(least));
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t total, ReadTotals());
    std::int64_t done = 0;
    for (std::int64_t b = 0; b < blocks; ++b) {
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t dimension, cursor_.Int());
      MORTISE_RETURN_IF_ERROR(cursor_.Int().status());  // the entity
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t is_parametric, cursor_.Int());
      if (dimension < 0 || dimension > 3) return cursor_.Fault("the dimension is not 0 to 3");
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t count, cursor_.Count(cursor_.is_text() ? 8 : 32));
      std::vector<std::int64_t> numbers(count);
      std::vector<std::size_t> places(count);
      for (std::int64_t i = 0; i < count; ++i) {
        if (cursor_.is_text()) cursor_.SkipSpace();
        places[i] = cursor_.at();
        MORTISE_ASSIGN_OR_RETURN(numbers[i], cursor_.Size());
        MORTISE_RETURN_IF_ERROR(cursor_.EndLine());
      }
      for (std::int64_t i = 0; i < count; ++i) {
        MORTISE_RETURN_IF_ERROR(ReadNode(numbers[i], places[i]));
        for (std::int64_t k = 0; is_parametric != 0 && k < dimension; ++k) {
          MORTISE_RETURN_IF_ERROR(cursor_.Double().status());
        }
        MORTISE_RETURN_IF_ERROR(cursor_.EndLine());
      }
      done += count;
    }
    return CheckTotal(done, total, "nodes");
  }

  // How many nodes or elements all blocks hold together.
  absl::StatusOr<std::int64_t> ReadTotals() {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t total, cursor_.Size());
    for (int k = 0; k < 2; ++k) MORTISE_RETURN_IF_ERROR(cursor_.Size().status());  // their numbers
    MORTISE_RETURN_IF_ERROR(cursor_.EndLine());
    return total;
  }

  absl::Status CheckTotal(std::int64_t done, std::int64_t total, const char* what) const {
    if (done == total) return absl::OkStatus();
    return places_.Fault(section_place_, absl::StrCat("there should be ", total, " ", what,
                                                      ", and the blocks hold ", done));
  }

  absl::Status ReadElements() {
    const std::size_t least = cursor_.is_text() ? 2 : 8;
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t blocks, cursor_.Count(least));
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t total, ReadTotals());
    std::int64_t done = 0;
    for (std::int64_t b = 0; b < blocks; ++b) {
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t dimension, cursor_.Int());
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t entity, cursor_.Int());
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t type, cursor_.Int());
      MORTISE_ASSIGN_OR_RETURN(const GmshElementKind* kind, KindOf(type));
      if (kind->dimension != dimension) return cursor_.Fault("the dimension is not its elements'");
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t count,
                               cursor_.Count((1 + kind->nodes) * (cursor_.is_text() ? 2 : 8)));
      if (count == 0) continue;
      done += count;
      MORTISE_ASSIGN_OR_RETURN(const std::vector<int>* groups,
                               groups_.Of(GmshEntity{kind->dimension, entity}, cursor_.at()));
      for (std::int64_t i = 0; i < count; ++i) {
        if (cursor_.is_text()) cursor_.SkipSpace();
        const std::size_t place = cursor_.at();
        MORTISE_ASSIGN_OR_RETURN(const std::int64_t number, cursor_.Size());
        std::array<std::int64_t, 10> nodes{};
        for (int k = 0; k < kind->nodes; ++k) {
          MORTISE_ASSIGN_OR_RETURN(nodes[k], cursor_.Size());
        }
        MORTISE_RETURN_IF_ERROR(cursor_.EndLine());
        MORTISE_RETURN_IF_ERROR(AddElement(*kind, number, nodes, *groups, place));
      }
    }
    return CheckTotal(done, total, "elements");
  }

  absl::Status ReadElements22() {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t count, Count22(cursor_.is_text() ? 6 : 4));
    std::int64_t done = 0;
    while (done < count) {
      if (cursor_.is_text()) {
        cursor_.SkipSpace();
        const std::size_t place = cursor_.at();
        MORTISE_ASSIGN_OR_RETURN(const std::int64_t number, cursor_.Int());
        MORTISE_ASSIGN_OR_RETURN(const std::int64_t type, cursor_.Int());
        MORTISE_ASSIGN_OR_RETURN(const std::int64_t tags, cursor_.Int());
        MORTISE_ASSIGN_OR_RETURN(const GmshElementKind* kind, KindOf(type));
        MORTISE_RETURN_IF_ERROR(ReadElement22(*kind, number, tags, place));
        ++done;
        continue;
      }
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t type, cursor_.Int());
      MORTISE_ASSIGN_OR_RETURN(std::int64_t block, cursor_.Int());
      MORTISE_ASSIGN_OR_RETURN(const std::int64_t tags, cursor_.Int());
      MORTISE_ASSIGN_OR_RETURN(const GmshElementKind* kind, KindOf(type));
      if (block < 1 || block > count - done) return cursor_.Fault("a block has a wrong length");
      MORTISE_ASSIGN_OR_RETURN(block, cursor_.CheckCount(block, 4 * (1 + kind->nodes)));
      for (std::int64_t i = 0; i < block; ++i) {
        const std::size_t place = cursor_.at();
        MORTISE_ASSIGN_OR_RETURN(const std::int64_t number, cursor_.Int());
        MORTISE_RETURN_IF_ERROR(ReadElement22(*kind, number, tags, place));
      }
      done += block;
    }
    return absl::OkStatus();
  }

  // From the tags on. The first is the physical group, 0 for none; those after the second tell of
  // partitions.
  absl::Status ReadElement22(const GmshElementKind& kind, std::int64_t number, std::int64_t tags,
                             std::size_t place) {
    if (tags < 0 || tags > 100) return places_.Fault(place, "the number of tags is not 0 to 100");
    std::int64_t tag = 0;
    if (tags > 0) {
      MORTISE_ASSIGN_OR_RETURN(tag, PhysicalTag());
    }
    for (std::int64_t t = 1; t < tags; ++t) MORTISE_RETURN_IF_ERROR(cursor_.Int().status());
    std::array<std::int64_t, 10> nodes{};
    for (int k = 0; k < kind.nodes; ++k) {
      MORTISE_ASSIGN_OR_RETURN(nodes[k], cursor_.Int());
    }
    MORTISE_RETURN_IF_ERROR(cursor_.EndLine());
    if (tag == 0) return AddElement(kind, number, nodes, {}, place);
    MORTISE_ASSIGN_OR_RETURN(const int group,
                             groups_.Of(GmshPhysicalGroup{kind.dimension, tag}, place));
    return AddElement(kind, number, nodes, std::span(&group, 1), place);
  }

  absl::StatusOr<const GmshElementKind*> KindOf(std::int64_t type) const {
    for (const GmshElementKind& kind : kGmshElementKinds) {
      if (kind.type != type) continue;
      if (kind.dimension >= 0) return &kind;
      return cursor_.Fault(absl::StrCat("there are ", kind.name,
                                        ": only tetrahedra of 4 or 10 nodes can be analysed"));
    }
    return cursor_.Fault(absl::StrCat("there are elements of type ", type,
                                      ": only tetrahedra of 4 or 10 nodes can be analysed"));
  }

  absl::Status AddElement(const GmshElementKind& kind, std::int64_t number,
                          std::array<std::int64_t, 10>& nodes, std::span<const int> groups,
                          std::size_t place) {
    if (kind.dimension == 3) {
      if (kind.nodes == 10) std::swap(nodes[8], nodes[9]);  // the middles of 23 and 13
      MORTISE_RETURN_IF_ERROR(
          builder_.AddElement(number, std::span(nodes.data(), kind.nodes), place));
    }
    if (groups.empty()) groups_.CountUngrouped(kind.dimension);
    if (groups.empty() && kind.dimension == 2) {
      return builder_.AddLooseTriangle({nodes[0], nodes[1], nodes[2]}, place);
    }
    for (const int group : groups) {
      if (kind.dimension == 3) {
        MORTISE_RETURN_IF_ERROR(builder_.AddElementMember(group, number, place));
      } else if (kind.dimension == 2) {
        MORTISE_RETURN_IF_ERROR(builder_.AddTriangle(group, {nodes[0], nodes[1], nodes[2]}, place));
      } else {
        for (int k = 0; k < kind.nodes; ++k) {
          MORTISE_RETURN_IF_ERROR(builder_.AddNodeMember(group, nodes[k], place));
        }
      }
    }
    return absl::OkStatus();
  }

  const FilePlaces places_;
  GmshCursor cursor_;
  GroupedMeshBuilder builder_;
  GmshGroups groups_;
  const bool is_version_22_;
  std::size_t section_place_ = 0;  // where the present one begins
  std::set<std::string> seen_;     // sections
};

}  // namespace

absl::StatusOr<GroupedMesh> ReadGmsh(std::string_view bytes) {
  const FilePlaces places(bytes, true);
  constexpr std::string_view kFormat = "$MeshFormat";
  const std::size_t found = bytes.find(kFormat);
  if (found == std::string_view::npos) return InvalidField("mesh_file", "has no $MeshFormat");
  GmshCursor header(bytes.substr(found + kFormat.size()), true, places);
  const auto fault = [&](std::string_view message) { return places.Fault(found, message); };
  const auto version = header.Parse<double>();
  const auto is_binary = header.Parse<std::int64_t>();
  const auto size = header.Parse<std::int64_t>();
  if (!version.ok() || !is_binary.ok() || !size.ok()) return fault("$MeshFormat is broken");
  if (*version != 2.2 && *version != 4.1) {
    return fault(absl::StrCat("MSH version ", *version, " is not read; save it as 4.1 or 2.2"));
  }
  if (*size != 8 || (*is_binary != 0 && *is_binary != 1)) return fault("$MeshFormat is broken");
  if (*is_binary == 1) {
    header.Line();
    const auto one = header.Take<std::int32_t>();
    if (!one.ok() || *one != 1) {
      return fault("its numbers have another byte order than this host's");
    }
  }
  return Reader(bytes, *is_binary == 0, *version == 2.2).Read();
}

}  // namespace mortise::mesh
