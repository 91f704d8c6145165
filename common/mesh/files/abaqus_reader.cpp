#include "common/mesh/files/abaqus_reader.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/files/abaqus_sets.h"
#include "common/mesh/files/abaqus_text.h"
#include "common/mesh/files/grouped_mesh_builder.h"
#include "common/mesh/files/number_gaps.h"

namespace mortise::mesh {
namespace {

using abaqus::Fields;
using abaqus::Integer;
using abaqus::Keyword;
using abaqus::Trim;
using abaqus::Upper;

// No line that is split into fields may be longer, in bytes, and no keyword with all the lines it
// goes on over.
constexpr std::size_t kMaxLineLength = 65'536;

constexpr std::size_t kListedKeywords = 50;  // in a note
constexpr std::size_t kMaxIgnored = 1000;    // of different names

using Owner = GroupedMeshBuilder::Owner;
using Kind = AbaqusSets::Kind;

// Whether a name of a part may be in messages and in names of groups.
bool IsFit(std::string_view name) {
  return !name.empty() && name.size() <= 80 && IsPlainText(name);
}

std::string Quoted(std::string_view name) {
  return IsFit(name) ? absl::StrCat("'", absl::string_view(name.data(), name.size()), "'") : "'?'";
}

class Reader {
 public:
  explicit Reader(std::string_view text)
      : text_(text),
        places_(text, true),
        builder_(places_, GroupedMeshBuilder::Repeats::kRefused),
        sets_(text, places_, builder_) {}

  absl::StatusOr<GroupedMesh> Read() {
    while (at_ < text_.size()) {
      place_ = at_;
      std::string_view line = Trim(NextLine());
      if (line.empty() || line.starts_with("**")) continue;
      if (line.starts_with('*')) {
        MORTISE_RETURN_IF_ERROR(Finish());
        keyword_line_ = line;
        MORTISE_ASSIGN_OR_RETURN(const Keyword keyword, WholeKeyword(line.substr(1)));
        MORTISE_RETURN_IF_ERROR(Begin(keyword));
      } else {
        MORTISE_RETURN_IF_ERROR(ReadData(line));
      }
    }
    MORTISE_RETURN_IF_ERROR(Finish());
    NoteIgnored();
    NoteDoubts();
    MORTISE_RETURN_IF_ERROR(sets_.Resolve());
    return builder_.Build();
  }

 private:
  // A keyword that is not used.
  struct Ignored {
    std::size_t first = 0;  // its place
    int count = 0;
  };

  enum class Reading : std::uint8_t {
    kNothing,  // data lines of what is not used, or a heading
    kNoData,   // what has none
    kNodes,
    kElements,
    kMarks,    // triangles that mark faces, or lines that mark nodes
    kMembers,  // of a set or surface
    kInstance,
  };

  void Ignore(const std::string& keyword) {
    const auto known = ignored_.find(keyword);
    if (known != ignored_.end()) {
      ++known->second.count;
    } else if (ignored_.size() < kMaxIgnored) {
      ignored_.emplace(keyword, Ignored{place_, 1});
    }
  }

  void NoteIgnored() {
    if (ignored_.empty()) return;
    std::string note = "not used:";
    std::size_t listed = 0;
    for (const auto& [keyword, found] : ignored_) {
      if (listed++ == kListedKeywords) break;
      absl::StrAppend(&note, note.ends_with(':') ? " *" : ", *", keyword, " (",
                      places_.Where(found.first));
      if (found.count > 1) absl::StrAppend(&note, ", ", found.count, " times");
      absl::StrAppend(&note, ")");
    }
    if (ignored_.size() > kListedKeywords) {
      absl::StrAppend(&note, " and ", ignored_.size() - kListedKeywords, " more");
    }
    builder_.AddNote(std::move(note));
  }

  // What may be a fault of the file: the format counts nothing, so that a file that lost a line or
  // its end is one still.
  void NoteDoubts() {
    for (const auto& [type, first] : line_types_) {
      builder_.AddNote(absl::StrCat(places_.Where(first), ": elements of type ", type,
                                    " only mark their nodes; they carry nothing"));
    }
    if (!text_.ends_with('\n') && reading_ != Reading::kNothing && reading_ != Reading::kNoData) {
      builder_.AddNote("the last line does not end: the file may have been cut off in it");
    }
    for (const auto& [kind, numbers] : numbers_of_) {
      if (std::string gaps = NumberGaps(numbers); !gaps.empty()) {
        builder_.AddNote(
            absl::StrCat("the numbers of ", kind, " ", gaps, ": the file may have lost some"));
      }
    }
  }

  void CountElement(std::int64_t number) {
    const char* const kind = reading_ == Reading::kElements ? "tetrahedra"
                             : marks_are_lines_             ? "lines"
                                                            : "triangles";
    numbers_of_[kind].push_back(number);
  }

  absl::Status Fault(std::string_view message) const { return places_.Fault(place_, message); }

  std::string_view NextLine() {
    const std::size_t end = text_.find('\n', at_);
    const std::string_view line =
        text_.substr(at_, end == std::string_view::npos ? end : end - at_);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
    return line;
  }

  // The keyword of a line, with the lines that its parameters go on over.
  absl::StatusOr<Keyword> WholeKeyword(std::string_view line) {
    std::string whole(line);
    std::optional<Keyword> keyword = abaqus::ParseKeyword(whole);
    while (true) {
      if (whole.size() > kMaxLineLength) {
        return Fault(absl::StrCat("a keyword takes more than ", kMaxLineLength, " bytes"));
      }
      if (!whole.ends_with(',')) break;
      const std::size_t before = at_;
      std::string_view next;
      while (at_ < text_.size() && (next.empty() || next.starts_with("**"))) {
        next = Trim(NextLine());
      }
      if (next.empty() || next.starts_with('*') || !keyword ||
          abaqus::WhatFollows(*keyword, next) == abaqus::Following::kData) {
        at_ = before;
        break;
      }
      whole += next;
    }
    if (whole.size() > line.size()) keyword = abaqus::ParseKeyword(whole);
    if (!keyword) return Fault("a keyword is missing after '*'");
    return *std::move(keyword);
  }

  // What is beside a part, and not in its instance, is the assembly's.
  bool InAssembly() const { return (has_part_ || has_instance_) && !in_part_; }
  Owner Present() const { return in_part_ ? Owner::kPart : Owner::kWhole; }

  absl::Status Open(Kind kind, const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(list_.set, sets_.Open(kind, name, Present(), place_));
    return absl::OkStatus();
  }

  absl::Status Begin(const Keyword& keyword) {
    const std::string& name = keyword.name;
    reading_ = abaqus::HasNoData(name) ? Reading::kNoData : Reading::kNothing;
    list_ = {.of = Present(), .is_range = keyword.Has("GENERATE")};
    if (name == "INCLUDE") {
      return Fault("*INCLUDE: one file is uploaded; put the included one in its place");
    }
    if (abaqus::ChangesMesh(name)) return Fault(absl::StrCat("*", name, " is not read"));
    if (const std::string unread = abaqus::UnreadParameter(keyword); !unread.empty()) {
      return Fault(unread);
    }
    if (name == "NODE") return BeginNodes(keyword.Value("NSET"));
    if (name == "ELEMENT") return BeginElements(keyword.Value("TYPE"), keyword.Value("ELSET"));
    if (name == "NSET" || name == "ELSET") return BeginSet(keyword);
    if (name == "SURFACE") return BeginSurface(keyword.Value("TYPE"), keyword.Value("NAME"));
    if (name == "PART") return BeginPart(keyword.Value("NAME"));
    if (name == "INSTANCE") return BeginInstance(keyword.Value("NAME"), keyword.Value("PART"));
    if (in_part_ && (name == "ASSEMBLY" || name == "END ASSEMBLY")) return Unended(name);
    if (name == "END PART" || name == "END INSTANCE") in_part_ = false;
    if (!abaqus::IsFrame(name)) Ignore(name);
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
    part_ = name;
    in_part_ = true;
    return absl::OkStatus();
  }

  // May hold the nodes and elements in place of the part, and has them then as its own.
  absl::Status BeginInstance(const std::string& name, const std::string& part) {
    if (has_instance_) {
      return Fault(
          absl::StrCat("there is a second *INSTANCE, ", Quoted(name), "; only one can be read"));
    }
    if (in_part_) return Unended("INSTANCE");
    if (has_part_ && !part.empty() && Upper(part) != Upper(part_)) {
      return Fault(absl::StrCat("there is no *PART ", Quoted(part)));
    }
    if (!has_part_ && IsFit(name)) builder_.SetPartName(name);
    sets_.SetInstance(name);
    in_part_ = has_instance_ = true;
    reading_ = Reading::kInstance;
    return absl::OkStatus();
  }

  absl::Status BeginNodes(const std::string& set) {
    reading_ = Reading::kNodes;
    return set.empty() ? absl::OkStatus() : Open(Kind::kNodes, set);
  }

  absl::Status BeginElements(const std::string& given, const std::string& set) {
    if (InAssembly()) {
      return Fault("elements of the assembly itself are not read; they must be in the *PART");
    }
    const std::string type = Upper(given);
    static const std::map<std::string, std::pair<Kind, int>> kMarks{
        {"CPS3", {Kind::kFaces, 3}},   {"CPS6", {Kind::kFaces, 6}}, {"SFM3D3", {Kind::kFaces, 3}},
        {"SFM3D6", {Kind::kFaces, 6}}, {"T3D2", {Kind::kLines, 2}}, {"T3D3", {Kind::kLines, 3}}};
    if (const auto mark = kMarks.find(type); mark != kMarks.end()) {
      reading_ = Reading::kMarks;
      const auto [kind, nodes] = mark->second;
      marks_are_lines_ = kind == Kind::kLines;
      nodes_of_element_ = nodes;
      if (marks_are_lines_) line_types_.try_emplace(type, place_);
      return set.empty() ? absl::OkStatus() : Open(kind, set);
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
    return set.empty() ? absl::OkStatus() : Open(Kind::kElements, set);
  }

  // Members of a set of the assembly that names the instance are the part's.
  absl::Status BeginSet(const Keyword& keyword) {
    if (keyword.Has("INSTANCE")) {
      const std::string instance = keyword.Value("INSTANCE");
      if (!has_instance_ || Upper(instance) != Upper(sets_.instance())) {
        return Fault(absl::StrCat("there is no *INSTANCE ", Quoted(instance)));
      }
      list_.of = Owner::kPart;
    }
    const std::string name = keyword.Value(keyword.name);
    if (name.empty()) return Fault("a set without a name");
    reading_ = Reading::kMembers;
    const bool is_of_nodes = keyword.name == "NSET";
    MORTISE_RETURN_IF_ERROR(Open(is_of_nodes ? Kind::kNodes : Kind::kElements, name));
    if (!is_of_nodes || !keyword.Has("ELSET")) return absl::OkStatus();
    reading_ = Reading::kNoData;
    sets_.AddNodesOf(list_, keyword.Value("ELSET"), keyword_line_);
    return absl::OkStatus();
  }

  absl::Status BeginSurface(const std::string& type, const std::string& name) {
    if (name.empty()) return Fault("*SURFACE without a NAME");
    if (!type.empty() && Upper(type) != "ELEMENT" && Upper(type) != "NODE") {
      return Fault("*SURFACE must be of TYPE=ELEMENT or TYPE=NODE");
    }
    reading_ = Reading::kMembers;
    list_.has_weights = Upper(type) == "NODE";
    return Open(list_.has_weights ? Kind::kNodes : Kind::kFaces, name);
  }

  absl::Status ReadData(std::string_view line) {
    if (reading_ != Reading::kNothing && line.size() > kMaxLineLength) {
      return Fault(absl::StrCat("a line of data is longer than ", kMaxLineLength, " bytes"));
    }
    switch (reading_) {
      case Reading::kNothing:
        return absl::OkStatus();
      case Reading::kNoData:
        return Fault("a line of data follows a keyword that has none");
      case Reading::kInstance:
        return ReadMove(line);
      case Reading::kNodes:
        return ReadNode(line);
      case Reading::kElements:
      case Reading::kMarks:
        return ReadElement(line);
      case Reading::kMembers:
        return sets_.AddLine(list_, line);
    }
    return absl::OkStatus();
  }

  // A line of a move, of up to 3 numbers, or of a turn, of two points and an angle.
  absl::Status ReadMove(std::string_view line) {
    const std::vector<std::string_view> fields = Fields(line);
    const bool is_turn = fields.size() == 7;
    bool is_still = fields.size() <= 3 || is_turn;
    for (std::size_t k = is_turn ? 6 : 0; is_still && k < fields.size(); ++k) {
      is_still = fields[k].empty() || abaqus::Number(fields[k]) == 0.0;
    }
    if (is_still) return absl::OkStatus();
    return Fault(absl::StrCat("a moved *INSTANCE, ", Quoted(sets_.instance()), ", is not read"));
  }

  absl::Status ReadNode(std::string_view line) {
    const std::vector<std::string_view> fields = Fields(line);
    const auto number = Integer(fields.empty() ? "" : fields[0]);
    if (!number || fields.size() > 4) {
      return Fault("a node must be a number and up to three places");
    }
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (std::size_t k = 1; k < fields.size(); ++k) {
      const auto x = fields[k].empty() ? std::optional<double>(0) : abaqus::Number(fields[k]);
      if (!x) {
        return Fault(
            absl::StrCat("a coordinate of node ", *number, " is not finite, or no number"));
      }
      position[static_cast<Eigen::Index>(k) - 1] = *x;
    }
    // The assembly has its own numbers. Its nodes are points of reference: its elements, which
    // might use them, are refused.
    if (InAssembly()) {
      sets_.AddAssemblyNode(*number);
      return absl::OkStatus();
    }
    MORTISE_RETURN_IF_ERROR(builder_.AddNode(*number, position, place_));
    if (list_.set == AbaqusSets::kNoSet) return absl::OkStatus();
    return sets_.AddMember(list_.set, *number, place_);
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
    CountElement(numbers[0]);
    if (reading_ == Reading::kMarks) {
      return sets_.AddMark(list_.set, numbers[0], std::span(numbers).subspan(1), marks_are_lines_,
                           element_place_);
    }
    MORTISE_RETURN_IF_ERROR(
        builder_.AddElement(numbers[0], std::span(numbers).subspan(1), element_place_));
    if (list_.set == AbaqusSets::kNoSet) return absl::OkStatus();
    return sets_.AddMember(list_.set, numbers[0], element_place_);
  }

  // An element that is not finished.
  absl::Status Finish() {
    if (numbers_.empty()) return absl::OkStatus();
    return places_.Fault(element_place_, absl::StrCat("element ", numbers_[0], " has fewer than ",
                                                      nodes_of_element_, " nodes"));
  }

  const std::string_view text_;
  const FilePlaces places_;
  GroupedMeshBuilder builder_;
  AbaqusSets sets_;
  std::size_t at_ = 0;
  std::size_t place_ = 0;          // where the present line begins
  std::string_view keyword_line_;  // the first of the present keyword
  Reading reading_ = Reading::kNothing;
  AbaqusSets::List list_;  // its set is also that of nodes and elements
  bool has_part_ = false, has_instance_ = false;
  bool in_part_ = false;  // or in its instance
  std::string part_;      // its name
  int nodes_of_element_ = 0;
  bool marks_are_lines_ = false;
  std::vector<std::int64_t> numbers_;  // of an element that goes on
  std::size_t element_place_ = 0;
  std::map<std::string, Ignored> ignored_;                       // by keyword
  std::map<std::string, std::size_t> line_types_;                // where each is first
  std::map<std::string, std::vector<std::int64_t>> numbers_of_;  // by kind of element
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
