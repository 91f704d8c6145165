#include "common/mesh/abaqus_reader.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/abaqus_sets.h"
#include "common/mesh/abaqus_text.h"
#include "common/mesh/grouped_mesh_builder.h"

namespace mortise::mesh {
namespace {

using abaqus::Fields;
using abaqus::Integer;
using abaqus::Keyword;
using abaqus::Trim;
using abaqus::Upper;

// Of a line that is split into fields, in bytes; a keyword's with all lines it goes on over.
constexpr std::size_t kLongestLine = 65'536;

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
        MORTISE_ASSIGN_OR_RETURN(const std::string keyword_line, KeywordLine(line.substr(1)));
        const std::optional<Keyword> keyword = abaqus::ParseKeyword(keyword_line);
        if (!keyword) return Fault("a keyword is missing after '*'");
        MORTISE_RETURN_IF_ERROR(Begin(*keyword));
      } else {
        MORTISE_RETURN_IF_ERROR(ReadData(line));
      }
    }
    MORTISE_RETURN_IF_ERROR(Finish());
    if (!ignored_.empty()) {
      std::string note = "not used:";
      for (const std::string& keyword : ignored_) {
        absl::StrAppend(&note, note.ends_with(':') ? " *" : ", *", keyword);
      }
      builder_.AddNote(std::move(note));
    }
    MORTISE_RETURN_IF_ERROR(sets_.Resolve());
    return builder_.Build();
  }

 private:
  enum class Reading : std::uint8_t {
    kNothing,  // data lines of what is not used
    kText,     // a heading
    kNodes,
    kElements,
    kFaceElements,  // triangles that mark faces
    kMembers,       // of a set or surface
    kInstance,
  };

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

  absl::Status Open(Kind kind, const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(list_.set, sets_.Open(kind, name, Present(), place_));
    return absl::OkStatus();
  }

  absl::Status Begin(const Keyword& keyword) {
    const std::string& name = keyword.name;
    reading_ = Reading::kNothing;
    list_ = {.of = Present(), .is_range = keyword.Has("GENERATE")};
    if (name == "INCLUDE") {
      return Fault("*INCLUDE: one file is uploaded; put the included one in its place");
    }
    if (abaqus::ChangesMesh(name)) return Fault(absl::StrCat("*", name, " is not read"));
    if (name == "NODE") return BeginNodes(keyword.Has("SYSTEM"), keyword.Value("NSET"));
    if (name == "ELEMENT") return BeginElements(keyword.Value("TYPE"), keyword.Value("ELSET"));
    if (name == "NSET" || name == "ELSET") return BeginSet(keyword);
    if (name == "SURFACE") return BeginSurface(keyword.Value("TYPE"), keyword.Value("NAME"));
    if (name == "PART") return BeginPart(keyword.Value("NAME"));
    if (name == "INSTANCE") return BeginInstance(keyword.Value("NAME"));
    if (in_part_ && (name == "ASSEMBLY" || name == "END ASSEMBLY")) return Unended(name);
    if (name == "END PART" || name == "END INSTANCE") in_part_ = false;
    if (name == "HEADING") reading_ = Reading::kText;
    if (!abaqus::IsFrame(name) && ignored_.size() < 50) ignored_.insert(name);
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
    sets_.SetInstance(name);
    in_part_ = has_instance_ = true;
    reading_ = Reading::kInstance;
    return absl::OkStatus();
  }

  absl::Status BeginNodes(bool has_system, const std::string& set) {
    if (has_system) return Fault("*NODE with SYSTEM is not read; give x, y and z");
    reading_ = Reading::kNodes;
    return set.empty() ? absl::OkStatus() : Open(Kind::kNodes, set);
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
      return set.empty() ? absl::OkStatus() : Open(Kind::kFaces, set);
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
    return Open(keyword.name == "NSET" ? Kind::kNodes : Kind::kElements, name);
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
    const bool is_used = reading_ != Reading::kNothing && reading_ != Reading::kText;
    if (is_used && line.size() > kLongestLine) {
      return Fault(absl::StrCat("a line of data is longer than ", kLongestLine, " bytes"));
    }
    switch (reading_) {
      case Reading::kNothing:
      case Reading::kText:
        return absl::OkStatus();
      case Reading::kInstance:
        return Fault(
            absl::StrCat("a moved *INSTANCE, ", Quoted(sets_.instance()), ", is not read"));
      case Reading::kNodes:
        return ReadNode(line);
      case Reading::kElements:
      case Reading::kFaceElements:
        return ReadElement(line);
      case Reading::kMembers:
        return sets_.AddLine(list_, line);
    }
    return absl::OkStatus();
  }

  absl::Status ReadNode(std::string_view line) {
    const std::vector<std::string_view> fields = Fields(line);
    const auto number = Integer(fields.empty() ? "" : fields[0]);
    if (!number || fields.size() > 4)
      return Fault("a node must be a number and up to three places");
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (std::size_t k = 1; k < fields.size(); ++k) {
      const auto x = fields[k].empty() ? std::optional<double>(0) : abaqus::Number(fields[k]);
      if (!x) return Fault(absl::StrCat("a coordinate of node ", *number, " is not a number"));
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
    if (reading_ == Reading::kFaceElements) {
      return sets_.AddTriangle(list_.set, numbers[0], {numbers[1], numbers[2], numbers[3]},
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
  std::size_t place_ = 0;  // where the present line begins
  Reading reading_ = Reading::kNothing;
  AbaqusSets::List list_;  // its set is also that of nodes and elements
  bool has_part_ = false, has_instance_ = false;
  bool in_part_ = false;  // or in its instance
  int nodes_of_element_ = 0;
  std::vector<std::int64_t> numbers_;  // of an element that goes on
  std::size_t element_place_ = 0;
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
