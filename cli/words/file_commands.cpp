#include "cli/words/file_commands.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/files.h"
#include "common/base/violation_lists.h"

namespace mortise::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLooked = 4096;  // bytes in which a text says what it is
constexpr const char* kMark = "# proto-message: mortise.v1.";

struct KnownKind {
  std::vector<const char*> extensions;
  FileUse use;
};

const std::vector<KnownKind>& KnownKinds() {
  static const std::vector<KnownKind> kKinds = {
      {{".step", ".stp", ".stpz"}, {"a drawing (STEP)", {"assembly import", "catalog shape"}}},
      {{".stl"}, {"a mesh (STL)", {"assembly import", "catalog shape", "search", "catalog place"}}},
      {{".obj"}, {"a mesh", {"assembly import", "search", "catalog place"}}},
      {{".off", ".ply", ".glb", ".gltf"}, {"a mesh", {"assembly import", "search"}}},
      {{".csv"}, {"a table", {"catalog import", "search", "catalog place", "map evaluate"}}},
      {{".asc"}, {"ground as a grid", {"catalog place"}}}};
  return kKinds;
}

// How the commands that are offered name the file, where that is not as their only argument.
std::string Offered(const std::string& command, const std::string& file) {
  if (command == "catalog place") {
    return absl::StrCat("catalog place TEMPLATE --height-field NAME=", file);
  }
  if (command == "map evaluate") return absl::StrCat("map evaluate MAP --points ", file);
  if (command == "analyze") return absl::StrCat("analyze CASE.json --mesh ", file);
  return absl::StrCat(command, " ", file);
}

FileUse UseOfText(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text(kLooked, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  const std::size_t mark = text.find(kMark);
  std::string type;
  if (mark != std::string::npos) {
    const std::size_t begin = mark + std::string(kMark).size();
    type = text.substr(begin, text.find_first_of(" \t\r\n", begin) - begin);
  }
  if (type == "Assembly") return {"an assembly", {"assembly import"}};
  const bool is_template = type == "Template" || type == "CadTemplate" || type == "CageTemplate";
  if (is_template) return {"a template", {"catalog import"}};
  if (type == "TemplateBundle") return {"a file of items and materials", {"catalog import"}};
  return {};
}

// Whether a word of the command line may be a file that the command was to read.
bool IsFile(const std::string& word) {
  std::error_code ignored;
  return !word.starts_with('-') && fs::is_regular_file(word, ignored);
}

}  // namespace

FileUse UseOf(const fs::path& file) {
  const std::string extension = LowerCaseExtension(file);
  if (extension == ".textproto") return UseOfText(file);
  if (extension == ".msh" || extension == ".inp") {
    return {"a mesh of finite elements", {"analyze"}};
  }
  for (const KnownKind& kind : KnownKinds()) {
    const auto is_it = [&extension](const char* each) { return extension == each; };
    if (std::any_of(kind.extensions.begin(), kind.extensions.end(), is_it)) return kind.use;
  }
  return {};
}

absl::Status WithRightCommand(const absl::Status& failure, const std::string& command,
                              const std::vector<std::string>& arguments) {
  const bool is_of_words =
      absl::IsInvalidArgument(failure) || DetailOf(failure).reason == "RESOURCE_NOT_FOUND";
  if (!is_of_words) return failure;
  std::vector<FieldViolation> wrong;
  for (const std::string& word : arguments) {
    if (!IsFile(word)) continue;
    const FileUse use = UseOf(word);
    const auto& commands = use.commands;
    if (commands.empty() ||
        std::find(commands.begin(), commands.end(), command) != commands.end()) {
      continue;
    }
    const auto offer = [&word](std::string* out, const std::string& each) {
      absl::StrAppend(out, "mortise ", Offered(each, word));
    };
    wrong.push_back({word, absl::StrCat("is ", use.kind, "; what takes it is: ",
                                        absl::StrJoin(commands, ", or ", offer))});
  }
  if (wrong.empty()) return failure;
  std::vector<FieldViolation> others = AllViolationsOf(failure);
  std::erase_if(others, [&wrong](const FieldViolation& other) {
    return std::any_of(wrong.begin(), wrong.end(), [&other](const FieldViolation& file) {
      return other.field.starts_with(file.field) ||
             other.message.find(file.field) != other.message.npos;
    });
  });
  // What was looked for under the file's name is a fault of the same word.
  if (others.size() == 1 && wrong.size() == 1) others.clear();
  wrong.insert(wrong.end(), std::make_move_iterator(others.begin()),
               std::make_move_iterator(others.end()));
  return InvalidFields(wrong);
}

}  // namespace mortise::cli
