#include "cli/explore/surface_pack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;
using Steps = std::vector<std::uint16_t>;

constexpr double kMostSteps = 65535;

// A range in whole steps.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void Add(double number) {
    low = std::min(low, number);
    high = std::max(high, number);
  }
  double origin() const { return low <= high ? low : 0; }
  double step() const { return low < high ? (high - low) / kMostSteps : 0; }
  std::uint16_t StepsOf(double number) const {
    return low < high ? static_cast<std::uint16_t>(std::lround((number - low) / step())) : 0;
  }
};

absl::StatusOr<std::vector<float>> ReadFloats(const std::string& bytes, std::int64_t count,
                                              const std::string& of) {
  if (static_cast<std::int64_t>(bytes.size()) != 4 * count) {
    return absl::DataLossError(absl::StrCat(of, " came with ", bytes.size(), " bytes, not ",
                                            4 * count, " for the nodes of its mesh"));
  }
  std::vector<float> numbers(static_cast<std::size_t>(count));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  for (const float number : numbers) {
    if (!std::isfinite(number)) return absl::DataLossError(absl::StrCat(of, " is not finite"));
  }
  return numbers;
}

// One sample as it was received, in numbers.
struct Shape {
  int sample = 0;
  std::size_t mesh = 0;
  std::vector<float> positions = {};
  std::vector<std::vector<float>> fields = {};  // in the page's order; empty where it has it not
};

class SurfacePacker {
 public:
  SurfacePacker(const ExportedStructure& structure, const std::vector<v1::MapShapes::Field>& fields)
      : structure_(structure), fields_(fields), ranges_(fields.size()) {}

  absl::StatusOr<Json> Pack(pages::NumberPack& pack) {
    MORTISE_RETURN_IF_ERROR(ReadMeshes(pack));
    MORTISE_RETURN_IF_ERROR(ReadSamples());
    Json description;
    description["meshes"] = Json::array();
    for (std::size_t m = 0; m < structure_.meshes.size(); ++m) {
      Json low = Json::array(), step = Json::array();
      for (const Range& range : boxes_[m]) {
        low.push_back(range.origin());
        step.push_back(range.step());
      }
      description["meshes"].push_back({{"number", structure_.meshes[m].mesh()},
                                       {"nodes", structure_.meshes[m].nodes()},
                                       {"low", low},
                                       {"step", step}});
    }
    description["fields"] = Json::array();
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      description["fields"].push_back({{"components", fields_[f].components()},
                                       {"low", ranges_[f].origin()},
                                       {"step", ranges_[f].step()}});
    }
    description["samples"] = Json::array();
    for (const Shape& shape : shapes_) description["samples"].push_back(PackShape(shape));
    pack.Add("steps", std::span<const std::uint8_t>(bytes_));
    return description;
  }

 private:
  absl::Status ReadMeshes(pages::NumberPack& pack) {
    for (std::size_t m = 0; m < structure_.meshes.size(); ++m) {
      const v1::MapMesh& mesh = structure_.meshes[m];
      places_[mesh.mesh()] = m;
      std::vector<std::uint32_t> triangles(mesh.triangles().size() / 4);
      std::memcpy(triangles.data(), mesh.triangles().data(), 4 * triangles.size());
      for (const std::uint32_t node : triangles) {
        if (node >= static_cast<std::uint64_t>(mesh.nodes()) || triangles.size() % 3 != 0) {
          return absl::DataLossError(absl::StrCat("mesh ", mesh.mesh(), " came damaged"));
        }
      }
      pack.Add(absl::StrCat("triangles", mesh.mesh()), std::span<const std::uint32_t>(triangles));
    }
    boxes_.resize(structure_.meshes.size());
    bases_.resize(structure_.meshes.size());
    return absl::OkStatus();
  }

  absl::Status ReadSamples() {
    for (const v1::MapExportPart::Sample& sample : structure_.samples) {
      const auto mesh = places_.find(sample.mesh());
      if (mesh == places_.end()) {
        return absl::DataLossError(absl::StrCat("a shape came without mesh ", sample.mesh()));
      }
      Shape shape{.sample = sample.sample(), .mesh = mesh->second};
      const std::int64_t nodes = structure_.meshes[shape.mesh].nodes();
      MORTISE_ASSIGN_OR_RETURN(shape.positions,
                               ReadFloats(sample.positions(), 3 * nodes, "a shape"));
      for (std::size_t i = 0; i < shape.positions.size(); ++i) {
        boxes_[shape.mesh][i % 3].Add(shape.positions[i]);
      }
      shape.fields.resize(fields_.size());
      for (const v1::MapFieldValues& values : sample.fields()) {
        MORTISE_RETURN_IF_ERROR(ReadField(values, nodes, shape));
      }
      shapes_.push_back(std::move(shape));
    }
    return absl::OkStatus();
  }

  absl::Status ReadField(const v1::MapFieldValues& values, std::int64_t nodes, Shape& shape) {
    const auto field = std::ranges::find_if(fields_, [&](const v1::MapShapes::Field& one) {
      return one.name() == values.name() && one.load_case() == values.load_case();
    });
    if (field == fields_.end()) return absl::OkStatus();
    const auto f = static_cast<std::size_t>(field - fields_.begin());
    MORTISE_ASSIGN_OR_RETURN(shape.fields[f],
                             ReadFloats(values.values(), field->components() * nodes,
                                        absl::StrCat("field ", values.name())));
    for (const float number : shape.fields[f]) ranges_[f].Add(number);
    return absl::OkStatus();
  }

  // Places of its steps among all bytes, −1 for a field that it has not.
  Json PackShape(const Shape& shape) {
    Bases& base = bases_[shape.mesh];
    const std::array<Range, 3>& box = boxes_[shape.mesh];
    Steps positions(shape.positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] = box[i % 3].StepsOf(shape.positions[i]);
    }
    Json packed = {{"sample", shape.sample}, {"mesh", shape.mesh}, {"positions", bytes_.size()}};
    pages::AppendFolded(positions, base.positions, 3, bytes_);
    const bool is_base = base.positions.empty();
    if (is_base) {
      base.positions = std::move(positions);
      base.fields.resize(fields_.size());
    }
    packed["fields"] = Json::array();
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      if (shape.fields[f].empty()) {
        packed["fields"].push_back(-1);
        continue;
      }
      Steps steps(shape.fields[f].size());
      std::ranges::transform(shape.fields[f], steps.begin(),
                             [&](float number) { return ranges_[f].StepsOf(number); });
      packed["fields"].push_back(bytes_.size());
      pages::AppendFolded(steps, base.fields[f], static_cast<std::size_t>(fields_[f].components()),
                          bytes_);
      if (is_base) base.fields[f] = std::move(steps);
    }
    return packed;
  }

  // What the first sample of a mesh has: others are kept as differences from it.
  struct Bases {
    Steps positions;
    std::vector<Steps> fields;
  };

  const ExportedStructure& structure_;
  const std::vector<v1::MapShapes::Field>& fields_;
  std::map<int, std::size_t> places_;  // of meshes, by their numbers
  std::vector<std::array<Range, 3>> boxes_;
  std::vector<Range> ranges_;
  std::vector<Shape> shapes_;
  std::vector<Bases> bases_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

absl::StatusOr<Json> PackSurfaces(const ExportedStructure& structure,
                                  const std::vector<v1::MapShapes::Field>& fields,
                                  pages::NumberPack& pack) {
  return SurfacePacker(structure, fields).Pack(pack);
}

}  // namespace mortise::cli
