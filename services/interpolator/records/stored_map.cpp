#include "services/interpolator/records/stored_map.h"

#include <cstdint>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/string_views.h"
#include "stored_map.pb.h"

namespace mortise::interpolator {
namespace {

constexpr int kOfMetrics = 1;  // versions
constexpr int kWithShapes = 2;
constexpr int kLinear = 1;
constexpr int kCubic = 2;

// A digest as it is written, and as bytes.
constexpr std::size_t kDigestBytes = 32;
std::string ToBytes(const std::string& digits) { return absl::HexStringToBytes(digits); }
std::string ToDigits(std::string_view bytes) { return absl::BytesToHexString(AbslView(bytes)); }

stored::Structure ToStored(const maps::MapContent& content) {
  stored::Structure structure;
  structure.set_dimension(content.dimension);
  structure.set_basis(content.basis == maps::Basis::kCubic ? kCubic : kLinear);
  structure.set_most_disparity(content.options.most_disparity);
  structure.set_most_depth(content.options.most_depth);
  for (const maps::ElementSplit& split : content.splits) {
    structure.add_split_elements(split.element);
    structure.add_split_directions(split.direction);
  }
  structure.set_metrics(static_cast<int>(content.values.rows()));
  structure.mutable_values()->Add(content.values.data(),
                                  content.values.data() + content.values.size());
  structure.mutable_errors()->Add(content.errors.data(),
                                  content.errors.data() + content.errors.size());
  for (std::size_t i = 0; i < content.cut_off.size(); ++i) {
    if (content.cut_off[i] != 0) structure.add_cut_off(static_cast<int>(i));
  }
  return structure;
}

void AddShapes(const StoredShapes& shapes, const maps::MapContent& content,
               stored::Structure& structure) {
  structure.set_samples(static_cast<int>(content.values.cols()));
  structure.set_elements(static_cast<int>(content.cut_off.size()));
  structure.mutable_element_meshes()->Add(shapes.element_meshes.begin(),
                                          shapes.element_meshes.end());
  for (const StoredMesh& mesh : shapes.meshes) {
    stored::Mesh& to = *structure.add_meshes();
    to.set_file(ToBytes(mesh.file));
    for (const auto& [sample, shape] : mesh.shapes) {
      to.add_samples(sample);
      to.mutable_shapes()->append(ToBytes(shape));
    }
  }
  structure.mutable_shape_errors()->Add(shapes.shape_errors.begin(), shapes.shape_errors.end());
  structure.set_fields(static_cast<int>(shapes.field_errors.rows()));
  structure.mutable_field_errors()->Add(shapes.field_errors.data(),
                                        shapes.field_errors.data() + shapes.field_errors.size());
}

// Columns of `rows` numbers.
absl::StatusOr<Eigen::MatrixXd> ToMatrix(const google::protobuf::RepeatedField<double>& numbers,
                                         int rows, int columns) {
  if (rows < 0 || columns < 0 || numbers.size() != std::int64_t{rows} * columns) {
    return absl::DataLossError("its numbers are not as many as it says");
  }
  return Eigen::MatrixXd(Eigen::Map<const Eigen::MatrixXd>(numbers.data(), rows, columns));
}

// Maps of metrics do not say how many samples and elements they have.
absl::Status ReadNumbers(const stored::Structure& structure, bool has_shapes,
                         maps::MapContent& content) {
  const int rows = structure.metrics();
  if (!has_shapes && rows <= 0) return absl::DataLossError("it has no metrics");
  const int samples = has_shapes ? structure.samples() : structure.values_size() / rows;
  const int elements = has_shapes ? structure.elements() : structure.errors_size() / rows;
  MORTISE_ASSIGN_OR_RETURN(content.values, ToMatrix(structure.values(), rows, samples));
  MORTISE_ASSIGN_OR_RETURN(content.errors, ToMatrix(structure.errors(), rows, elements));
  return absl::OkStatus();
}

absl::StatusOr<StoredMesh> ReadMesh(const stored::Mesh& mesh, int samples) {
  const auto count = static_cast<std::size_t>(mesh.samples_size());
  if (mesh.file().size() != kDigestBytes || mesh.shapes().size() != count * kDigestBytes) {
    return absl::DataLossError("a mesh of it has not as many shapes as samples");
  }
  StoredMesh read{ToDigits(mesh.file()), {}};
  for (std::size_t i = 0; i < count; ++i) {
    const int sample = mesh.samples(static_cast<int>(i));
    if (sample < 0 || sample >= samples) {
      return absl::DataLossError("it has a shape of a sample that it does not have");
    }
    read.shapes[sample] =
        ToDigits(std::string_view(mesh.shapes()).substr(i * kDigestBytes, kDigestBytes));
  }
  return read;
}

absl::StatusOr<StoredShapes> ReadShapes(const stored::Structure& structure) {
  StoredShapes shapes;
  for (const stored::Mesh& mesh : structure.meshes()) {
    MORTISE_ASSIGN_OR_RETURN(StoredMesh read, ReadMesh(mesh, structure.samples()));
    shapes.meshes.push_back(std::move(read));
  }
  shapes.element_meshes.assign(structure.element_meshes().begin(),
                               structure.element_meshes().end());
  if (structure.element_meshes_size() != structure.elements()) {
    return absl::DataLossError("it has not a mesh for each element");
  }
  for (const int mesh : shapes.element_meshes) {
    if (mesh < -1 || mesh >= structure.meshes_size()) {
      return absl::DataLossError("it has an element of a mesh that it does not have");
    }
  }
  MORTISE_ASSIGN_OR_RETURN(const Eigen::MatrixXd errors,
                           ToMatrix(structure.shape_errors(), 1, structure.elements()));
  shapes.shape_errors = errors.row(0);
  MORTISE_ASSIGN_OR_RETURN(shapes.field_errors, ToMatrix(structure.field_errors(),
                                                         structure.fields(), structure.elements()));
  return shapes;
}

absl::StatusOr<StoredStructure> FromStored(const stored::Structure& structure, bool has_shapes) {
  maps::MapContent content;
  content.dimension = structure.dimension();
  content.basis = structure.basis() == kCubic ? maps::Basis::kCubic : maps::Basis::kLinear;
  content.options.most_disparity = structure.most_disparity();
  content.options.most_depth = structure.most_depth();
  if (structure.split_elements_size() != structure.split_directions_size()) {
    return absl::DataLossError("its splits have not as many directions as elements");
  }
  for (int i = 0; i < structure.split_elements_size(); ++i) {
    content.splits.push_back({structure.split_elements(i), structure.split_directions(i)});
  }
  MORTISE_RETURN_IF_ERROR(ReadNumbers(structure, has_shapes, content));
  content.cut_off.resize(static_cast<std::size_t>(content.errors.cols()));
  for (const int element : structure.cut_off()) {
    if (element < 0 || element >= content.errors.cols()) {
      return absl::DataLossError("it has cut off an element that it does not have");
    }
    content.cut_off[static_cast<std::size_t>(element)] = 1;
  }
  StoredShapes shapes;
  if (has_shapes) {
    if (content.basis != maps::Basis::kLinear)
      return absl::DataLossError("its basis has no shapes");
    MORTISE_ASSIGN_OR_RETURN(shapes, ReadShapes(structure));
  }
  MORTISE_ASSIGN_OR_RETURN(maps::InterpolationMap map,
                           maps::InterpolationMap::Create(std::move(content)));
  return StoredStructure{std::move(map), std::move(shapes)};
}

}  // namespace

std::string SerializeMap(const std::vector<maps::MapContent>& structures,
                         const std::vector<StoredShapes>& shapes) {
  stored::Map map;
  map.set_version(shapes.empty() ? kOfMetrics : kWithShapes);
  for (std::size_t s = 0; s < structures.size(); ++s) {
    stored::Structure& structure = *map.add_structures();
    structure = ToStored(structures[s]);
    if (!shapes.empty()) AddShapes(shapes[s], structures[s], structure);
  }
  return map.SerializeAsString();
}

absl::StatusOr<std::vector<StoredStructure>> ParseMap(std::string_view bytes) {
  stored::Map map;
  if (!map.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return absl::DataLossError("it is no map");
  }
  if (map.version() != kOfMetrics && map.version() != kWithShapes) {
    return absl::DataLossError(
        absl::StrCat("it is of version ", map.version(), ", which is not known"));
  }
  std::vector<StoredStructure> structures;
  for (const stored::Structure& structure : map.structures()) {
    absl::StatusOr<StoredStructure> read = FromStored(structure, map.version() == kWithShapes);
    if (!read.ok()) return absl::DataLossError(read.status().message());
    structures.push_back(*std::move(read));
  }
  return structures;
}

}  // namespace mortise::interpolator
