#include "common/mesh/files/vtu_writer.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/text_escapes.h"

namespace mortise::mesh {
namespace {

static_assert(std::endian::native == std::endian::little,
              "arrays are written as they lie in memory");

constexpr std::uint8_t kVtkTriangle = 5;
constexpr std::uint8_t kVtkTetrahedron = 10;
constexpr std::uint8_t kVtkQuadraticTetrahedron = 24;

// Collects arrays behind the XML part; each is a 64-bit byte count, then its bytes.
class AppendedData {
 public:
  template <typename Number>
  std::string Array(const char* type, const std::string& name, int components, const Number* values,
                    std::size_t count) {
    const std::string xml = absl::StrCat(
        "<DataArray type=\"", type, "\" Name=\"", EscapeXml(name), "\" NumberOfComponents=\"",
        components, "\" format=\"appended\" offset=\"", bytes_.size(), "\"/>\n");
    const std::uint64_t size = count * sizeof(Number);
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes_.append(reinterpret_cast<const char*>(values), size);
    return xml;
  }

  std::string Fields(const std::vector<VtuField>& fields) {
    std::string xml;
    for (const VtuField& field : fields) {
      xml += Array("Float64", field.name, static_cast<int>(field.values.rows()),
                   field.values.data(), field.values.size());
    }
    return xml;
  }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

absl::Status CheckFields(const std::vector<VtuField>& fields, Eigen::Index count,
                         const char* what) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].values.cols() != count || fields[i].values.rows() == 0) {
      return InvalidField(absl::StrCat(what, "[", i, "]"),
                          absl::StrCat("'", fields[i].name, "' has ", fields[i].values.cols(),
                                       " values where the mesh has ", count));
    }
  }
  return absl::OkStatus();
}

// Cells of one kind: their corners, a column for each.
absl::StatusOr<std::string> Write(const Eigen::Matrix3Xd& points, const Eigen::MatrixXi& cells,
                                  std::uint8_t type, const Eigen::VectorXi* part,
                                  const std::vector<VtuField>& point_fields,
                                  const std::vector<VtuField>& cell_fields) {
  MORTISE_RETURN_IF_ERROR(CheckFields(point_fields, points.cols(), "point_fields"));
  MORTISE_RETURN_IF_ERROR(CheckFields(cell_fields, cells.cols(), "cell_fields"));
  std::vector<std::int64_t> offsets(static_cast<std::size_t>(cells.cols()));
  for (std::size_t c = 0; c < offsets.size(); ++c) {
    offsets[c] = static_cast<std::int64_t>(c + 1) * cells.rows();
  }
  const std::vector<std::uint8_t> types(offsets.size(), type);

  AppendedData data;
  std::string xml = absl::StrCat(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
      "<Piece NumberOfPoints=\"",
      points.cols(), "\" NumberOfCells=\"", cells.cols(), "\">\n<PointData>\n",
      data.Fields(point_fields), "</PointData>\n<CellData>\n");
  if (part != nullptr) xml += data.Array("Int32", "part", 1, part->data(), part->size());
  absl::StrAppend(&xml, data.Fields(cell_fields), "</CellData>\n<Points>\n",
                  data.Array("Float64", "points", 3, points.data(), points.size()));
  absl::StrAppend(&xml, "</Points>\n<Cells>\n",
                  data.Array("Int32", "connectivity", 1, cells.data(), cells.size()));
  absl::StrAppend(&xml, data.Array("Int64", "offsets", 1, offsets.data(), offsets.size()));
  absl::StrAppend(&xml, data.Array("UInt8", "types", 1, types.data(), types.size()));
  absl::StrAppend(&xml,
                  "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
                  data.bytes(), "\n</AppendedData>\n</VTKFile>\n");
  return xml;
}

}  // namespace

absl::StatusOr<std::string> WriteVtu(const TetrahedralMesh& mesh,
                                     const std::vector<VtuField>& point_fields,
                                     const std::vector<VtuField>& cell_fields) {
  if (mesh.part.size() != mesh.tetrahedra.cols()) {
    return InvalidField("part", "must be one for each element");
  }
  return Write(mesh.nodes, mesh.tetrahedra,
               mesh.IsQuadratic() ? kVtkQuadraticTetrahedron : kVtkTetrahedron, &mesh.part,
               point_fields, cell_fields);
}

absl::StatusOr<std::string> WriteVtu(const SurfaceMesh& surface,
                                     const std::vector<VtuField>& point_fields,
                                     const std::vector<VtuField>& cell_fields) {
  return Write(surface.vertices, surface.triangles, kVtkTriangle, nullptr, point_fields,
               cell_fields);
}

}  // namespace mortise::mesh
