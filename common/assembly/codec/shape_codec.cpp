#include "common/assembly/codec/shape_codec.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/files/axis_codec.h"
#include "mortise/v1/item.pb.h"

namespace mortise::parametric {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are copied as they are");

template <class Scalar>
std::string Bytes(const Scalar* numbers, Eigen::Index count) {
  return std::string(reinterpret_cast<const char*>(numbers),
                     static_cast<std::size_t>(count) * sizeof(Scalar));
}

template <class Matrix>
void FromBytes(const std::string& bytes, Eigen::Index rows, Eigen::Index columns, Matrix& matrix) {
  matrix.resize(rows, columns);
  std::memcpy(matrix.data(), bytes.data(), bytes.size());
}

bool IsPositive(double value) { return std::isfinite(value) && value > 0; }

bool IsWithin(const Eigen::Ref<const Eigen::MatrixXi>& indices, Eigen::Index count) {
  return indices.size() == 0 || (indices.minCoeff() >= 0 && indices.maxCoeff() < count);
}

absl::Status CheckArrays(const v1::Shape& message) {
  const int least_vertices = message.surface_only() ? 3 : 4;
  const int least_triangles = message.surface_only() ? 1 : 4;
  if (message.vertex_count() < least_vertices || message.vertex_count() > mesh::kMaxShapeVertices) {
    return InvalidField("vertex_count",
                        absl::StrCat("must be ", least_vertices, " to ", mesh::kMaxShapeVertices));
  }
  if (message.triangle_count() < least_triangles ||
      message.triangle_count() > mesh::kMaxShapeTriangles) {
    return InvalidField("triangle_count", absl::StrCat("must be ", least_triangles, " to ",
                                                       mesh::kMaxShapeTriangles));
  }
  const auto vertices = static_cast<std::size_t>(message.vertex_count());
  const auto triangles = static_cast<std::size_t>(message.triangle_count());
  if (message.vertices().size() != 24 * vertices) {
    return InvalidField("vertices", "must be 24 bytes for each of vertex_count");
  }
  if (message.triangles().size() != 12 * triangles) {
    return InvalidField("triangles", "must be 12 bytes for each of triangle_count");
  }
  if (message.triangle_faces().size() != 4 * triangles) {
    return InvalidField("triangle_faces", "must be 4 bytes for each of triangle_count");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<mesh::DrawnShape> FromProto(const v1::Shape& message) {
  MORTISE_RETURN_IF_ERROR(CheckArrays(message));
  mesh::DrawnShape shape;
  shape.name = message.name();
  shape.size = {message.size().x(), message.size().y(), message.size().z()};
  for (const double length : shape.size) {
    if (!IsPositive(length)) return InvalidField("size", "must be greater than 0");
  }
  if (!IsPositive(message.volume())) return InvalidField("volume", "must be greater than 0");
  shape.volume = message.volume();
  shape.deflection = message.deflection();
  FromBytes(message.vertices(), 3, message.vertex_count(), shape.fractions);
  FromBytes(message.triangles(), 3, message.triangle_count(), shape.triangles);
  FromBytes(message.triangle_faces(), message.triangle_count(), 1, shape.triangle_face);
  if (!shape.fractions.allFinite()) return InvalidField("vertices", "must be finite");
  if (!IsWithin(shape.triangles, message.vertex_count())) {
    return InvalidField("triangles", "name vertices that are not there");
  }
  if (!IsWithin(shape.triangle_face, message.face_names_size())) {
    return InvalidField("triangle_faces", "name faces that are not there");
  }
  for (const std::string& name : message.face_names()) shape.face_names.push_back({name});
  shape.brep = message.brep();
  shape.is_solid = !message.surface_only();
  mesh::DeriveFaces(shape);
  return shape;
}

v1::Shape ToProto(const mesh::DrawnShape& shape) {
  v1::Shape message;
  message.set_name(shape.name);
  message.mutable_size()->set_x(shape.size.x());
  message.mutable_size()->set_y(shape.size.y());
  message.mutable_size()->set_z(shape.size.z());
  message.set_volume(shape.volume);
  message.set_deflection(shape.deflection);
  message.set_vertex_count(static_cast<int>(shape.fractions.cols()));
  message.set_triangle_count(static_cast<int>(shape.triangles.cols()));
  message.set_exact(!shape.brep.empty());
  message.set_vertices(Bytes(shape.fractions.data(), shape.fractions.size()));
  message.set_triangles(Bytes(shape.triangles.data(), shape.triangles.size()));
  message.set_triangle_faces(Bytes(shape.triangle_face.data(), shape.triangle_face.size()));
  for (const std::vector<std::string>& names : shape.face_names) {
    message.add_face_names(names.front());
  }
  for (const mesh::ShapePlane& plane : shape.planes) {
    v1::ShapePlane& added = *message.add_planes();
    added.set_name(plane.name);
    added.set_axis(AxisToProto(static_cast<Axis>(plane.axis)));
    added.set_fraction(plane.fraction);
  }
  message.set_brep(shape.brep);
  message.set_surface_only(!shape.is_solid);
  return message;
}

absl::StatusOr<ShapesByName> FromProto(
    const google::protobuf::RepeatedPtrField<v1::Shape>& shapes) {
  ShapesByName named;
  for (int i = 0; i < shapes.size(); ++i) {
    absl::StatusOr<mesh::DrawnShape> shape = FromProto(shapes[i]);
    if (!shape.ok()) return UnderField(absl::StrCat("shapes[", i, "]"), shape.status());
    const std::string name = shape->name;
    named[name] = std::make_shared<const mesh::DrawnShape>(*std::move(shape));
  }
  return named;
}

}  // namespace mortise::parametric
