#include "services/catalog/exchange/shape_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/decimal_number.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/text_encoding.h"
#include "common/mesh/repair/surface_repair.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kHeader = 80;    // bytes
constexpr std::size_t kTriangle = 50;  // bytes
constexpr double kMillimetre = 1e-3;   // m
constexpr auto kMaxTriangles = static_cast<std::size_t>(mesh::kMaxShapeTriangles);

// Collects triangles whose corners come one by one.
class Collector {
 public:
  absl::Status Add(const std::array<float, 3>& corner) {
    Eigen::Vector3d point;
    for (int axis = 0; axis < 3; ++axis) {
      const float value = corner[static_cast<std::size_t>(axis)];
      if (!std::isfinite(value)) return InvalidField("file", "has a coordinate that is not finite");
      point[axis] = kMillimetre * static_cast<double>(value);
    }
    // -0 and 0 are one place.
    const std::array<double, 3> key = {point.x() + 0.0, point.y() + 0.0, point.z() + 0.0};
    const auto [known, is_new] = index_.try_emplace(key, static_cast<int>(points_.size()));
    if (is_new) points_.push_back(point);
    corners_.push_back(known->second);
    if (corners_.size() > 3 * kMaxTriangles) {
      return TooLarge("file", absl::StrCat(kMaxTriangles, " triangles"));
    }
    return absl::OkStatus();
  }

  absl::StatusOr<mesh::SurfaceMesh> Surface() const {
    if (corners_.empty() || corners_.size() % 3 != 0) {
      return InvalidField("file", "has no triangles, or one that is cut off");
    }
    mesh::SurfaceMesh surface;
    surface.vertices.resize(3, static_cast<Eigen::Index>(points_.size()));
    for (std::size_t i = 0; i < points_.size(); ++i) {
      surface.vertices.col(static_cast<Eigen::Index>(i)) = points_[i];
    }
    surface.triangles = Eigen::Map<const Eigen::Matrix3Xi>(
        corners_.data(), 3, static_cast<Eigen::Index>(corners_.size() / 3));
    return surface;
  }

 private:
  std::map<std::array<double, 3>, int> index_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<int> corners_;
};

std::uint32_t CountOf(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeader, sizeof(count));
  return count;
}

bool IsBinary(std::string_view bytes) {
  return bytes.size() >= kHeader + 4 &&
         bytes.size() - kHeader - 4 == kTriangle * std::size_t{CountOf(bytes)};
}

absl::StatusOr<mesh::SurfaceMesh> ReadBinary(std::string_view bytes) {
  Collector collector;
  for (std::size_t at = kHeader + 4; at < bytes.size(); at += kTriangle) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      std::array<float, 3> point;
      std::memcpy(point.data(), bytes.data() + at + 12 + 12 * corner, sizeof(point));
      MORTISE_RETURN_IF_ERROR(collector.Add(point));
    }
  }
  return collector.Surface();
}

// The next word, taken off the text; empty at its end.
std::string_view NextWord(std::string_view& text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return text = {};
  const std::size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

// Text: "solid NAME", then for each triangle "facet normal X Y Z", "outer loop", three times
// "vertex X Y Z", "endloop", "endfacet", and at last "endsolid NAME". There may be several solids.
class TextReader {
 public:
  explicit TextReader(std::string_view text) : text_(text) {}

  absl::StatusOr<mesh::SurfaceMesh> Read() {
    std::string_view word = NextWord(text_);
    do {
      if (word != "solid") return Fault(word, "solid");
      SkipLine();  // its name
      word = NextWord(text_);
      for (; word == "facet"; word = NextWord(text_)) MORTISE_RETURN_IF_ERROR(ReadFacet());
      if (word != "endsolid") return Fault(word, "facet or endsolid");
      SkipLine();
      word = NextWord(text_);
    } while (!word.empty());
    return collector_.Surface();
  }

 private:
  static absl::Status Fault(std::string_view found, const char* wanted) {
    if (found.empty()) {
      return InvalidField("file", absl::StrCat("is cut off: it ends where ", wanted, " must come"));
    }
    return InvalidField("file", absl::StrCat("has another word where ", wanted, " must come"));
  }

  void SkipLine() { text_.remove_prefix(std::min(text_.find('\n'), text_.size())); }

  absl::Status Expect(const char* wanted) {
    const std::string_view word = NextWord(text_);
    return word == wanted ? absl::OkStatus() : Fault(word, wanted);
  }

  // The normal is not used: the order of the corners says the same.
  absl::Status ReadFacet() {
    MORTISE_RETURN_IF_ERROR(Expect("normal"));
    for (int k = 0; k < 3; ++k) NextWord(text_);
    MORTISE_RETURN_IF_ERROR(Expect("outer"));
    MORTISE_RETURN_IF_ERROR(Expect("loop"));
    for (int corner = 0; corner < 3; ++corner) {
      MORTISE_RETURN_IF_ERROR(Expect("vertex"));
      std::array<float, 3> point;
      for (float& coordinate : point) {
        const std::optional<double> number = DecimalNumber(NextWord(text_));
        if (!number) return InvalidField("file", "has a vertex without three numbers");
        coordinate = static_cast<float>(*number);
      }
      MORTISE_RETURN_IF_ERROR(collector_.Add(point));
    }
    MORTISE_RETURN_IF_ERROR(Expect("endloop"));
    return Expect("endfacet");
  }

  std::string_view text_;
  Collector collector_;
};

}  // namespace

absl::StatusOr<mesh::SurfaceMesh> ReadStl(std::string_view bytes) {
  if (IsBinary(bytes)) return ReadBinary(bytes);
  MORTISE_ASSIGN_OR_RETURN(const std::string_view text, WithoutByteOrderMark(bytes, "file"));
  if (text.starts_with("solid")) return TextReader(text).Read();
  return InvalidField("file", "is not STL: neither text nor as long as its triangles take");
}

absl::StatusOr<ImportedShape> ShapeOfStl(std::string_view bytes) {
  MORTISE_ASSIGN_OR_RETURN(const mesh::SurfaceMesh surface, ReadStl(bytes));
  MORTISE_ASSIGN_OR_RETURN(const mesh::RepairedSurface repaired, mesh::RepairSurface(surface));
  MORTISE_ASSIGN_OR_RETURN(mesh::DrawnShape shape, mesh::ShapeOfMesh(repaired.surface));
  return ImportedShape{std::move(shape), mesh::Describe(repaired.repairs)};
}

absl::StatusOr<mesh::DrawnShape> ShapeOfStep(const cad::StepAssembly& drawing) {
  if (drawing.parts.size() != 1) {
    return InvalidField("file", absl::StrCat("has ", drawing.parts.size(), " solids, not one"));
  }
  const cad::StepPart& part = drawing.parts.front();
  if (part.shape >= 0) return drawing.shapes[static_cast<std::size_t>(part.shape)];
  if (part.faults.empty()) return InvalidField("file", "is a box, as parts are without a shape");
  std::vector<FieldViolation> violations;
  for (const std::string& fault : part.faults) violations.push_back({"file", fault});
  return InvalidFields(violations);
}

}  // namespace mortise::catalog
