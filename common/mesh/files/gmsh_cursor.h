// Reads the numbers and sections of Gmsh's files, text or binary alike; for gmsh_reader.cpp.
#pragma once

#include <charconv>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/files/grouped_mesh_builder.h"

namespace mortise::mesh {

// A place in a file that moves on with each number read. Failures name it.
class GmshCursor {
 public:
  GmshCursor(std::string_view bytes, bool is_text, const FilePlaces& places)
      : bytes_(bytes), is_text_(is_text), places_(places) {}

  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  bool is_text() const { return is_text_; }

  absl::Status Fault(std::string_view message) const { return places_.Fault(at_, message); }

  void SkipSpace() {
    while (at_ < bytes_.size() && IsSpace(bytes_[at_])) ++at_;
  }

  // Reads what is left of the line, without its end.
  std::string_view Line() {
    const std::size_t end = bytes_.find('\n', at_);
    std::string_view line = bytes_.substr(at_, end == std::string_view::npos ? end : end - at_);
    at_ = end == std::string_view::npos ? bytes_.size() : end + 1;
    while (!line.empty() && IsSpace(line.back())) line.remove_suffix(1);
    return line;
  }

  // Reads the "$Name" at the start of a section; empty at the end of the file.
  absl::StatusOr<std::string_view> Section() {
    SkipSpace();
    if (at_ == bytes_.size()) return std::string_view();
    if (bytes_[at_] != '$') return Fault("a section, such as $Nodes, must begin here");
    return Line();
  }

  // Checks that nothing more stands in this line of a text file.
  absl::Status EndLine() {
    if (!is_text_) return absl::OkStatus();
    while (at_ < bytes_.size() && IsSpace(bytes_[at_]) && bytes_[at_] != '\n') ++at_;
    if (at_ == bytes_.size() || bytes_[at_] == '\n') return absl::OkStatus();
    return Fault("there is more in this line than belongs to it");
  }

  absl::Status SkipTo(std::string_view end) {
    const std::size_t found = bytes_.find(end, at_);
    if (found == std::string_view::npos) {
      return Fault(absl::StrCat("a section has no ", absl::string_view(end.data(), end.size())));
    }
    at_ = found + end.size();
    return absl::OkStatus();
  }

  absl::Status Expect(std::string_view text) {
    SkipSpace();
    if (bytes_.substr(at_, text.size()) != text) {
      return Fault(absl::StrCat(absl::string_view(text.data(), text.size()), " is missing here"));
    }
    at_ += text.size();
    return absl::OkStatus();
  }

  // Reads an integer, of 4 bytes in binary files.
  absl::StatusOr<std::int64_t> Int() {
    if (is_text_) return Parse<std::int64_t>();
    MORTISE_ASSIGN_OR_RETURN(const std::int32_t value, Take<std::int32_t>());
    return value;
  }

  // Reads an integer, of 8 bytes in binary files.
  absl::StatusOr<std::int64_t> Size() {
    if (is_text_) return Parse<std::int64_t>();
    return Take<std::int64_t>();
  }

  // Reads the number of things that follow, each at least `least` bytes long.
  absl::StatusOr<std::int64_t> Count(std::size_t least) {
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t count, Size());
    return CheckCount(count, least);
  }

  absl::StatusOr<std::int64_t> CheckCount(std::int64_t count, std::size_t least) const {
    if (count >= 0 && static_cast<std::uint64_t>(count) <= left() / least) return count;
    return Fault(absl::StrCat("the file is too short for ", count, " of what follows"));
  }

  absl::StatusOr<double> Double() { return is_text_ ? Parse<double>() : Take<double>(); }

  template <typename T>
  absl::StatusOr<T> Parse() {
    SkipSpace();
    T value{};
    const char* const begin = bytes_.data() + at_;
    const char* const end = bytes_.data() + bytes_.size();
    const auto [stop, error] = std::from_chars(begin + (begin < end && *begin == '+'), end, value);
    if (error != std::errc() || (stop < end && !IsSpace(*stop))) {
      if (at_ == bytes_.size()) return Fault("the file ends too early");
      return Fault("a number is missing here, or too large");
    }
    at_ = stop - bytes_.data();
    return value;
  }

  template <typename T>
  absl::StatusOr<T> Take() {
    if (left() < sizeof(T)) return Fault("the file ends too early");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

 private:
  static bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  const std::string_view bytes_;
  const bool is_text_;
  const FilePlaces& places_;
  std::size_t at_ = 0;
};

}  // namespace mortise::mesh
