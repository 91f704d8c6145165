#include "cli/files/map_shape_file.h"

#include <Eigen/Core>
#include <cstring>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/files/stl.h"
#include "common/mesh/files/vtu_writer.h"

namespace mortise::cli {
namespace {

// Columns of numbers of 32 bits.
template <typename Number>
absl::StatusOr<Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>> ColumnsOf(
    const std::string& bytes, int rows, const char* what) {
  if (rows < 1 || bytes.size() % (sizeof(Number) * static_cast<std::size_t>(rows)) != 0) {
    return InvalidField(what, "does not have whole columns of numbers");
  }
  Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic> columns(
      rows, static_cast<Eigen::Index>(bytes.size() / sizeof(Number)) / rows);
  if (!bytes.empty()) std::memcpy(columns.data(), bytes.data(), bytes.size());
  return columns;
}

// What the map says of a field, or nothing.
const v1::MapShapes::Field* FindField(const v1::DesignMap& map, const v1::MapFieldValues& values) {
  for (const v1::MapShapes::Field& field : map.shapes().fields()) {
    if (field.name() == values.name() && field.load_case() == values.load_case()) return &field;
  }
  return nullptr;
}

struct Fields {
  std::vector<mesh::VtuField> of_nodes;
  std::vector<mesh::VtuField> of_elements;
};

absl::StatusOr<Fields> ReadFields(const v1::DesignMap& map, const v1::MapShape& shape) {
  Fields fields;
  for (const v1::MapFieldValues& values : shape.fields()) {
    const v1::MapShapes::Field* const field = FindField(map, values);
    if (field == nullptr) continue;
    MORTISE_ASSIGN_OR_RETURN(const Eigen::MatrixXf numbers,
                             ColumnsOf<float>(values.values(), field->components(), "fields"));
    std::string name = absl::StrCat(field->name(), " (", field->unit(), ")");
    if (!field->load_case().empty()) absl::StrAppend(&name, ", ", field->load_case());
    (field->of_elements() ? fields.of_elements : fields.of_nodes)
        .push_back({std::move(name), numbers.cast<double>()});
  }
  return fields;
}

absl::Status CheckNodes(const Eigen::MatrixXi& elements, Eigen::Index nodes) {
  if (elements.size() == 0 || (elements.minCoeff() >= 0 && elements.maxCoeff() < nodes)) {
    return absl::OkStatus();
  }
  return InvalidField("new_mesh", "names a node that there is not");
}

}  // namespace

absl::StatusOr<ShapeFormat> ShapeFormatOf(const std::string& file) {
  const std::string name = absl::AsciiStrToLower(file);
  if (absl::EndsWith(name, ".vtu")) return ShapeFormat::kVtu;
  if (absl::EndsWith(name, ".stl")) return ShapeFormat::kStl;
  return InvalidField("--output", "must end in .vtu, with fields, or .stl, the surface alone");
}

absl::StatusOr<std::string> WriteShapeFile(const v1::DesignMap& map, const v1::MapShape& shape,
                                           ShapeFormat format) {
  MORTISE_ASSIGN_OR_RETURN(const Eigen::MatrixXf positions,
                           ColumnsOf<float>(shape.positions(), 3, "positions"));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::MatrixXi triangles,
                           ColumnsOf<int>(shape.new_mesh().triangles(), 3, "new_mesh.triangles"));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::MatrixXi tetrahedra,
                           ColumnsOf<int>(shape.new_mesh().tetrahedra(), 4, "new_mesh.tetrahedra"));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::MatrixXi parts,
                           ColumnsOf<int>(shape.new_mesh().parts(), 1, "new_mesh.parts"));
  MORTISE_RETURN_IF_ERROR(CheckNodes(triangles, positions.cols()));
  MORTISE_RETURN_IF_ERROR(CheckNodes(tetrahedra, positions.cols()));
  if (parts.cols() != triangles.cols() + tetrahedra.cols()) {
    return InvalidField("new_mesh.parts", "are not as many as triangles and tetrahedra");
  }
  const mesh::SurfaceMesh surface{positions.cast<double>(), triangles};
  if (format == ShapeFormat::kStl) return mesh::WriteStl(surface, map.name());
  MORTISE_ASSIGN_OR_RETURN(const Fields fields, ReadFields(map, shape));
  if (tetrahedra.cols() == 0) return mesh::WriteVtu(surface, fields.of_nodes);
  mesh::TetrahedralMesh volume;
  volume.nodes = surface.vertices;
  volume.tetrahedra = tetrahedra;
  volume.part = parts.rightCols(tetrahedra.cols()).transpose();
  volume.part_names = {shape.new_mesh().part_names().begin(), shape.new_mesh().part_names().end()};
  return mesh::WriteVtu(volume, fields.of_nodes, fields.of_elements);
}

}  // namespace mortise::cli
