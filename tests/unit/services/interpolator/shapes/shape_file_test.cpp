#include "services/interpolator/shapes/shape_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "common/base/errors.h"
#include "tests/unit/services/interpolator/shapes/block_designs.h"
#include "tests/unit/services/interpolator/shapes/brought_design.h"

namespace mortise::interpolator {
namespace {

fields::DesignFields Plate(double hole, int cells) {
  return BlockDesign(PlateShape(0.3, 0.2, 0.03, hole),
                     {.along = cells, .across = cells, .high = 2});
}

PackedShape ShapeOf(const fields::DesignFields& design, const CanonicalMesh& mesh) {
  return Pack(Brought(design, mesh).value().shape, mesh).value();
}

void ExpectSame(const PackedShape& a, const PackedShape& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.positions, b.positions);
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (std::size_t f = 0; f < a.fields.size(); ++f) {
    EXPECT_EQ(a.fields[f].minimum, b.fields[f].minimum);
    EXPECT_EQ(a.fields[f].step, b.fields[f].step);
    EXPECT_EQ(a.fields[f].components, b.fields[f].components);
    EXPECT_EQ(a.fields[f].numbers, b.fields[f].numbers);
  }
}

TEST(ShapeFile, ComesBackToTheLastBit) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Plate(0.05, 4)).value();
  PackedShape shape = ShapeOf(Plate(0.06, 4), mesh);
  ExpectSame(ReadShape(WriteShape(shape, mesh).value(), mesh).value(), shape);
  // Whatever the numbers are.
  std::mt19937 random(3);
  std::uniform_int_distribution<int> any(0, 65535);
  for (std::uint16_t& number : shape.positions) number = static_cast<std::uint16_t>(any(random));
  for (PackedField& field : shape.fields) {
    for (std::uint16_t& number : field.numbers) number = static_cast<std::uint16_t>(any(random));
  }
  ExpectSame(ReadShape(WriteShape(shape, mesh).value(), mesh).value(), shape);
}

TEST(ShapeFile, IsTheSameForTheSameShape) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Plate(0.05, 3)).value();
  const PackedShape shape = ShapeOf(Plate(0.06, 3), mesh);
  const CanonicalMesh read = ReadMesh(WriteMesh(mesh).value()).value();
  EXPECT_EQ(WriteShape(shape, mesh).value(), WriteShape(shape, read).value());
}

TEST(ShapeFile, IsSmallerThanTheShape) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Plate(0.05, 12)).value();
  const PackedShape shape = ShapeOf(Plate(0.06, 12), mesh);
  const std::string file = WriteShape(shape, mesh).value();
  EXPECT_LT(1.5 * static_cast<double>(file.size()), static_cast<double>(shape.ByteSize()));
}

TEST(ShapeFile, RefusesDamageAtEveryByte) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Plate(0.05, 1)).value();
  const std::string file = WriteShape(ShapeOf(Plate(0.06, 1), mesh), mesh).value();
  for (std::size_t at = 0; at < file.size(); ++at) {
    std::string damaged = file;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x04);
    const absl::Status status = ReadShape(damaged, mesh).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << at;
    EXPECT_THAT(DetailOf(status).field, testing::AnyOf("shape.header", "shape.checksum")) << at;
    EXPECT_FALSE(ReadShape(std::string_view(file).substr(0, at), mesh).ok()) << at;
  }
  EXPECT_FALSE(ReadShape(file + "x", mesh).ok());
  EXPECT_FALSE(ReadShape(WriteMesh(mesh).value(), mesh).ok());
}

TEST(ShapeFile, IsOfItsMeshAlone) {
  const CanonicalMesh small = CanonicalMesh::Create(Plate(0.05, 2)).value();
  const CanonicalMesh large = CanonicalMesh::Create(Plate(0.05, 3)).value();
  const std::string of_small = WriteShape(ShapeOf(Plate(0.06, 2), small), small).value();
  const std::string of_large = WriteShape(ShapeOf(Plate(0.06, 3), large), large).value();
  EXPECT_EQ(ReadShape(of_small, large).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(ReadShape(of_large, small).ok());
  EXPECT_FALSE(WriteShape(ShapeOf(Plate(0.06, 2), small), large).ok());
}

}  // namespace
}  // namespace mortise::interpolator
