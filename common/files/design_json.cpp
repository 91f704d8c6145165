// Designs as JSON. The text is first checked as a whole, then each material, item and template in
// it is read by itself, so that all that is wrong is found, each with the line it begins at.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/text_encoding.h"
#include "common/files/design_file.h"
#include "common/files/json_message.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxFindings = 100;
constexpr std::size_t kMaxNesting = 32;

// Looks through a text without keeping it: is it JSON, not too deep, and no list of it there twice?
// What is twice in a message is told beside its other faults.
class Checker : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return Enter(); }
  bool start_array(std::size_t) override { return Enter(); }
  bool end_object() override { return Leave(); }
  bool end_array() override { return Leave(); }

  bool key(string_t& name) override {
    if (depth_ > 1 || lists_.insert(name).second) return true;
    problem_ = absl::StrCat("the key '", name.substr(0, 80), "' is twice in one object");
    return false;
  }

  bool parse_error(std::size_t, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 2, column 5: …"
    const std::string text = error.what();
    const std::size_t place = text.find("line ");
    problem_ = place == std::string::npos ? text : text.substr(place);
    return false;
  }

  const std::string& problem() const { return problem_; }

 private:
  bool Enter() {
    if (++depth_ <= kMaxNesting) return true;
    problem_ = absl::StrCat("is nested deeper than ", kMaxNesting);
    return false;
  }

  bool Leave() {
    --depth_;
    return true;
  }

  std::size_t depth_ = 0;
  std::set<std::string> lists_;
  std::string problem_;
};

// Walks through a text that is known to be JSON.
class Walker {
 public:
  explicit Walker(std::string_view text) : text_(text) { SkipSpace(); }

  bool At(char c) const { return at_ < text_.size() && text_[at_] == c; }

  // Steps over a bracket, colon or comma.
  void Step() {
    ++at_;
    SkipSpace();
  }

  int Line() {
    const auto begin = text_.begin();
    line_ += static_cast<int>(std::count(begin + static_cast<std::ptrdiff_t>(counted_),
                                         begin + static_cast<std::ptrdiff_t>(at_), '\n'));
    counted_ = at_;
    return line_;
  }

  // The text of the value here; steps over it.
  std::string_view Value() {
    const std::size_t begin = at_;
    int depth = 0;
    do {
      const char c = text_[at_];
      if (c == '"') {
        SkipString();
        continue;
      }
      if (c == '{' || c == '[') ++depth;
      if (c == '}' || c == ']') --depth;
      ++at_;
      if (depth == 0 && (c == '}' || c == ']')) break;
    } while (at_ < text_.size() && (depth > 0 || !EndsValue(text_[at_])));
    const std::string_view value = text_.substr(begin, at_ - begin);
    SkipSpace();
    return value;
  }

 private:
  static bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
  static bool EndsValue(char c) {
    return IsSpace(c) || c == ',' || c == ':' || c == '}' || c == ']';
  }

  void SkipSpace() {
    while (at_ < text_.size() && IsSpace(text_[at_])) ++at_;
  }

  void SkipString() {
    for (++at_; text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    ++at_;
  }

  const std::string_view text_;
  std::size_t at_ = 0;
  std::size_t counted_ = 0;  // up to here, line breaks are counted
  int line_ = 1;
};

class Reader {
 public:
  explicit Reader(std::string_view text) : walker_(text) {}

  DesignFile Run() {
    if (walker_.At('[')) {
      TakeList("items", file_.items);
    } else if (walker_.At('{')) {
      TakeObject();
    } else {
      Report("line 1", "must be an object with materials, items and templates, or a list of items");
    }
    return std::move(file_);
  }

 private:
  void Report(std::string place, std::string message) {
    if (file_.findings.size() < kMaxFindings) {
      file_.findings.push_back({std::move(place), std::move(message)});
    } else {
      ++file_.unlisted;
    }
  }

  void TakeObject() {
    walker_.Step();
    while (!walker_.At('}')) {
      if (walker_.At(',')) walker_.Step();
      const std::string place = absl::StrCat("line ", walker_.Line());
      std::string_view key = walker_.Value();
      key = key.substr(1, key.size() - 2);
      walker_.Step();
      if (key == "template") {
        Take("template", file_.templates);
      } else if (key == "materials") {
        TakeList("materials", file_.materials);
      } else if (key == "items") {
        TakeList("items", file_.items);
      } else if (key == "templates") {
        TakeList("templates", file_.templates);
      } else {
        Report(place, absl::StrCat("'", std::string(key.substr(0, 80)),
                                   "' is none of materials, items, templates and template"));
        walker_.Value();
      }
    }
  }

  template <typename Message>
  void TakeList(const std::string& name, std::vector<Placed<Message>>& messages) {
    if (!walker_.At('[')) {
      Report(absl::StrCat("line ", walker_.Line()), absl::StrCat(name, " must be a list"));
      walker_.Value();
      return;
    }
    walker_.Step();
    for (int i = 0; !walker_.At(']'); ++i) {
      if (walker_.At(',')) walker_.Step();
      Take(absl::StrCat(name, "[", i, "]"), messages);
    }
    walker_.Step();
  }

  template <typename Message>
  void Take(const std::string& path, std::vector<Placed<Message>>& messages) {
    Placed<Message> placed;
    placed.place = absl::StrCat("line ", walker_.Line());
    const std::string_view value = walker_.Value();
    if (value[0] != '{') return Report(placed.place, absl::StrCat(path, " must be an object"));
    bool is_whole = true;
    for (const FieldViolation& finding : ReadJsonMessage(value, placed.message, placed.unread)) {
      const bool is_of_field = !finding.field.empty();
      Report(placed.place,
             absl::StrCat(path, is_of_field ? "." : "", finding.field, ": ", finding.message));
      is_whole = is_whole && is_of_field;
    }
    if (is_whole) {
      messages.push_back(std::move(placed));
    } else {
      file_.unread_names.insert(placed.message.name());
    }
  }

  Walker walker_;
  DesignFile file_;
};

}  // namespace

DesignFile ParseDesignJson(std::string_view text) {
  if (std::string fault = EncodingFault(text); !fault.empty()) {
    DesignFile file;
    file.findings.push_back({"", std::move(fault)});
    return file;
  }
  text = SkipByteOrderMark(text);
  Checker checker;
  if (!nlohmann::json::sax_parse(text.begin(), text.end(), &checker)) {
    DesignFile file;
    file.findings.push_back({"", checker.problem()});
    return file;
  }
  return Reader(text).Run();
}

}  // namespace mortise::parametric
