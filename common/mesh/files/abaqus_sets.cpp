#include "common/mesh/files/abaqus_sets.h"

#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/files/abaqus_text.h"

namespace mortise::mesh {
namespace {

using abaqus::Fields;
using abaqus::Integer;
using abaqus::Upper;

// Faces S1 to S4 as sides: 1-2-3, 1-4-2, 2-4-3, 3-4-1 are opposite nodes 4, 3, 1, 2.
constexpr std::array<int, 4> kSides{3, 2, 0, 1};

// Of all sets together, which take some fifty bytes each.
constexpr std::size_t kMaxMembers = 10'000'000;

}  // namespace

absl::StatusOr<int> AbaqusSets::Open(Kind kind, const std::string& name, Owner owner,
                                     std::size_t place) {
  const auto [found, is_new] = index_[static_cast<std::size_t>(kind)].try_emplace(
      {owner, Upper(name)}, static_cast<int>(sets_.size()));
  if (!is_new) return found->second;
  sets_.push_back({kind, name, owner, place, {}, -1, -1, -1});
  Set& set = sets_.back();
  if (kind == Kind::kNodes) {
    MORTISE_ASSIGN_OR_RETURN(set.group, builder_.AddNodeGroup(name, place, owner));
  } else if (kind == Kind::kElements) {
    MORTISE_ASSIGN_OR_RETURN(set.group, builder_.AddElementGroup(name, place, owner));
  } else if (kind == Kind::kFaces) {
    MORTISE_RETURN_IF_ERROR(AddFaceGroup(set, place));
  } else {
    MORTISE_RETURN_IF_ERROR(AddNodeGroup(set, place));
  }
  return found->second;
}

absl::Status AbaqusSets::AddFaceGroup(Set& set, std::size_t place) {
  if (set.face_group >= 0) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(set.face_group, builder_.AddFaceGroup(set.name, place, set.owner));
  return absl::OkStatus();
}

absl::Status AbaqusSets::AddMember(int set, std::int64_t number, std::size_t place) {
  Set& grown = sets_[set];
  grown.members.push_back(number);
  return grown.kind == Kind::kNodes ? builder_.AddNodeMember(grown.group, number, place)
                                    : builder_.AddElementMember(grown.group, number, place);
}

absl::Status AbaqusSets::AddNodeGroup(Set& set, std::size_t place) {
  if (set.node_group >= 0) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(set.node_group, builder_.AddNodeGroup(set.name, place, set.owner));
  return absl::OkStatus();
}

absl::Status AbaqusSets::AddMark(int set, std::int64_t number, std::span<const std::int64_t> nodes,
                                 bool is_line, std::size_t place) {
  Mark mark{{}, static_cast<int>(nodes.size()), is_line};
  std::copy(nodes.begin(), nodes.end(), mark.nodes.begin());
  if (!marks_.emplace(number, mark).second) {
    return places_.Fault(place, absl::StrCat("there is an element ", number, " already"));
  }
  if (set == kNoSet) {
    return is_line ? absl::OkStatus()
                   : builder_.AddLooseTriangle({nodes[0], nodes[1], nodes[2]}, place);
  }
  sets_[set].members.push_back(number);
  return AddMarked(sets_[set], mark, place);
}

// What the element marks goes into the set's group of faces or nodes.
absl::Status AbaqusSets::AddMarked(Set& set, const Mark& mark, std::size_t place) {
  if (!mark.is_line) {
    MORTISE_RETURN_IF_ERROR(AddFaceGroup(set, place));
    return builder_.AddTriangle(set.face_group, {mark.nodes[0], mark.nodes[1], mark.nodes[2]},
                                place);
  }
  MORTISE_RETURN_IF_ERROR(AddNodeGroup(set, place));
  for (int k = 0; k < mark.count; ++k) {
    MORTISE_RETURN_IF_ERROR(builder_.AddNodeMember(set.node_group, mark.nodes[k], place));
  }
  return absl::OkStatus();
}

void AbaqusSets::AddNodesOf(const List& list, const std::string& elements, std::string_view line) {
  entries_.push_back({line, list.set, false, list.of, static_cast<int>(named_.size())});
  named_.push_back(elements);
}

absl::Status AbaqusSets::AddLine(const List& list, std::string_view line) {
  const std::vector<std::string_view> fields = Fields(line);
  MORTISE_RETURN_IF_ERROR(Spend(fields.size(), PlaceOf(line)));
  if (list.is_range || sets_[list.set].kind == Kind::kFaces) {
    entries_.push_back({line, list.set, list.is_range, list.of});
    return absl::OkStatus();
  }
  if (list.has_weights && fields.size() > 2) {
    return places_.Fault(PlaceOf(line), "a line must be one member, and perhaps its weight");
  }
  for (const std::string_view member : fields) {
    if (member.empty()) return places_.Fault(PlaceOf(line), "a member of a set is missing");
    entries_.push_back({member, list.set, false, list.of});
    if (list.has_weights) break;  // they have no meaning here
  }
  return absl::OkStatus();
}

absl::Status AbaqusSets::Resolve() {
  std::sort(assembly_nodes_.begin(), assembly_nodes_.end());
  for (const Entry& entry : entries_) MORTISE_RETURN_IF_ERROR(ResolveEntry(entry));
  NoteDoubts();
  if (const std::size_t count = assembly_nodes_.size(); count > 0) {
    builder_.AddNote(absl::StrCat(count,
                                  count == 1
                                      ? " node of the assembly belongs to no element and was"
                                      : " nodes of the assembly belong to no element and were",
                                  " left out"));
  }
  return absl::OkStatus();
}

namespace {

// Members as a set lists them, of surfaces with the face.
using Listed = std::vector<std::pair<std::int64_t, std::string>>;

// Whether the list is two sorted ones behind each other.
bool IsTwoLists(const Listed& listed) {
  const auto second = std::is_sorted_until(listed.begin(), listed.end());
  return second - listed.begin() >= 3 && listed.end() - second >= 3 &&
         std::is_sorted(second, listed.end());
}

}  // namespace

// Nobody lists a member twice in one go; where one is, another may have been meant. And programs
// list them in order: where they begin anew, the keyword of another set may be gone.
void AbaqusSets::NoteDoubts() {
  Listed listed;
  std::size_t repeated = 0, joined = 0, place = 0;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    const bool is_of_faces = sets_[entry.set].kind == Kind::kFaces;
    const std::vector<std::string_view> fields =
        is_of_faces ? Fields(entry.text) : std::vector{entry.text};
    const auto number = entry.is_range || fields.empty() ? std::nullopt : Integer(fields[0]);
    if (number) listed.emplace_back(*number, fields.size() > 1 ? Upper(fields[1]) : "");
    if (i + 1 < entries_.size() && entries_[i + 1].set == entry.set) continue;
    if (repeated + joined == 0) place = PlaceOf(entry.text);
    joined += IsTwoLists(listed) ? 1 : 0;
    std::sort(listed.begin(), listed.end());
    const auto distinct = std::unique(listed.begin(), listed.end()) - listed.begin();
    repeated += listed.size() - static_cast<std::size_t>(distinct);
    listed.clear();
  }
  const std::string where = places_.Where(place);
  if (repeated > 0) {
    builder_.AddNote(
        absl::StrCat(where, ": up to here a set lists ", repeated,
                     repeated == 1 ? " member twice: another" : " members twice: others",
                     " may have been meant"));
  }
  if (joined > 0) {
    builder_.AddNote(absl::StrCat(where,
                                  ": up to here the members of a set are in order but for one "
                                  "place: the keyword of another may be missing there"));
  }
}

// Sets that name each other may multiply; what they hold in all is limited.
absl::Status AbaqusSets::Spend(std::size_t members, std::size_t place) {
  members_ += members;
  if (members_ <= kMaxMembers) return absl::OkStatus();
  return places_.Fault(place, absl::StrCat("the sets have more than ", kMaxMembers, " members"));
}

std::pair<std::string_view, AbaqusSets::Owner> AbaqusSets::WithoutInstance(std::string_view name,
                                                                           Owner of) const {
  const std::size_t length = instance_.size();
  const bool is_named = length > 0 && name.size() > length && name[length] == '.' &&
                        Upper(name.substr(0, length)) == Upper(instance_);
  return is_named ? std::pair(name.substr(length + 1), Owner::kPart) : std::pair(name, of);
}

// A set of its owner, or of the other if it has none of the name, that is earlier than `place`;
// kNoSet if there is none but `except`.
int AbaqusSets::FindSet(Kind kind, std::string_view name, Owner of, std::size_t place,
                        int except) const {
  const Index& index = index_[static_cast<std::size_t>(kind)];
  const Owner other = of == Owner::kPart ? Owner::kWhole : Owner::kPart;
  const std::string upper = Upper(name);
  for (const Owner owner : {of, other}) {
    const auto found = index.find({owner, upper});
    if (found == index.end() || found->second == except) continue;
    if (sets_[found->second].place < place) return found->second;
  }
  return kNoSet;
}

absl::Status AbaqusSets::ResolveEntry(const Entry& entry) {
  const Kind kind = sets_[entry.set].kind;
  if (entry.elements >= 0) return ResolveNodesOf(entry);
  if (kind == Kind::kFaces) return ResolveSurface(entry);
  if (entry.is_range) return ResolveRange(entry);
  const std::size_t place = PlaceOf(entry.text);
  const auto [name, of] = WithoutInstance(entry.text, entry.of);
  if (const auto number = Integer(name)) return ResolveMember(entry, *number, of);
  const int named = kind == Kind::kElements ? FindElements(name, of, place, entry.set)
                                            : FindSet(kind, name, of, place, entry.set);
  if (named == kNoSet) {
    return Fault(entry, "a member is neither a number nor the name of an earlier set");
  }
  MORTISE_RETURN_IF_ERROR(Spend(sets_[named].members.size(), place));
  for (const std::int64_t member : std::vector(sets_[named].members)) {
    MORTISE_RETURN_IF_ERROR(ResolveMember(entry, member, Owner::kPart));
  }
  return absl::OkStatus();
}

// A set of elements of whatever kind; one of faces only where triangles are its members.
int AbaqusSets::FindElements(std::string_view name, Owner of, std::size_t place, int except) const {
  const int elements = FindSet(Kind::kElements, name, of, place, except);
  if (elements != kNoSet) return elements;
  const int faces = FindSet(Kind::kFaces, name, of, place, except);
  if (faces != kNoSet && !sets_[faces].members.empty()) return faces;
  return FindSet(Kind::kLines, name, of, place, except);
}

std::span<const std::int64_t> AbaqusSets::NodesOf(std::int64_t element) const {
  const std::span<const std::int64_t> nodes = builder_.ElementNodes(element);
  const auto mark = marks_.find(element);
  if (!nodes.empty() || mark == marks_.end()) return nodes;
  return std::span(mark->second.nodes).first(static_cast<std::size_t>(mark->second.count));
}

absl::Status AbaqusSets::ResolveNodesOf(const Entry& entry) {
  const std::size_t place = PlaceOf(entry.text);
  const auto [name, of] = WithoutInstance(named_[entry.elements], entry.of);
  const int named = FindElements(name, of, place, kNoSet);
  if (named == kNoSet) return Fault(entry, "*NSET with ELSET names no earlier set of elements");
  std::vector<std::int64_t> nodes;
  for (const std::int64_t element : sets_[named].members) {
    const std::span<const std::int64_t> own = NodesOf(element);
    MORTISE_RETURN_IF_ERROR(Spend(own.size(), place));
    nodes.insert(nodes.end(), own.begin(), own.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  for (const std::int64_t node : nodes) MORTISE_RETURN_IF_ERROR(AddMember(entry.set, node, place));
  return absl::OkStatus();
}

absl::Status AbaqusSets::ResolveMember(const Entry& entry, std::int64_t number, Owner of) {
  const std::size_t place = PlaceOf(entry.text);
  Set& set = sets_[entry.set];
  if (set.kind == Kind::kNodes) {
    const bool is_left_out =
        of == Owner::kWhole &&
        std::binary_search(assembly_nodes_.begin(), assembly_nodes_.end(), number);
    return is_left_out ? absl::OkStatus() : AddMember(entry.set, number, place);
  }
  // Elements that only mark may be in sets with others.
  const auto mark = marks_.find(number);
  if (mark == marks_.end() || builder_.HasElement(number)) {
    return AddMember(entry.set, number, place);
  }
  set.members.push_back(number);
  return AddMarked(set, mark->second, place);
}

absl::Status AbaqusSets::ResolveRange(const Entry& entry) {
  const std::vector<std::string_view> fields = Fields(entry.text);
  const auto field = [&](std::size_t k) { return k < fields.size() ? fields[k] : ""; };
  const auto first = Integer(field(0)), last = Integer(field(1));
  const auto step = field(2).empty() ? std::optional<std::int64_t>(1) : Integer(field(2));
  if (fields.size() > 3 || !first || !last || !step || *step < 1 || *last < *first || *first < 0) {
    return Fault(entry, "a range must be first, last and step, of whole numbers");
  }
  const std::int64_t steps = (*last - *first) / *step;
  // Members must exist, and those that do are no more than the file has bytes.
  if (steps >= static_cast<std::int64_t>(text_.size())) {
    return Fault(entry,
                 absl::StrCat("a range takes ", steps, " steps, more than there can be members"));
  }
  MORTISE_RETURN_IF_ERROR(Spend(static_cast<std::size_t>(steps) + 1, PlaceOf(entry.text)));
  for (std::int64_t i = 0; i <= steps; ++i) {
    MORTISE_RETURN_IF_ERROR(ResolveMember(entry, *first + i * *step, entry.of));
  }
  return absl::OkStatus();
}

absl::Status AbaqusSets::ResolveSurface(const Entry& entry) {
  const std::vector<std::string_view> fields = Fields(entry.text);
  const std::string label = Upper(fields.size() > 1 ? fields[1] : "");
  if (fields.size() > 2 || label.size() != 2 || label[0] != 'S' || label[1] < '1' ||
      label[1] > '4') {
    return Fault(entry, "a line of a surface must be an element or a set of them, and S1 to S4");
  }
  const int side = kSides[label[1] - '1'];
  const int group = sets_[entry.set].face_group;
  const std::size_t place = PlaceOf(entry.text);
  const auto [name, of] = WithoutInstance(fields[0], entry.of);
  if (const auto number = Integer(name)) {
    return builder_.AddSideMember(group, *number, side, place);
  }
  const int named = FindSet(Kind::kElements, name, of, place, kNoSet);
  if (named == kNoSet) return Fault(entry, "a surface names no earlier set of elements");
  MORTISE_RETURN_IF_ERROR(Spend(sets_[named].members.size(), place));
  for (const std::int64_t member : sets_[named].members) {
    MORTISE_RETURN_IF_ERROR(builder_.AddSideMember(group, member, side, place));
  }
  return absl::OkStatus();
}

}  // namespace mortise::mesh
