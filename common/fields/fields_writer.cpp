#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/fields/fields_file.h"
#include "common/fields/fields_layout.h"

namespace mortise::fields {
namespace {

// A section: numbers, texts and arrays one after another. Without `keep` it is only counted.
class Section {
 public:
  Section(SectionKind kind, bool keep) : kind_(kind), keep_(keep) {}

  SectionKind kind() const { return kind_; }
  std::size_t size() const { return size_; }
  const std::string& bytes() const { return bytes_; }

  template <typename Number>
  void Add(Number number) {
    AddBytes(&number, sizeof number);
  }

  void AddText(const std::string& text) {
    Add(std::uint64_t{text.size()});
    AddBytes(text.data(), text.size());
    Align();
  }

  template <typename Number>
  void AddArray(const Number* numbers, std::size_t count) {
    AddBytes(numbers, count * sizeof(Number));
    Align();
  }

  void AddList(const std::vector<int>& numbers) {
    Add(std::uint64_t{numbers.size()});
    AddArray(numbers.data(), numbers.size());
  }

  // An array that `fill` makes one number after another of.
  template <typename Number, typename Fill>
  void AddMade(std::size_t count, const Fill& fill) {
    if (keep_) {
      std::vector<Number> numbers(count);
      for (std::size_t i = 0; i < count; ++i) numbers[i] = fill(i);
      AddArray(numbers.data(), count);
    } else {
      size_ = Aligned(size_ + count * sizeof(Number));
    }
  }

 private:
  void AddBytes(const void* bytes, std::size_t size) {
    size_ += size;
    if (keep_ && size > 0) bytes_.append(static_cast<const char*>(bytes), size);
  }

  void Align() {
    size_ = Aligned(size_);
    if (keep_) bytes_.resize(size_);
  }

  const SectionKind kind_;
  const bool keep_;
  std::size_t size_ = 0;
  std::string bytes_;
};

Eigen::Vector3d OriginOf(const Eigen::Matrix3Xd& nodes) {
  return nodes.cols() == 0 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(nodes.rowwise().minCoeff());
}

Section NodesSection(const Eigen::Matrix3Xd& nodes, double step, bool keep) {
  Section section(SectionKind::kNodes, keep);
  const Eigen::Vector3d origin = step > 0 ? OriginOf(nodes) : Eigen::Vector3d::Zero();
  section.Add(step > 0 ? Encoding::kSteps : Encoding::kDouble);
  section.Add(std::uint32_t{0});
  section.Add(static_cast<std::uint64_t>(nodes.cols()));
  section.AddArray(origin.data(), 3);
  section.Add(step);
  if (step == 0) {
    section.AddArray(nodes.data(), static_cast<std::size_t>(nodes.size()));
    return section;
  }
  section.AddMade<std::uint32_t>(static_cast<std::size_t>(nodes.size()), [&](std::size_t i) {
    const double offset = nodes.data()[i] - origin[static_cast<Eigen::Index>(i % 3)];
    return static_cast<std::uint32_t>(std::llround(offset / step));
  });
  return section;
}

void AddCells(const Eigen::MatrixXi& cells, Section& section) {
  section.Add(static_cast<std::uint32_t>(cells.cols() == 0 ? 0 : cells.rows()));
  section.Add(std::uint32_t{0});
  section.Add(static_cast<std::uint64_t>(cells.cols()));
  section.AddArray(cells.data(), static_cast<std::size_t>(cells.size()));
}

void AddColumn(const Eigen::VectorXi& numbers, Section& section) {
  section.AddArray(numbers.data(), static_cast<std::size_t>(numbers.size()));
}

Section FieldSection(const Field& field, bool single_precision, bool keep) {
  Section section(SectionKind::kField, keep);
  section.AddText(field.name);
  section.AddText(field.unit);
  section.AddText(field.load_case);
  section.Add(std::uint32_t{field.place == FieldPlace::kNodes ? 1u : 2u});
  section.Add(single_precision ? Encoding::kFloat : Encoding::kDouble);
  section.Add(static_cast<std::uint32_t>(field.values.rows()));
  section.Add(std::uint32_t{0});
  section.Add(static_cast<std::uint64_t>(field.values.cols()));
  const auto count = static_cast<std::size_t>(field.values.size());
  if (single_precision) {
    section.AddMade<float>(
        count, [&](std::size_t i) { return static_cast<float>(field.values.data()[i]); });
  } else {
    section.AddArray(field.values.data(), count);
  }
  return section;
}

void AddNamed(const DesignFields& design, bool keep, std::vector<Section>& sections) {
  Section& parts = sections.emplace_back(SectionKind::kParts, keep);
  parts.Add(std::uint64_t{design.parts.size()});
  for (const std::string& part : design.parts) parts.AddText(part);
  Section& regions = sections.emplace_back(SectionKind::kRegions, keep);
  regions.Add(std::uint64_t{design.regions.size()});
  for (const Region& region : design.regions) {
    regions.AddText(region.name);
    regions.AddList(region.triangles);
  }
  Section& points = sections.emplace_back(SectionKind::kControlPoints, keep);
  points.Add(std::uint64_t{design.control_points.size()});
  for (const ControlPoint& point : design.control_points) {
    points.AddText(point.id);
    points.AddArray(point.position.data(), 3);
    points.Add(point.node < 0 ? kNone : static_cast<std::uint32_t>(point.node));
    points.Add(std::uint32_t{0});
  }
  Section& paths = sections.emplace_back(SectionKind::kPaths, keep);
  paths.Add(std::uint64_t{design.paths.size()});
  for (const Path& path : design.paths) {
    paths.AddText(path.id);
    paths.AddList(path.nodes);
  }
}

Section WaysSection(const std::vector<ControlWay>& ways, bool keep) {
  Section section(SectionKind::kControlWays, keep);
  section.Add(std::uint64_t{ways.size()});
  for (const ControlWay& way : ways) {
    section.AddText(way.edge);
    section.Add(way.from);
    section.Add(way.to);
    section.Add(static_cast<std::uint64_t>(way.positions.cols()));
    section.AddArray(way.positions.data(), static_cast<std::size_t>(way.positions.size()));
  }
  return section;
}

std::vector<Section> SectionsOf(const DesignFields& design, const WriteOptions& options,
                                bool keep) {
  std::vector<Section> sections;
  sections.push_back(NodesSection(design.nodes, options.position_step, keep));
  Section& tetrahedra = sections.emplace_back(SectionKind::kTetrahedra, keep);
  AddCells(design.tetrahedra, tetrahedra);
  AddColumn(design.tetrahedron_part, tetrahedra);
  Section& triangles = sections.emplace_back(SectionKind::kTriangles, keep);
  AddCells(design.triangles, triangles);
  AddColumn(design.triangle_back, triangles);  // -1 is written as kNone
  AddColumn(design.triangle_front, triangles);
  AddNamed(design, keep, sections);
  for (const Field& field : design.fields) {
    sections.push_back(FieldSection(field, options.single_precision, keep));
  }
  if (!design.ways.empty()) sections.push_back(WaysSection(design.ways, keep));
  return sections;
}

std::size_t SizeOf(const std::vector<Section>& sections) {
  std::size_t size = kHeaderSize + sections.size() * kTableEntrySize;
  for (const Section& section : sections) size += section.size();
  return size;
}

// What of the design the options do not hold.
absl::Status CheckOptions(const DesignFields& design, const WriteOptions& options) {
  const double step = options.position_step;
  if (!(step >= 0) || !std::isfinite(step)) {
    return InvalidField("position_step", "must be positive, or 0");
  }
  if (step > 0) {
    const Eigen::Vector3d origin = OriginOf(design.nodes);
    const double extent =
        design.nodes.cols() == 0 ? 0 : (design.nodes.colwise() - origin).maxCoeff();
    if (extent / step >= 4294967295.0) {
      return InvalidField("position_step",
                          absl::StrCat("is too small for a design of ", extent,
                                       " m: positions are up to 2^32 steps apart"));
    }
  }
  if (!options.single_precision) return absl::OkStatus();
  for (std::size_t i = 0; i < design.fields.size(); ++i) {
    const Eigen::MatrixXd& values = design.fields[i].values;
    if (values.size() == 0 || values.cwiseAbs().maxCoeff() <= std::numeric_limits<float>::max()) {
      continue;
    }
    return InvalidField(absl::StrCat("fields[", i, "].values"),
                        "are beyond what single precision holds");
  }
  return absl::OkStatus();
}

template <typename Number>
void Put(Number number, std::size_t at, std::string& bytes) {
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

std::string Join(const std::vector<Section>& sections) {
  std::string bytes(kHeaderSize + sections.size() * kTableEntrySize, '\0');
  bytes.reserve(SizeOf(sections));
  std::copy(kMagic.begin(), kMagic.end(), bytes.begin());
  Put(kFormatVersion, kVersionAt, bytes);
  Put(static_cast<std::uint32_t>(sections.size()), kSectionsAt, bytes);
  Put(std::uint64_t{SizeOf(sections)}, kSizeAt, bytes);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const std::size_t entry = kHeaderSize + i * kTableEntrySize;
    Put(sections[i].kind(), entry, bytes);
    Put(std::uint64_t{bytes.size()}, entry + 8, bytes);
    Put(std::uint64_t{sections[i].size()}, entry + 16, bytes);
    bytes += sections[i].bytes();
  }
  const std::string digest =
      absl::HexStringToBytes(Sha256Hex(std::string_view(bytes).substr(kHeaderSize)));
  std::copy(digest.begin(), digest.end(), bytes.begin() + kChecksumAt);
  return bytes;
}

}  // namespace

absl::StatusOr<std::string> WriteFields(const DesignFields& design, const WriteOptions& options) {
  MORTISE_RETURN_IF_ERROR(Check(design));
  MORTISE_RETURN_IF_ERROR(CheckOptions(design, options));
  const std::int64_t size = FileSize(design, options);
  if (size > options.size_limit) {
    return TooLarge(absl::StrCat("a file of shape and fields of ", size, " bytes"),
                    absl::StrCat(options.size_limit, " bytes"));
  }
  return Join(SectionsOf(design, options, true));
}

std::int64_t FileSize(const DesignFields& design, const WriteOptions& options) {
  return static_cast<std::int64_t>(SizeOf(SectionsOf(design, options, false)));
}

}  // namespace mortise::fields
