#include "services/interpolator/shapes/packed_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::interpolator {
namespace {

constexpr double kSteps = 65535;

// What is added up are numbers of 32 bits; some of the range is left for the weights.
constexpr double kLargest = std::numeric_limits<float>::max() / 1e6;

std::uint16_t Number(double value, double origin, double step) {
  if (step == 0) return 0;
  return static_cast<std::uint16_t>(std::clamp(std::round((value - origin) / step), 0.0, kSteps));
}

// Returns the length of a step. A range whose steps computers cannot tell from 0 counts as none.
double StepOf(double minimum, double maximum) {
  const double step = (maximum - minimum) / kSteps;
  return step >= std::numeric_limits<double>::min() ? step : 0;
}

absl::Status CheckNumbers(const Eigen::Ref<const Eigen::MatrixXd>& numbers,
                          const std::string& field) {
  if (!numbers.allFinite()) return InvalidField(field, "must be finite");
  if (numbers.size() == 0 || numbers.cwiseAbs().maxCoeff() <= kLargest) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("must be no larger than ", kLargest));
}

std::string FieldPath(std::size_t index) { return absl::StrCat("fields[", index, "]"); }

PackedField PackField(const Eigen::MatrixXd& values) {
  PackedField field;
  field.components = static_cast<int>(values.rows());
  field.numbers.resize(static_cast<std::size_t>(values.size()));
  if (values.size() == 0) return field;
  field.minimum = values.minCoeff();
  field.step = StepOf(field.minimum, values.maxCoeff());
  std::transform(values.data(), values.data() + values.size(), field.numbers.begin(),
                 [&](double value) { return Number(value, field.minimum, field.step); });
  return field;
}

void PackPositions(const Eigen::Matrix3Xd& nodes, PackedShape& packed) {
  packed.positions.resize(static_cast<std::size_t>(nodes.size()));
  if (nodes.cols() == 0) return;
  packed.origin = nodes.rowwise().minCoeff();
  const Eigen::Vector3d highest = nodes.rowwise().maxCoeff();
  for (int axis = 0; axis < 3; ++axis) {
    packed.step[axis] = StepOf(packed.origin[axis], highest[axis]);
  }
  for (std::size_t i = 0; i < packed.positions.size(); ++i) {
    const auto axis = static_cast<int>(i % 3);
    packed.positions[i] = Number(nodes.data()[i], packed.origin[axis], packed.step[axis]);
  }
}

}  // namespace

std::int64_t PackedShape::ByteSize() const {
  std::size_t size = sizeof(PackedShape) + positions.size() * sizeof(std::uint16_t);
  for (const PackedField& field : fields) {
    size += sizeof(PackedField) + field.numbers.size() * sizeof(std::uint16_t);
  }
  return static_cast<std::int64_t>(size);
}

absl::StatusOr<PackedShape> Pack(const ConsistentShape& shape, const CanonicalMesh& mesh) {
  if (shape.nodes.cols() != mesh.node_count()) {
    return InvalidField("shape.nodes", absl::StrCat("must be ", mesh.node_count()));
  }
  MORTISE_RETURN_IF_ERROR(CheckNumbers(shape.nodes, "shape.nodes"));
  if (shape.fields.size() != mesh.fields.size()) {
    return InvalidField("shape.fields", absl::StrCat("must be ", mesh.fields.size()));
  }
  PackedShape packed;
  PackPositions(shape.nodes, packed);
  for (std::size_t f = 0; f < shape.fields.size(); ++f) {
    const Eigen::MatrixXd& values = shape.fields[f];
    const FieldKind& kind = mesh.fields[f];
    if (values.rows() != kind.components || values.cols() != mesh.ValueCount(kind)) {
      return InvalidField(
          absl::StrCat("shape.", FieldPath(f)),
          absl::StrCat("must have ", kind.components, " × ", mesh.ValueCount(kind), " numbers"));
    }
    MORTISE_RETURN_IF_ERROR(CheckNumbers(values, absl::StrCat("shape.", FieldPath(f))));
    packed.fields.push_back(PackField(values));
  }
  return packed;
}

ConsistentShape Unpack(const PackedShape& shape) {
  ConsistentShape exact;
  exact.nodes.resize(3, static_cast<Eigen::Index>(shape.positions.size() / 3));
  for (std::size_t i = 0; i < shape.positions.size(); ++i) {
    const auto axis = static_cast<int>(i % 3);
    exact.nodes.data()[i] = shape.origin[axis] + shape.step[axis] * shape.positions[i];
  }
  for (const PackedField& field : shape.fields) {
    const auto count = static_cast<Eigen::Index>(field.numbers.size());
    Eigen::MatrixXd values(field.components, count / field.components);
    std::transform(field.numbers.begin(), field.numbers.end(), values.data(),
                   [&](std::uint16_t number) { return field.minimum + field.step * number; });
    exact.fields.push_back(std::move(values));
  }
  return exact;
}

absl::Status CheckFits(const PackedShape& shape, const CanonicalMesh& mesh) {
  if (std::ssize(shape.positions) != mesh.nodes.size()) {
    return InvalidField("positions", absl::StrCat("must be of ", mesh.node_count(), " nodes"));
  }
  if (shape.fields.size() != mesh.fields.size()) {
    return InvalidField("fields", absl::StrCat("must be ", mesh.fields.size()));
  }
  for (std::size_t f = 0; f < shape.fields.size(); ++f) {
    const FieldKind& kind = mesh.fields[f];
    const auto count = static_cast<std::ptrdiff_t>(kind.components) * mesh.ValueCount(kind);
    if (shape.fields[f].components == kind.components &&
        std::ssize(shape.fields[f].numbers) == count) {
      continue;
    }
    return InvalidField(FieldPath(f), absl::StrCat("must have ", kind.components, " × ",
                                                   mesh.ValueCount(kind), " numbers"));
  }
  return absl::OkStatus();
}

double PositionError(const PackedShape& shape) { return shape.step.norm() / 2; }

}  // namespace mortise::interpolator
