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

// Of all sets together, which take some fifty bytes each.
constexpr std::size_t kMostMembers = 10'000'000;

// Of a line that is split into fields, in bytes; a keyword's with all lines it goes on over.
constexpr std::size_t kLongestLine = 65'536;

using Owner = GroupedMeshBuilder::Owner;

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

// Whether a name of a part may be in messages and in names of groups.
bool IsFit(std::string_view name) {
  return !name.empty() && name.size() <= 80 && IsPlainText(name);
}

std::string Quoted(std::string_view name) {
  return IsFit(name) ? absl::StrCat("'", absl::string_view(name.data(), name.size()), "'") : "'?'";
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
  static const std::set<std::string> keywords{"HEADING",  "PREPRINT",    "PART",
                                              "END PART", "ASSEMBLY",    "END ASSEMBLY",
                                              "INSTANCE", "END INSTANCE"};
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
        MORTISE_RETURN_IF_ERROR(Finish());
        MORTISE_ASSIGN_OR_RETURN(const std::string keyword_line, KeywordLine(line.substr(1)));
        MORTISE_RETURN_IF_ERROR(ReadKeyword(keyword_line));
      } else {
        MORTISE_RETURN_IF_ERROR(ReadData(line));
      }
    }
    MORTISE_RETURN_IF_ERROR(Finish());
    std::sort(assembly_nodes_.begin(), assembly_nodes_.end());
    for (const Entry& entry : entries_) MORTISE_RETURN_IF_ERROR(Resolve(entry));
    if (!ignored_.empty()) {
      std::string note = "not used:";
      for (const std::string& keyword : ignored_) {
        absl::StrAppend(&note, note.ends_with(':') ? " *" : ", *", keyword);
      }
      builder_.AddNote(std::move(note));
    }
    if (const std::size_t count = assembly_nodes_.size(); count > 0) {
      builder_.AddNote(absl::StrCat(count,
                                    count == 1
                                        ? " node of the assembly belongs to no element and was"
                                        : " nodes of the assembly belong to no element and were",
                                    " left out"));
    }
    return builder_.Build();
  }

 private:
  enum class Reading : std::uint8_t {
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
    std::string_view text;  // a member; or a line, of a range or of a surface of element faces
    int set;                // index into sets_
    Reading kind;
    bool is_range;
    Owner of;  // whose numbers and names they are
  };
  struct Set {
    std::string name;  // as it was written first
    Owner owner;
    std::size_t place;  // of its first line
    std::vector<std::int64_t> members;
    int group, face_group;  // the builder's, -1 before it is made
  };
  using Sets = std::map<std::pair<Owner, std::string>, int>;  // indices into sets_, by upper case

  absl::Status Fault(std::string_view message) const { return places_.Fault(place_, message); }

  std::string_view NextLine() {
    const std::size_t end = text_.find('\n', at_);
    const std::string_view line =
        text_.substr(at_, end == std::string_view::npos ? end : end - at_);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
    return line;
  }

  // With the lines it goes on over, each of which ends with a comma but the last.
  absl::StatusOr<std::string> KeywordLine(std::string_view line) {
    std::string whole;
    while (true) {
      if (whole.size() + line.size() > kLongestLine) {
        return Fault(absl::StrCat("a keyword takes more than ", kLongestLine, " bytes"));
      }
      whole += line;
      if (!whole.ends_with(',') || at_ >= text_.size()) return whole;
      line = Trim(NextLine());
    }
  }

  // What is beside a part, and not in its instance, is the assembly's.
  bool InAssembly() const { return (has_part_ || has_instance_) && !in_part_; }
  Owner Present() const { return in_part_ ? Owner::kPart : Owner::kWhole; }

  int SetIndex(Sets& index, std::string_view name) {
    const auto [found, is_new] =
        index.try_emplace({Present(), Upper(name)}, static_cast<int>(sets_.size()));
    if (is_new) sets_.push_back({std::string(name), Present(), place_, {}, -1, -1});
    return found->second;
  }

  absl::Status AddNodeGroup(int set) {
    if (sets_[set].group >= 0) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(sets_[set].group,
                             builder_.AddNodeGroup(sets_[set].name, place_, sets_[set].owner));
    return absl::OkStatus();
  }

  absl::Status AddElementGroup(int set) {
    if (sets_[set].group >= 0) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(sets_[set].group,
                             builder_.AddElementGroup(sets_[set].name, place_, sets_[set].owner));
    return absl::OkStatus();
  }

  absl::Status AddFaceGroup(int set) {
    if (sets_[set].face_group >= 0) return absl::OkStatus();
    MORTISE_ASSIGN_OR_RETURN(sets_[set].face_group,
                             builder_.AddFaceGroup(sets_[set].name, place_, sets_[set].owner));
    return absl::OkStatus();
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
    set_ = -1;
    of_ = Present();
    is_range_ = parameters.contains("GENERATE");
    if (keyword == "INCLUDE") {
      return Fault("*INCLUDE: one file is uploaded; put the included one in its place");
    }
    if (ChangesMesh(keyword)) return Fault(absl::StrCat("*", keyword, " is not read"));
    if (keyword == "NODE") return BeginNodes(parameters.contains("SYSTEM"), parameter("NSET"));
    if (keyword == "ELEMENT") return BeginElements(parameter("TYPE"), parameter("ELSET"));
    if (keyword == "NSET" || keyword == "ELSET") {
      MORTISE_RETURN_IF_ERROR(CheckInstance(parameters));
      return BeginSet(keyword == "NSET" ? Reading::kNodeSet : Reading::kElementSet,
                      parameter(keyword.c_str()));
    }
    if (keyword == "SURFACE") return BeginSurface(parameter("TYPE"), parameter("NAME"));
    if (keyword == "PART") return BeginPart(parameter("NAME"));
    if (keyword == "INSTANCE") return BeginInstance(parameter("NAME"));
    if (in_part_ && (keyword == "ASSEMBLY" || keyword == "END ASSEMBLY")) return Unended(keyword);
    if (keyword == "END PART" || keyword == "END INSTANCE") in_part_ = false;
    if (keyword == "HEADING") reading_ = Reading::kText;
    if (!IsFrame(keyword) && ignored_.size() < 50) ignored_.insert(keyword);
    return absl::OkStatus();
  }

  // What follows would be taken for the part's.
  absl::Status Unended(const std::string& keyword) const {
    return Fault(absl::StrCat("*END ", has_instance_ ? "INSTANCE" : "PART", " is missing before *",
                              keyword));
  }

  absl::Status BeginPart(const std::string& name) {
    if (std::exchange(has_part_, true)) {
      return Fault(
          absl::StrCat("there is a second *PART, ", Quoted(name), "; only one can be read"));
    }
    if (IsFit(name)) builder_.SetPartName(name);
    in_part_ = true;
    return absl::OkStatus();
  }

  // May hold the nodes and elements in place of the part, and has them then as its own.
  absl::Status BeginInstance(const std::string& name) {
    if (has_instance_) {
      return Fault(
          absl::StrCat("there is a second *INSTANCE, ", Quoted(name), "; only one can be read"));
    }
    if (in_part_) return Unended("INSTANCE");
    if (!has_part_ && IsFit(name)) builder_.SetPartName(name);
    instance_ = name;
    in_part_ = has_instance_ = true;
    reading_ = Reading::kInstance;
    return absl::OkStatus();
  }

  // Members of a set of the assembly that names the instance are the part's.
  absl::Status CheckInstance(const std::map<std::string, std::string>& parameters) {
    const auto found = parameters.find("INSTANCE");
    if (found == parameters.end()) return absl::OkStatus();
    of_ = Owner::kPart;
    if (has_instance_ && Upper(found->second) == Upper(instance_)) return absl::OkStatus();
    return Fault(absl::StrCat("there is no *INSTANCE ", Quoted(found->second)));
  }

  absl::Status BeginNodes(bool has_system, const std::string& set) {
    if (has_system) return Fault("*NODE with SYSTEM is not read; give x, y and z");
    reading_ = Reading::kNodes;
    if (set.empty()) return absl::OkStatus();
    set_ = SetIndex(node_sets_, set);
    return AddNodeGroup(set_);
  }

  absl::Status BeginElements(const std::string& given, const std::string& set) {
    if (InAssembly()) {
      return Fault("elements of the assembly itself are not read; they must be in the *PART");
    }
    const std::string type = Upper(given);
    static const std::map<std::string, int> kFaces{
        {"CPS3", 3}, {"CPS6", 6}, {"SFM3D3", 3}, {"SFM3D6", 6}};
    const auto face = kFaces.find(type);
    if (face != kFaces.end()) {
      reading_ = Reading::kFaceElements;
      nodes_of_element_ = face->second;
      if (set.empty()) return absl::OkStatus();
      set_ = SetIndex(face_sets_, set);
      return AddFaceGroup(set_);
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
    set_ = SetIndex(element_sets_, set);
    return AddElementGroup(set_);
  }

  absl::Status BeginSet(Reading kind, const std::string& name) {
    if (name.empty()) return Fault("a set without a name");
    reading_ = kind;
    set_ = SetIndex(kind == Reading::kNodeSet ? node_sets_ : element_sets_, name);
    return kind == Reading::kNodeSet ? AddNodeGroup(set_) : AddElementGroup(set_);
  }

  absl::Status BeginSurface(const std::string& type, const std::string& name) {
    if (name.empty()) return Fault("*SURFACE without a NAME");
    if (!type.empty() && Upper(type) != "ELEMENT" && Upper(type) != "NODE") {
      return Fault("*SURFACE must be of TYPE=ELEMENT or TYPE=NODE");
    }
    const bool is_node = Upper(type) == "NODE";
    reading_ = is_node ? Reading::kNodeSurface : Reading::kElementSurface;
    set_ = SetIndex(is_node ? node_sets_ : face_sets_, name);
    return is_node ? AddNodeGroup(set_) : AddFaceGroup(set_);
  }

  absl::Status ReadData(std::string_view line) {
    const bool is_used = reading_ != Reading::kNothing && reading_ != Reading::kText;
    if (is_used && line.size() > kLongestLine) {
      return Fault(absl::StrCat("a line of data is longer than ", kLongestLine, " bytes"));
    }
    switch (reading_) {
      case Reading::kNothing:
      case Reading::kText:
        return absl::OkStatus();
      case Reading::kInstance:
        return Fault(absl::StrCat("a moved *INSTANCE, ", Quoted(instance_), ", is not read"));
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
    // The assembly has its own numbers. Its nodes are points of reference: its elements, which
    // might use them, are refused.
    if (InAssembly()) {
      assembly_nodes_.push_back(*number);
      return absl::OkStatus();
    }
    MORTISE_RETURN_IF_ERROR(builder_.AddNode(*number, position, place_));
    if (set_ < 0) return absl::OkStatus();
    sets_[set_].members.push_back(*number);
    return builder_.AddNodeMember(sets_[set_].group, *number, place_);
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
      if (set_ < 0) return absl::OkStatus();
      return builder_.AddTriangle(sets_[set_].face_group, triangles_[numbers[0]], element_place_);
    }
    MORTISE_RETURN_IF_ERROR(
        builder_.AddElement(numbers[0], std::span(numbers).subspan(1), element_place_));
    if (set_ < 0) return absl::OkStatus();
    sets_[set_].members.push_back(numbers[0]);
    return builder_.AddElementMember(sets_[set_].group, numbers[0], element_place_);
  }

  absl::Status ReadMembers(std::string_view line) {
    const std::vector<std::string_view> fields = Fields(line);
    MORTISE_RETURN_IF_ERROR(Spend(fields.size()));
    if (is_range_ || reading_ == Reading::kElementSurface) {
      entries_.push_back({line, set_, reading_, is_range_, of_});
      return absl::OkStatus();
    }
    for (const std::string_view member : fields) {
      if (member.empty()) return Fault("a member of a set is missing");
      // A node surface may give a weight beside each member; it has no meaning here.
      entries_.push_back({member, set_, reading_, false, of_});
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
    place_ = static_cast<std::size_t>(entry.text.data() - text_.data());
    if (entry.kind == Reading::kElementSurface) return ResolveSurface(entry);
    const bool of_nodes = entry.kind != Reading::kElementSet;
    if (entry.is_range) return ResolveRange(entry, of_nodes);
    const auto [name, of] = WithoutInstance(entry.text, entry.of);
    if (const auto number = Integer(name)) return AddMember(entry.set, *number, of, of_nodes);
    const int named = FindSet(of_nodes ? node_sets_ : element_sets_, name, of, entry.set);
    if (named < 0) return Fault("a member is neither a number nor the name of an earlier set");
    MORTISE_RETURN_IF_ERROR(Spend(sets_[named].members.size()));
    for (const std::int64_t member : std::vector(sets_[named].members)) {
      MORTISE_RETURN_IF_ERROR(AddMember(entry.set, member, Owner::kPart, of_nodes));
    }
    return absl::OkStatus();
  }

  // "Part-1-1.Set-1" and "Part-1-1.5" are the part's, wherever they are written.
  std::pair<std::string_view, Owner> WithoutInstance(std::string_view name, Owner of) const {
    const std::size_t length = instance_.size();
    const bool is_named = length > 0 && name.size() > length && name[length] == '.' &&
                          Upper(name.substr(0, length)) == Upper(instance_);
    return is_named ? std::pair(name.substr(length + 1), Owner::kPart) : std::pair(name, of);
  }

  // An earlier set of its owner, or of the other if it has none of the name; -1 if there is none
  // but `except`.
  int FindSet(const Sets& sets, std::string_view name, Owner of, int except) const {
    const Owner other = of == Owner::kPart ? Owner::kWhole : Owner::kPart;
    const std::string upper = Upper(name);
    for (const Owner owner : {of, other}) {
      const auto found = sets.find({owner, upper});
      if (found == sets.end() || found->second == except) continue;
      if (sets_[found->second].place < place_) return found->second;
    }
    return -1;
  }

  // Sets that name each other may multiply; what they hold in all is limited.
  absl::Status Spend(std::size_t members) {
    members_ += members;
    if (members_ <= kMostMembers) return absl::OkStatus();
    return Fault(absl::StrCat("the sets have more than ", kMostMembers, " members"));
  }

  absl::Status AddMember(int set, std::int64_t number, Owner of, bool of_nodes) {
    if (of_nodes) {
      if (of == Owner::kWhole &&
          std::binary_search(assembly_nodes_.begin(), assembly_nodes_.end(), number)) {
        return absl::OkStatus();  // left out
      }
      sets_[set].members.push_back(number);
      return builder_.AddNodeMember(sets_[set].group, number, place_);
    }
    sets_[set].members.push_back(number);
    // Elements that only mark faces may be in sets with others.
    const auto triangle = triangles_.find(number);
    if (triangle != triangles_.end() && !builder_.HasElement(number)) {
      MORTISE_RETURN_IF_ERROR(AddFaceGroup(set));
      return builder_.AddTriangle(sets_[set].face_group, triangle->second, place_);
    }
    return builder_.AddElementMember(sets_[set].group, number, place_);
  }

  absl::Status ResolveRange(const Entry& entry, bool of_nodes) {
    const std::vector<std::string_view> fields = Fields(entry.text);
    const auto field = [&](std::size_t k) { return k < fields.size() ? fields[k] : ""; };
    const auto first = Integer(field(0)), last = Integer(field(1));
    const auto step = field(2).empty() ? std::optional<std::int64_t>(1) : Integer(field(2));
    if (!first || !last || !step || *step < 1 || *last < *first || *first < 0) {
      return Fault("a range must be first, last and step, of whole numbers");
    }
    const std::int64_t steps = (*last - *first) / *step;
    // Members must exist, and those that do are no more than the file has bytes.
    if (steps >= static_cast<std::int64_t>(text_.size())) {
      return Fault(absl::StrCat("a range takes ", steps, " steps, more than there can be members"));
    }
    MORTISE_RETURN_IF_ERROR(Spend(static_cast<std::size_t>(steps) + 1));
    for (std::int64_t i = 0; i <= steps; ++i) {
      MORTISE_RETURN_IF_ERROR(AddMember(entry.set, *first + i * *step, entry.of, of_nodes));
    }
    return absl::OkStatus();
  }

  absl::Status ResolveSurface(const Entry& entry) {
    const std::vector<std::string_view> fields = Fields(entry.text);
    const std::string label = Upper(fields.size() > 1 ? fields[1] : "");
    if (label.size() != 2 || label[0] != 'S' || label[1] < '1' || label[1] > '4') {
      return Fault("a line of a surface must be an element or a set of them, and S1 to S4");
    }
    const int side = kSides[label[1] - '1'];
    const int group = sets_[entry.set].face_group;
    const auto [name, of] = WithoutInstance(fields[0], entry.of);
    if (const auto number = Integer(name)) {
      return builder_.AddSideMember(group, *number, side, place_);
    }
    const int named = FindSet(element_sets_, name, of, -1);
    if (named < 0) return Fault("a surface names no earlier set of elements");
    MORTISE_RETURN_IF_ERROR(Spend(sets_[named].members.size()));
    for (const std::int64_t member : sets_[named].members) {
      MORTISE_RETURN_IF_ERROR(builder_.AddSideMember(group, member, side, place_));
    }
    return absl::OkStatus();
  }

  const std::string_view text_;
  const FilePlaces places_;
  GroupedMeshBuilder builder_;
  std::size_t at_ = 0;
  std::size_t place_ = 0;  // where the present line begins
  Reading reading_ = Reading::kNothing;
  int set_ = -1;              // index into sets_
  Owner of_ = Owner::kWhole;  // whose the members of the present set are
  bool is_range_ = false, has_part_ = false, has_instance_ = false;
  bool in_part_ = false;  // or in its instance
  std::string instance_;  // its name
  int nodes_of_element_ = 0;
  std::vector<std::int64_t> numbers_;  // of an element that goes on
  std::size_t element_place_ = 0;
  std::size_t members_ = 0;  // of all sets, as far as they are known
  std::vector<Set> sets_;    // and surfaces
  Sets node_sets_, element_sets_, face_sets_;
  std::vector<std::int64_t> assembly_nodes_;                       // in the end, ascending
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
