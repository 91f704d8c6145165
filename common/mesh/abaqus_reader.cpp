#include "common/mesh/abaqus_reader.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/grouped_mesh_builder.h"

namespace mortise::mesh {
namespace {

// Faces S1 to S4 as sides: 1-2-3, 1-4-2, 2-4-3, 3-4-1 are opposite nodes 4, 3, 1, 2.
constexpr std::array<int, 4> kSides{3, 2, 0, 1};

// Of all sets together, which take a hundred bytes each.
constexpr std::size_t kMostMembers = 10'000'000;

std::string_view Trim(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::string Upper(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return upper;
}

// The fields between commas, without space round them. A last comma opens no field.
std::vector<std::string_view> Fields(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    const std::string_view field = Trim(line.substr(0, comma));
    if (comma != std::string_view::npos || !field.empty()) fields.push_back(field);
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::optional<std::int64_t> Integer(std::string_view text) {
  std::int64_t value = 0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Also with Fortran's D as exponent.
std::optional<double> Number(std::string_view text) {
  std::string plain(text);
  for (char& c : plain) {
    if (c == 'd' || c == 'D') c = 'e';
  }
  std::string_view rest = plain;
  if (rest.starts_with('+')) rest.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc() || end != rest.data() + rest.size()) return std::nullopt;
  return value;
}

// What changes the mesh in ways that are not read; to leave it out would give another mesh.
bool ChangesMesh(const std::string& keyword) {
  static const std::set<std::string> keywords{"NGEN",         "NFILL",
                                              "NCOPY",        "NMAP",
                                              "ELGEN",        "ELCOPY",
                                              "SYSTEM",       "SYMMETRIC MODEL GENERATION",
                                              "IMPERFECTION", "SUBSTRUCTURE GENERATE",
                                              "MODEL CHANGE"};
  return keywords.contains(keyword);
}

// What only opens or closes what is read.
bool IsFrame(const std::string& keyword) {
  static const std::set<std::string> keywords{"HEADING",  "PREPRINT",     "END PART",
                                              "ASSEMBLY", "END ASSEMBLY", "END INSTANCE"};
  return keywords.contains(keyword);
}

class Reader {
 public:
  explicit Reader(std::string_view text)
      : text_(text),
        places_(text, true),
        builder_(places_, GroupedMeshBuilder::Repeats::kRefused) {}

  absl::StatusOr<GroupedMesh> Read() {
    while (at_ < text_.size()) {
      place_ = at_;
      std::string_view line = Trim(NextLine());
      if (line.empty() || line.starts_with("**")) continue;
      if (line.starts_with('*')) {
        std::string keyword_line(line.substr(1));
        while (Trim(keyword_line).ends_with(',') && at_ < text_.size()) {
          keyword_line += NextLine();
        }
        MORTISE_RETURN_IF_ERROR(Finish());
        MORTISE_RETURN_IF_ERROR(ReadKeyword(keyword_line));
      } else {
        MORTISE_RETURN_IF_ERROR(ReadData(line));
      }
    }
    MORTISE_RETURN_IF_ERROR(Finish());
    for (const Entry& entry : entries_) MORTISE_RETURN_IF_ERROR(Resolve(entry));
    if (!ignored_.empty()) {
      std::string note = "not used:";
      for (const std::string& keyword : ignored_) {
        absl::StrAppend(&note, note.ends_with(':') ? " *" : ", *", keyword);
      }
      builder_.AddNote(std::move(note));
    }
    return builder_.Build();
  }

 private:
  enum class Reading {
    kNothing,  // data lines of what is not used
    kText,     // a heading
    kNodes,
    kElements,
    kFaceElements,  // triangles that mark faces
    kNodeSet,
    kElementSet,
    kElementSurface,
    kNodeSurface,
    kInstance,
  };
  // Members of sets wait until everything they may name has been read.
  struct Entry {
    Reading kind;
    int set;                                // index into names_
    std::string_view first, second, third;  // fields of the line; three of a range
    bool is_range;
    std::size_t place;
  };
  struct Set {
    std::vector<std::int64_t> members;
  };

  absl::Status Fault(std::string_view message) const { return places_.Fault(place_, message); }

  std::string_view NextLine() {
    const std::size_t end = text_.find('\n', at_);
    const std::string_view line =
        text_.substr(at_, end == std::string_view::npos ? end : end - at_);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
    return line;
  }

  // The name as it was written first.
  int NameIndex(std::map<std::string, int>& index, std::string_view name) {
    const auto [found, is_new] = index.try_emplace(Upper(name), static_cast<int>(names_.size()));
    if (is_new) names_.emplace_back(name);
    return found->second;
  }

  absl::Status ReadKeyword(std::string_view line) {
    std::map<std::string, std::string> parameters;
    std::string keyword;
    for (const std::string_view field : Fields(line)) {
      if (keyword.empty()) {
        for (const char c : Upper(field)) {
          if (c != ' ' || !keyword.ends_with(' ')) keyword += c;
        }
        continue;
      }
      const std::size_t equals = field.find('=');
      std::string_view value =
          equals == std::string_view::npos ? "" : Trim(field.substr(equals + 1));
      if (value.size() >= 2 && value.front() == '"' && value.back() == '"') {
        value = value.substr(1, value.size() - 2);
      }
      parameters[Upper(Trim(field.substr(0, equals)))] = std::string(value);
    }
    const bool is_word = !keyword.empty() && keyword.size() <= 40 &&
                         std::all_of(keyword.begin(), keyword.end(), [](unsigned char c) {
                           return std::isalnum(c) != 0 || c == ' ' || c == '-' || c == '_';
                         });
    if (!is_word) return Fault("a keyword is missing after '*'");
    return Begin(keyword, parameters);
  }

  absl::Status Begin(const std::string& keyword,
                     const std::map<std::string, std::string>& parameters) {
    const auto parameter = [&](const char* name) {
      const auto found = parameters.find(name);
      return found == parameters.end() ? std::string() : found->second;
    };
    reading_ = Reading::kNothing;
    group_ = -1;
    is_range_ = parameters.contains("GENERATE");
    if (keyword == "INCLUDE") {
      return Fault("*INCLUDE: one file is uploaded; put the included one in its place");
    }
    if (ChangesMesh(keyword)) return Fault(absl::StrCat("*", keyword, " is not read"));
    if (keyword == "NODE") return BeginNodes(parameters.contains("SYSTEM"), parameter("NSET"));
    if (keyword == "ELEMENT") return BeginElements(parameter("TYPE"), parameter("ELSET"));
    if (keyword == "NSET") return BeginSet(Reading::kNodeSet, parameter("NSET"));
    if (keyword == "ELSET") return BeginSet(Reading::kElementSet, parameter("ELSET"));
    if (keyword == "SURFACE") return BeginSurface(parameter("TYPE"), parameter("NAME"));
    if (keyword == "PART" && std::exchange(has_part_, true)) {
      return Fault("there is a second *PART; only one can be read");
    }
    if (keyword == "INSTANCE") {
      reading_ = Reading::kInstance;
      if (std::exchange(has_instance_, true)) {
        return Fault("there is a second *INSTANCE; only one can be read");
      }
    }
    if (keyword == "HEADING") reading_ = Reading::kText;
    if (!IsFrame(keyword) && keyword != "PART" && keyword != "INSTANCE") {
      if (ignored_.size() < 50) ignored_.insert(keyword);
    }
    return absl::OkStatus();
  }

  absl::Status BeginNodes(bool has_system, const std::string& set) {
    if (has_system) return Fault("*NODE with SYSTEM is not read; give x, y and z");
    reading_ = Reading::kNodes;
    if (!set.empty()) group_ = NameIndex(node_sets_, set);
    return set.empty() ? absl::OkStatus() : builder_.AddNodeGroup(names_[group_], place_);
  }

  absl::Status BeginElements(const std::string& given, const std::string& set) {
    const std::string type = Upper(given);
    static const std::map<std::string, int> kFaces{
        {"CPS3", 3}, {"CPS6", 6}, {"SFM3D3", 3}, {"SFM3D6", 6}};
    const auto face = kFaces.find(type);
    if (face != kFaces.end()) {
      reading_ = Reading::kFaceElements;
      nodes_of_element_ = face->second;
      if (!set.empty()) group_ = NameIndex(face_sets_, set);
      return absl::OkStatus();
    }
    if (type != "C3D4" && type != "C3D10" && type != "C3D10M") {
      const bool is_plain = type.size() <= 16 && std::all_of(type.begin(), type.end(), [](char c) {
                              return std::isalnum(static_cast<unsigned char>(c)) != 0;
                            });
      return Fault(absl::StrCat("elements of type '", is_plain ? type : "?",
                                "': only C3D4, C3D10 and C3D10M can be analysed"));
    }
    reading_ = Reading::kElements;
    nodes_of_element_ = type == "C3D4" ? 4 : 10;
    if (set.empty()) return absl::OkStatus();
    group_ = NameIndex(element_sets_, set);
    return builder_.AddElementGroup(names_[group_], place_);
  }

  absl::Status BeginSet(Reading kind, const std::string& name) {
    if (name.empty()) return Fault("a set without a name");
    reading_ = kind;
    group_ = NameIndex(kind == Reading::kNodeSet ? node_sets_ : element_sets_, name);
    return kind == Reading::kNodeSet ? builder_.AddNodeGroup(names_[group_], place_)
                                     : builder_.AddElementGroup(names_[group_], place_);
  }

  absl::Status BeginSurface(const std::string& type, const std::string& name) {
    if (name.empty()) return Fault("*SURFACE without a NAME");
    if (!type.empty() && Upper(type) != "ELEMENT" && Upper(type) != "NODE") {
      return Fault("*SURFACE must be of TYPE=ELEMENT or TYPE=NODE");
    }
    const bool is_node = Upper(type) == "NODE";
    reading_ = is_node ? Reading::kNodeSurface : Reading::kElementSurface;
    group_ = NameIndex(is_node ? node_sets_ : surfaces_, name);
    return is_node ? builder_.AddNodeGroup(names_[group_], place_)
                   : builder_.AddFaceGroup(names_[group_], place_);
  }

  absl::Status ReadData(std::string_view line) {
    switch (reading_) {
      case Reading::kNothing:
      case Reading::kText:
        return absl::OkStatus();
      case Reading::kInstance:
        return Fault("a moved *INSTANCE is not read");
      case Reading::kNodes:
        return ReadNode(line);
      case Reading::kElements:
      case Reading::kFaceElements:
        return ReadElement(line);
      default:
        return ReadMembers(line);
    }
  }

  absl::Status ReadNode(std::string_view line) {
    const std::vector<std::string_view> fields = Fields(line);
    const auto number = Integer(fields.empty() ? "" : fields[0]);
    if (!number || fields.size() > 4)
      return Fault("a node must be a number and up to three places");
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (std::size_t k = 1; k < fields.size(); ++k) {
      const auto x = fields[k].empty() ? std::optional<double>(0) : Number(fields[k]);
      if (!x) return Fault(absl::StrCat("a coordinate of node ", *number, " is not a number"));
      position[static_cast<Eigen::Index>(k) - 1] = *x;
    }
    MORTISE_RETURN_IF_ERROR(builder_.AddNode(*number, position, place_));
    if (group_ < 0) return absl::OkStatus();
    node_members_[group_].members.push_back(*number);
    return builder_.AddNodeMember(names_[group_], *number, place_);
  }

  // An element may go on over several lines.
  absl::Status ReadElement(std::string_view line) {
    if (numbers_.empty()) element_place_ = place_;
    for (const std::string_view field : Fields(line)) {
      const auto number = Integer(field);
      if (!number) return Fault("an element must be whole numbers");
      numbers_.push_back(*number);
    }
    const std::size_t wanted = 1 + static_cast<std::size_t>(nodes_of_element_);
    if (numbers_.size() > wanted) {
      return Fault(
          absl::StrCat("element ", numbers_[0], " has more than ", nodes_of_element_, " nodes"));
    }
    if (numbers_.size() < wanted) return absl::OkStatus();
    const std::vector<std::int64_t> numbers = std::exchange(numbers_, {});
    if (reading_ == Reading::kFaceElements) {
      triangles_[numbers[0]] = {numbers[1], numbers[2], numbers[3]};
      if (group_ < 0) return absl::OkStatus();
      return builder_.AddTriangle(names_[group_], triangles_[numbers[0]], element_place_);
    }
    MORTISE_RETURN_IF_ERROR(
        builder_.AddElement(numbers[0], std::span(numbers).subspan(1), element_place_));
    if (group_ < 0) return absl::OkStatus();
    element_members_[group_].members.push_back(numbers[0]);
    return builder_.AddElementMember(names_[group_], numbers[0], element_place_);
  }

  absl::Status ReadMembers(std::string_view line) {
    const std::vector<std::string_view> fields = Fields(line);
    const auto field = [&](std::size_t k) { return k < fields.size() ? fields[k] : ""; };
    MORTISE_RETURN_IF_ERROR(Spend(fields.size()));
    if (is_range_ || reading_ == Reading::kElementSurface) {
      entries_.push_back({reading_, group_, field(0), field(1), field(2), is_range_, place_});
      return absl::OkStatus();
    }
    for (const std::string_view member : fields) {
      // A node surface may give a weight beside each member; it has no meaning here.
      entries_.push_back({reading_, group_, member, "", "", false, place_});
      if (reading_ == Reading::kNodeSurface) break;
    }
    return absl::OkStatus();
  }

  // An element that is not finished.
  absl::Status Finish() {
    if (numbers_.empty()) return absl::OkStatus();
    return places_.Fault(element_place_, absl::StrCat("element ", numbers_[0], " has fewer than ",
                                                      nodes_of_element_, " nodes"));
  }

  absl::Status Resolve(const Entry& entry) {
    place_ = entry.place;
    if (entry.kind == Reading::kElementSurface) return ResolveSurface(entry);
    const bool of_nodes = entry.kind != Reading::kElementSet;
    if (entry.is_range) return ResolveRange(entry, of_nodes);
    if (const auto number = Integer(entry.first)) return AddMember(entry.set, *number, of_nodes);
    const auto& sets = of_nodes ? node_sets_ : element_sets_;
    const auto found = sets.find(Upper(entry.first));
    const auto& members = of_nodes ? node_members_ : element_members_;
    const auto known = found == sets.end() ? members.end() : members.find(found->second);
    if (known == members.end() || found->second == entry.set) {
      return Fault("a member is neither a number nor the name of an earlier set");
    }
    MORTISE_RETURN_IF_ERROR(Spend(known->second.members.size()));
    for (const std::int64_t member : std::vector(known->second.members)) {
      MORTISE_RETURN_IF_ERROR(AddMember(entry.set, member, of_nodes));
    }
    return absl::OkStatus();
  }

  // Sets that name each other may multiply; what they hold in all is limited.
  absl::Status Spend(std::size_t members) {
    members_ += members;
    if (members_ <= kMostMembers) return absl::OkStatus();
    return Fault(absl::StrCat("the sets have more than ", kMostMembers, " members"));
  }

  absl::Status AddMember(int set, std::int64_t number, bool of_nodes) {
    // Elements that only mark faces may be in sets with others.
    if (!of_nodes) {
      const auto triangle = triangles_.find(number);
      if (triangle != triangles_.end() && !builder_.HasElement(number)) {
        return builder_.AddTriangle(names_[set], triangle->second, place_);
      }
    }
    (of_nodes ? node_members_ : element_members_)[set].members.push_back(number);
    return of_nodes ? builder_.AddNodeMember(names_[set], number, place_)
                    : builder_.AddElementMember(names_[set], number, place_);
  }

  absl::Status ResolveRange(const Entry& entry, bool of_nodes) {
    const auto first = Integer(entry.first), last = Integer(entry.second);
    const auto step = entry.third.empty() ? std::optional<std::int64_t>(1) : Integer(entry.third);
    if (!first || !last || !step || *step < 1 || *last < *first || *first < 0) {
      return Fault("a range must be first, last and step, of whole numbers");
    }
    const std::int64_t count = (*last - *first) / *step + 1;
    // Members must exist, and those that do are no more than the file has bytes.
    if (count > static_cast<std::int64_t>(text_.size())) {
      return Fault(absl::StrCat("a range names ", count, " members, more than there can be"));
    }
    MORTISE_RETURN_IF_ERROR(Spend(static_cast<std::size_t>(count)));
    for (std::int64_t i = 0; i < count; ++i) {
      MORTISE_RETURN_IF_ERROR(AddMember(entry.set, *first + i * *step, of_nodes));
    }
    return absl::OkStatus();
  }

  absl::Status ResolveSurface(const Entry& entry) {
    const std::string label = Upper(entry.second);
    if (label.size() != 2 || label[0] != 'S' || label[1] < '1' || label[1] > '4') {
      return Fault("a line of a surface must be an element or a set of them, and S1 to S4");
    }
    const int side = kSides[label[1] - '1'];
    if (const auto number = Integer(entry.first)) {
      return builder_.AddSideMember(names_[entry.set], *number, side, place_);
    }
    const auto found = element_sets_.find(Upper(entry.first));
    const auto members = found == element_sets_.end() ? element_members_.end()
                                                      : element_members_.find(found->second);
    if (members == element_members_.end()) {
      return Fault("a surface names a set of elements that does not exist");
    }
    MORTISE_RETURN_IF_ERROR(Spend(members->second.members.size()));
    for (const std::int64_t member : members->second.members) {
      MORTISE_RETURN_IF_ERROR(builder_.AddSideMember(names_[entry.set], member, side, place_));
    }
    return absl::OkStatus();
  }

  const std::string_view text_;
  const FilePlaces places_;
  GroupedMeshBuilder builder_;
  std::size_t at_ = 0;
  std::size_t place_ = 0;  // where the present line begins
  Reading reading_ = Reading::kNothing;
  int group_ = -1;  // index into names_
  bool is_range_ = false, has_part_ = false, has_instance_ = false;
  int nodes_of_element_ = 0;
  std::vector<std::int64_t> numbers_;  // of an element that goes on
  std::size_t element_place_ = 0;
  std::size_t members_ = 0;         // of all sets, as far as they are known
  std::vector<std::string> names_;  // of sets and surfaces
  std::map<std::string, int> node_sets_, element_sets_, face_sets_, surfaces_;  // by upper case
  std::map<int, Set> node_members_, element_members_;
  std::map<std::int64_t, std::array<std::int64_t, 3>> triangles_;  // that mark faces
  std::vector<Entry> entries_;
  std::set<std::string> ignored_;  // keywords
};

}  // namespace

absl::StatusOr<GroupedMesh> ReadAbaqus(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || text[first] != '*') {
    return InvalidField("mesh_file",
                        "is neither Gmsh's MSH, which begins with '$', nor an input file of Abaqus "
                        "or CalculiX, which begins with '*'");
  }
  return Reader(text).Read();
}

}  // namespace mortise::mesh
