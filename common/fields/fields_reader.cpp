#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/fields/fields_file.h"
#include "common/fields/fields_layout.h"

namespace mortise::fields {
namespace {

template <typename Number>
Number NumberAt(std::string_view bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

// The bytes of a section from front to back. Once something was missing it gives zeros and stays
// failed, so that callers ask once, before they use what they read.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : bytes_(bytes) {}

  bool failed() const { return failed_; }
  bool AtEnd() const { return !failed_ && at_ == bytes_.size(); }

  template <typename Number>
  Number Next() {
    if (!Has(1, sizeof(Number))) return Number{};
    const Number number = NumberAt<Number>(bytes_, at_);
    at_ += sizeof(Number);
    return number;
  }

  std::string NextText() {
    const auto size = Next<std::uint64_t>();
    if (size > kMaximumNameLength || !Has(size, 1)) return Fail<std::string>();
    std::string text(bytes_.substr(at_, size));
    at_ += size;
    Align();
    return text;
  }

  // How many entries follow, each of at least `smallest` bytes; 0 if there is not room for them.
  std::uint64_t NextCount(std::size_t smallest) {
    const auto count = Next<std::uint64_t>();
    return count <= kMaximumCount && Has(count, smallest) ? count : Fail<std::uint64_t>();
  }

  // Numbers as they lie in the file; none if it has not so many.
  template <typename Number>
  std::vector<Number> NextArray(std::uint64_t count) {
    if (!Has(count, sizeof(Number))) return {};
    std::vector<Number> numbers(count);
    CopyInto(numbers.data(), count);
    return numbers;
  }

  // A matrix, column by column; empty if the file has not so many numbers.
  template <typename Matrix>
  Matrix NextMatrix(std::uint64_t rows, std::uint64_t columns) {
    if (columns > kMaximumCount || rows > kMaximumComponents ||
        !Has(rows * columns, sizeof(typename Matrix::Scalar))) {
      return Fail<Matrix>();
    }
    Matrix matrix(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    CopyInto(matrix.data(), rows * columns);
    return matrix;
  }

  std::vector<int> NextList() { return NextArray<int>(NextCount(sizeof(int))); }

  // Zeros that the layout has room for.
  void SkipZero() {
    if (Next<std::uint32_t>() != 0) failed_ = true;
  }

 private:
  bool Has(std::uint64_t count, std::size_t size) {
    if (!failed_ && count <= (bytes_.size() - at_) / size) return true;
    failed_ = true;
    return false;
  }

  template <typename Value>
  Value Fail() {
    failed_ = true;
    return Value{};
  }

  template <typename Number>
  void CopyInto(Number* numbers, std::uint64_t count) {
    if (count > 0) std::memcpy(numbers, bytes_.data() + at_, count * sizeof(Number));
    at_ += count * sizeof(Number);
    Align();
  }

  void Align() {
    const std::size_t end = Aligned(at_);
    const std::string_view between = bytes_.substr(at_, end - at_);
    failed_ =
        failed_ || end > bytes_.size() || between.find_first_not_of('\0') != std::string_view::npos;
    at_ = std::min(end, bytes_.size());
  }

  const std::string_view bytes_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

void ReadNodes(Cursor& in, DesignFields& design, bool& is_known) {
  const auto encoding = in.Next<Encoding>();
  in.SkipZero();
  const auto count = in.Next<std::uint64_t>();
  const auto origin = in.NextMatrix<Eigen::MatrixXd>(3, 1);
  const auto step = in.Next<double>();
  if (in.failed()) return;
  if (encoding == Encoding::kDouble) {
    const auto positions = in.NextMatrix<Eigen::MatrixXd>(3, count);
    if (!in.failed()) design.nodes = positions;
    return;
  }
  is_known = encoding == Encoding::kSteps && origin.allFinite() && std::isfinite(step) && step > 0;
  if (!is_known) return;
  using Steps = Eigen::Matrix<std::uint32_t, Eigen::Dynamic, Eigen::Dynamic>;
  const auto steps = in.NextMatrix<Steps>(3, count);
  if (in.failed()) return;
  design.nodes = (step * steps.cast<double>()).colwise() + origin.col(0);
}

Eigen::MatrixXi ReadCells(Cursor& in) {
  const auto rows = in.Next<std::uint32_t>();
  in.SkipZero();
  const auto count = in.Next<std::uint64_t>();
  return in.NextMatrix<Eigen::MatrixXi>(rows, count);
}

Eigen::VectorXi ReadColumn(Cursor& in, Eigen::Index count) {
  const std::vector<int> numbers = in.NextArray<int>(static_cast<std::uint64_t>(count));
  return Eigen::Map<const Eigen::VectorXi>(numbers.data(), std::ssize(numbers));
}

void ReadRegions(Cursor& in, DesignFields& design) {
  design.regions.resize(in.NextCount(2 * sizeof(std::uint64_t)));
  for (Region& region : design.regions) {
    region.name = in.NextText();
    region.triangles = in.NextList();
    if (in.failed()) return;
  }
}

void ReadControlPoints(Cursor& in, DesignFields& design) {
  design.control_points.resize(in.NextCount(5 * sizeof(std::uint64_t)));
  for (ControlPoint& point : design.control_points) {
    point.id = in.NextText();
    const auto position = in.NextMatrix<Eigen::MatrixXd>(3, 1);
    point.node = in.Next<int>();  // kNone is -1
    in.SkipZero();
    if (in.failed()) return;
    point.position = position.col(0);
  }
}

void ReadPaths(Cursor& in, DesignFields& design) {
  design.paths.resize(in.NextCount(2 * sizeof(std::uint64_t)));
  for (Path& path : design.paths) {
    path.id = in.NextText();
    path.nodes = in.NextList();
    if (in.failed()) return;
  }
}

void ReadControlWays(Cursor& in, DesignFields& design) {
  design.ways.resize(in.NextCount(9 * sizeof(std::uint64_t)));
  for (ControlWay& way : design.ways) {
    way.edge = in.NextText();
    way.from = in.Next<int>();
    way.to = in.Next<int>();
    const auto count = in.Next<std::uint64_t>();
    const auto positions = in.NextMatrix<Eigen::MatrixXd>(3, count);
    if (in.failed()) return;
    way.positions = positions;
  }
}

void ReadField(Cursor& in, DesignFields& design, bool& is_known) {
  Field field;
  field.name = in.NextText();
  field.unit = in.NextText();
  field.load_case = in.NextText();
  const auto place = in.Next<std::uint32_t>();
  const auto encoding = in.Next<Encoding>();
  const auto components = in.Next<std::uint32_t>();
  in.SkipZero();
  const auto count = in.Next<std::uint64_t>();
  if (in.failed()) return;
  is_known =
      (place == 1 || place == 2) && (encoding == Encoding::kDouble || encoding == Encoding::kFloat);
  if (!is_known) return;
  field.place = place == 1 ? FieldPlace::kNodes : FieldPlace::kElements;
  field.values = encoding == Encoding::kDouble
                     ? in.NextMatrix<Eigen::MatrixXd>(components, count)
                     : in.NextMatrix<Eigen::MatrixXf>(components, count).cast<double>();
  design.fields.push_back(std::move(field));
}

// Reads a section of a kind that is known; false for numbers that mean nothing.
bool ReadSection(SectionKind kind, Cursor& in, DesignFields& design) {
  bool is_known = true;
  switch (kind) {
    case SectionKind::kNodes:
      ReadNodes(in, design, is_known);
      break;
    case SectionKind::kTetrahedra:
      design.tetrahedra = ReadCells(in);
      design.tetrahedron_part = ReadColumn(in, design.tetrahedra.cols());
      break;
    case SectionKind::kTriangles:
      design.triangles = ReadCells(in);
      design.triangle_back = ReadColumn(in, design.triangles.cols());
      design.triangle_front = ReadColumn(in, design.triangles.cols());
      break;
    case SectionKind::kParts:
      design.parts.resize(in.NextCount(sizeof(std::uint64_t)));
      for (std::string& part : design.parts) part = in.NextText();
      break;
    case SectionKind::kRegions:
      ReadRegions(in, design);
      break;
    case SectionKind::kControlPoints:
      ReadControlPoints(in, design);
      break;
    case SectionKind::kPaths:
      ReadPaths(in, design);
      break;
    case SectionKind::kField:
      ReadField(in, design, is_known);
      break;
    case SectionKind::kControlWays:
      ReadControlWays(in, design);
      break;
  }
  return is_known;
}

absl::Status CheckHeader(std::string_view bytes, std::int64_t size_limit) {
  if (static_cast<std::int64_t>(bytes.size()) > size_limit) {
    return TooLarge(absl::StrCat("a file of shape and fields of ", bytes.size(), " bytes"),
                    absl::StrCat(size_limit, " bytes"));
  }
  if (bytes.size() < kHeaderSize || bytes.substr(0, kMagic.size()) != kMagic) {
    return InvalidField("header", "is not that of a file of shape and fields (MORTISEF)");
  }
  if (const auto version = NumberAt<std::uint32_t>(bytes, kVersionAt); version != kFormatVersion) {
    return InvalidField("header.version",
                        absl::StrCat("is ", version, "; this program reads ", kFormatVersion));
  }
  if (const auto size = NumberAt<std::uint64_t>(bytes, kSizeAt); size != bytes.size()) {
    return InvalidField("header.size",
                        absl::StrCat("is ", size, ", but there are ", bytes.size(), " bytes"));
  }
  const std::string digest = absl::HexStringToBytes(Sha256Hex(bytes.substr(kHeaderSize)));
  if (bytes.substr(kChecksumAt, kChecksumSize) == digest &&
      bytes.substr(kChecksumAt + kChecksumSize, kHeaderSize - kChecksumAt - kChecksumSize)
              .find_first_not_of('\0') == std::string_view::npos) {
    return absl::OkStatus();
  }
  return InvalidField("header.checksum", "is not that of the bytes: the file was changed");
}

// The sections lie one after another, to the end of the file, in the order of their kinds.
class Table {
 public:
  explicit Table(std::string_view bytes)
      : bytes_(bytes), count_(NumberAt<std::uint32_t>(bytes, kSectionsAt)) {}

  absl::Status ReadInto(DesignFields& design) {
    if (count_ > (bytes_.size() - kHeaderSize) / kTableEntrySize) {
      return InvalidField("sections", "are more than the file has room for");
    }
    std::size_t end = kHeaderSize + count_ * kTableEntrySize;
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const std::string field = absl::StrCat("sections[", i, "]");
      const std::size_t entry = kHeaderSize + i * kTableEntrySize;
      const auto kind = NumberAt<std::uint32_t>(bytes_, entry);
      const auto offset = NumberAt<std::uint64_t>(bytes_, entry + 8);
      const auto size = NumberAt<std::uint64_t>(bytes_, entry + 16);
      if (offset != end || size > bytes_.size() - end || size % kAlignment != 0) {
        return InvalidField(field, "does not lie where the one before it ends");
      }
      MORTISE_RETURN_IF_ERROR(CheckOrder(kind, last, field));
      last = kind;
      end += size;
      // What later programs add is none of this one's concern.
      if (kind > static_cast<std::uint32_t>(SectionKind::kControlWays)) continue;
      Cursor in(bytes_.substr(offset, size));
      if (!ReadSection(static_cast<SectionKind>(kind), in, design) || !in.AtEnd()) {
        return InvalidField(field, absl::StrCat("of kind ", kind, " is not laid out as it should"));
      }
    }
    if (last < static_cast<std::uint32_t>(SectionKind::kPaths)) {
      return InvalidField("sections", "lack one of kinds 1 to 7");
    }
    if (end == bytes_.size()) return absl::OkStatus();
    return InvalidField("sections", "do not reach the end of the file");
  }

 private:
  // Kinds 1 to 7 are there once each; fields, control ways, and what is not known, follow.
  static absl::Status CheckOrder(std::uint32_t kind, std::uint32_t last, const std::string& field) {
    constexpr auto kPaths = static_cast<std::uint32_t>(SectionKind::kPaths);
    constexpr auto kWays = static_cast<std::uint32_t>(SectionKind::kControlWays);
    const bool is_next = last < kPaths ? kind == last + 1 : kind >= last && kind > kPaths;
    if (is_next && !(kind == kWays && last == kWays)) return absl::OkStatus();
    return InvalidField(field, absl::StrCat("of kind ", kind, " must not follow kind ", last));
  }

  const std::string_view bytes_;
  const std::size_t count_;
};

}  // namespace

absl::StatusOr<DesignFields> ReadFields(std::string_view bytes, std::int64_t size_limit) {
  MORTISE_RETURN_IF_ERROR(CheckHeader(bytes, size_limit));
  DesignFields design;
  MORTISE_RETURN_IF_ERROR(Table(bytes).ReadInto(design));
  MORTISE_RETURN_IF_ERROR(Check(design));
  return design;
}

}  // namespace mortise::fields
