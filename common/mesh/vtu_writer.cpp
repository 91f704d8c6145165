#include "common/mesh/vtu_writer.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"

namespace mortise::mesh {
namespace {

static_assert(std::endian::native == std::endian::little,
              "arrays are written as they lie in memory");

constexpr std::uint8_t kVtkTetrahedron = 10;
constexpr std::uint8_t kVtkQuadraticTetrahedron = 24;

// Collects arrays behind the XML part; each is a 64-bit byte count, then its bytes.
class AppendedData {
 public:
  template <typename Number>
  std::string Array(const char* type, const std::string& name, int components, const Number* values,
                    std::size_t count) {
    const std::string escaped =
        absl::StrReplaceAll(name, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
    const std::string xml =
        absl::StrCat("<DataArray type=\"", type, "\" Name=\"", escaped, "\" NumberOfComponents=\"",
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

}  // namespace

absl::StatusOr<std::string> WriteVtu(const TetrahedralMesh& mesh,
                                     const std::vector<VtuField>& point_fields,
                                     const std::vector<VtuField>& cell_fields) {
  const Eigen::Index nodes = mesh.nodes.cols(), elements = mesh.tetrahedra.cols();
  MORTISE_RETURN_IF_ERROR(CheckFields(point_fields, nodes, "point_fields"));
  MORTISE_RETURN_IF_ERROR(CheckFields(cell_fields, elements, "cell_fields"));
  if (mesh.part.size() != elements) return InvalidField("part", "must be one for each element");
  const int corners = static_cast<int>(mesh.tetrahedra.rows());
  std::vector<std::int64_t> offsets(elements);
  for (Eigen::Index e = 0; e < elements; ++e) offsets[e] = (e + 1) * corners;
  const std::vector<std::uint8_t> types(
      elements, mesh.IsQuadratic() ? kVtkQuadraticTetrahedron : kVtkTetrahedron);

  AppendedData data;
  std::string xml = absl::StrCat(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
      "<Piece NumberOfPoints=\"",
      nodes, "\" NumberOfCells=\"", elements, "\">\n<PointData>\n", data.Fields(point_fields),
      "</PointData>\n<CellData>\n",
      data.Array("Int32", "part", 1, mesh.part.data(), mesh.part.size()));
  absl::StrAppend(&xml, data.Fields(cell_fields), "</CellData>\n<Points>\n",
                  data.Array("Float64", "points", 3, mesh.nodes.data(), mesh.nodes.size()));
  absl::StrAppend(
      &xml, "</Points>\n<Cells>\n",
      data.Array("Int32", "connectivity", 1, mesh.tetrahedra.data(), mesh.tetrahedra.size()));
  absl::StrAppend(&xml, data.Array("Int64", "offsets", 1, offsets.data(), offsets.size()));
  absl::StrAppend(&xml, data.Array("UInt8", "types", 1, types.data(), types.size()));
  absl::StrAppend(&xml,
                  "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
                  data.bytes(), "\n</AppendedData>\n</VTKFile>\n");
  return xml;
}

}  // namespace mortise::mesh
