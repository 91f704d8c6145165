// The file of shape and fields, there and back, and what is no such file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>

#include "absl/strings/escaping.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/fields/fields_file.h"
#include "tests/unit/common/fields/two_tetrahedra.h"

namespace mortise::fields {
namespace {

void ExpectSameLists(const DesignFields& a, const DesignFields& b) {
  ASSERT_EQ(a.tetrahedra.cols(), b.tetrahedra.cols());
  if (a.tetrahedra.cols() > 0) {
    EXPECT_EQ(a.tetrahedra, b.tetrahedra);
  }
  EXPECT_EQ(a.tetrahedron_part, b.tetrahedron_part);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.triangle_back, b.triangle_back);
  EXPECT_EQ(a.triangle_front, b.triangle_front);
  EXPECT_EQ(a.parts, b.parts);
  ASSERT_EQ(a.regions.size(), b.regions.size());
  for (std::size_t i = 0; i < a.regions.size(); ++i) {
    EXPECT_EQ(a.regions[i].name, b.regions[i].name);
    EXPECT_EQ(a.regions[i].triangles, b.regions[i].triangles);
  }
  ASSERT_EQ(a.control_points.size(), b.control_points.size());
  for (std::size_t i = 0; i < a.control_points.size(); ++i) {
    EXPECT_EQ(a.control_points[i].id, b.control_points[i].id);
    EXPECT_EQ(a.control_points[i].position, b.control_points[i].position);
    EXPECT_EQ(a.control_points[i].node, b.control_points[i].node);
  }
  ASSERT_EQ(a.paths.size(), b.paths.size());
  for (std::size_t i = 0; i < a.paths.size(); ++i) {
    EXPECT_EQ(a.paths[i].id, b.paths[i].id);
    EXPECT_EQ(a.paths[i].nodes, b.paths[i].nodes);
  }
  ASSERT_EQ(a.ways.size(), b.ways.size());
  for (std::size_t i = 0; i < a.ways.size(); ++i) {
    EXPECT_EQ(a.ways[i].edge, b.ways[i].edge);
    EXPECT_EQ(a.ways[i].from, b.ways[i].from);
    EXPECT_EQ(a.ways[i].to, b.ways[i].to);
    EXPECT_EQ(a.ways[i].positions, b.ways[i].positions);
  }
}

void ExpectSameFields(const DesignFields& a, const DesignFields& b, double tolerance) {
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (std::size_t i = 0; i < a.fields.size(); ++i) {
    EXPECT_EQ(a.fields[i].name, b.fields[i].name);
    EXPECT_EQ(a.fields[i].unit, b.fields[i].unit);
    EXPECT_EQ(a.fields[i].load_case, b.fields[i].load_case);
    EXPECT_EQ(a.fields[i].place, b.fields[i].place);
    const Eigen::MatrixXd& expected = a.fields[i].values;
    const Eigen::MatrixXd& read = b.fields[i].values;
    ASSERT_EQ(expected.rows(), read.rows());
    ASSERT_EQ(expected.cols(), read.cols());
    EXPECT_TRUE(
        ((expected - read).array().abs() <= tolerance * expected.array().abs() + 1e-44).all());
    if (tolerance == 0) {
      EXPECT_EQ(expected, read);
    }
  }
}

// A design of any size, with random numbers in it.
DesignFields RandomDesign(std::mt19937& random) {
  const auto below = [&random](int most) { return static_cast<int>(random() % most); };
  DesignFields design;
  const int nodes = 1 + below(30), elements = below(20), triangles = 1 + below(20);
  design.nodes = 1e3 * Eigen::Matrix3Xd::Random(3, nodes);
  const auto indices = [&](int rows, int columns, int most) {
    return Eigen::MatrixXi(
        Eigen::MatrixXi::NullaryExpr(rows, columns, [&](Eigen::Index) { return below(most); }));
  };
  design.parts = {"a", "b"};
  design.tetrahedra = indices(below(2) == 0 ? 4 : 10, elements, nodes);
  design.tetrahedron_part = indices(elements, 1, 2).reshaped();
  design.triangles = indices(below(2) == 0 ? 3 : 6, triangles, nodes);
  design.triangle_back = indices(triangles, 1, 3).reshaped().array() - 1;
  design.triangle_front = indices(triangles, 1, 3).reshaped().array() - 1;
  for (int i = below(4); i > 0; --i) {
    Region& region = design.regions.emplace_back(Region{std::string(i, 'r'), {}});
    for (int t = below(3); t < triangles; t += 1 + below(3)) region.triangles.push_back(t);
  }
  for (int i = below(4); i > 0; --i) {
    design.control_points.push_back(
        {std::string(i, 'c'), Eigen::Vector3d::Random(), below(nodes + 1) - 1});
    design.paths.push_back({std::string(i, 'p'), {below(nodes), below(nodes), below(nodes)}});
  }
  const int points = static_cast<int>(design.control_points.size());
  for (int i = points == 0 ? 0 : below(4); i > 0; --i) {
    design.ways.push_back({std::string(1 + below(9), 'w'), below(points), below(points),
                           Eigen::Matrix3Xd::Random(3, 2 + below(5))});
  }
  for (int i = below(5); i > 0; --i) {
    const bool of_nodes = below(2) == 0;
    design.fields.push_back(
        {"f", "Pa", std::string(i, 'l'), of_nodes ? FieldPlace::kNodes : FieldPlace::kElements,
         1e8 * Eigen::MatrixXd::Random(1 + below(6), of_nodes ? nodes : elements)});
  }
  return design;
}

// The same bytes with the checksum and the size that they should have.
std::string Sealed(std::string bytes) {
  if (bytes.size() < 64) return bytes;
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + 16, &size, sizeof size);
  const std::string digest = absl::HexStringToBytes(Sha256Hex(std::string_view(bytes).substr(64)));
  std::copy(digest.begin(), digest.end(), bytes.begin() + 24);
  return bytes;
}

TEST(FieldsFileTest, EverythingComesBackExactly) {
  const DesignFields design = TwoTetrahedra();
  const auto bytes = WriteFields(design);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  EXPECT_EQ(static_cast<std::int64_t>(bytes->size()), FileSize(design));
  const auto read = ReadFields(*bytes);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->nodes, design.nodes);
  ExpectSameLists(design, *read);
  ExpectSameFields(design, *read, 0);
  EXPECT_EQ(*WriteFields(*read), *bytes);
}

// Files that a script wrote by docs/design-fields.md, with Python's struct and hashlib alone.
TEST(FieldsFileTest, WhatOthersWriteByTheManualIsRead) {
  const char* const source = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path folder = std::filesystem::path(source == nullptr ? "." : source) /
                                       "tests/fuzz/corpus/design_fields_fuzz";
  for (const std::string name : {"exact", "steps", "ways"}) {
    const auto bytes = ReadFile(folder / name);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const auto design = ReadFields(*bytes);
    ASSERT_TRUE(design.ok()) << name << ": " << design.status();
    EXPECT_EQ(design->nodes.rightCols(3), Eigen::Matrix3d::Identity());
    EXPECT_EQ(design->regions.at(0).triangles, std::vector<int>({0, 2}));
    EXPECT_EQ(design->paths.at(0).nodes, std::vector<int>({0, 1, 2}));
    EXPECT_EQ(design->control_points.at(0).id, "V1");
    EXPECT_EQ(design->fields.at(0).load_case, "wind");
    EXPECT_EQ(design->fields.at(0).values, Eigen::MatrixXd::Constant(3, 4, 0.5));
    EXPECT_EQ(design->fields.at(1).place, FieldPlace::kElements);
    EXPECT_EQ(design->fields.at(1).values(0, 0), 5);
    ASSERT_EQ(design->ways.size(), name == "ways" ? 1u : 0u);
    if (design->ways.empty()) continue;
    EXPECT_EQ(design->ways[0].edge, "E2");
    EXPECT_EQ(design->ways[0].to, 1);
    EXPECT_EQ(design->ways[0].positions.col(1), Eigen::Vector3d(0.5, 0.25, 0));
  }
}

TEST(FieldsFileTest, RandomDesignsComeBackWithinWhatTheOptionsSay) {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    const DesignFields design = RandomDesign(random);
    WriteOptions options;
    options.position_step = round % 3 == 0 ? 0 : 1e-5;
    options.single_precision = round % 2 == 0;
    const auto bytes = WriteFields(design, options);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    ASSERT_EQ(static_cast<std::int64_t>(bytes->size()), FileSize(design, options));
    const auto read = ReadFields(*bytes);
    ASSERT_TRUE(read.ok()) << read.status();
    ExpectSameLists(design, *read);
    ExpectSameFields(design, *read, options.single_precision ? std::ldexp(1.0, -24) : 0);
    const double farthest = (read->nodes - design.nodes).cwiseAbs().maxCoeff();
    EXPECT_LE(farthest, options.position_step / 2 * (1 + 1e-6));
  }
}

TEST(FieldsFileTest, StepsAndSinglePrecisionHalveTheBytes) {
  DesignFields design = TwoTetrahedra();
  design.nodes = Eigen::Matrix3Xd::Random(3, 10'000);
  design.fields = {{"von_mises", "Pa", "", FieldPlace::kNodes, Eigen::MatrixXd::Random(1, 10'000)}};
  const std::int64_t exact = FileSize(design);
  const std::int64_t small = FileSize(design, {.position_step = 1e-6, .single_precision = true});
  EXPECT_LT(exact, 4 * 8 * 10'000 + 1200);
  EXPECT_LT(small, 4 * 4 * 10'000 + 1200);
}

TEST(FieldsFileTest, WhatDoesNotFitIsRefusedBeforeItIsWritten) {
  DesignFields design = TwoTetrahedra();
  const std::int64_t size = FileSize(design);
  EXPECT_TRUE(WriteFields(design, {.size_limit = size}).ok());
  const auto too_large = WriteFields(design, {.size_limit = size - 1});
  EXPECT_TRUE(absl::IsResourceExhausted(too_large.status())) << too_large.status();
  EXPECT_TRUE(absl::IsResourceExhausted(ReadFields(*WriteFields(design), size - 1).status()));
  for (const double step : {-1.0, std::nan(""), 1e-12}) {
    const auto refused = WriteFields(design, {.position_step = step});
    EXPECT_EQ(DetailOf(refused.status()).field, "position_step") << step;
  }
  design.fields[1].values(0, 0) = 1e40;
  EXPECT_EQ(DetailOf(WriteFields(design, {.single_precision = true}).status()).field,
            "fields[1].values");
  EXPECT_TRUE(WriteFields(design).ok());
}

TEST(FieldsFileTest, WhatIsNoSuchFileIsRefused) {
  const std::string bytes = *WriteFields(TwoTetrahedra());
  for (const std::string& other : {std::string(), std::string("solid"), std::string(4096, '\0'),
                                   std::string("MORTISEF"), bytes + "more"}) {
    const auto read = ReadFields(other);
    EXPECT_TRUE(absl::IsInvalidArgument(read.status())) << read.status();
  }
  std::string later = bytes;
  later[8] = 2;
  const auto read = ReadFields(Sealed(later));
  EXPECT_EQ(DetailOf(read.status()).field, "header.version") << read.status();
}

// Kinds that later versions add are passed over; control ways are there once.
TEST(FieldsFileTest, SectionsOfLaterVersionsArePassedOver) {
  const std::string bytes = *WriteFields(TwoTetrahedra());
  const std::size_t last = 64 + 24 * 10;  // of the table: seven kinds, three fields, control ways
  ASSERT_EQ(bytes[last], 9);
  std::string later = bytes;
  later[last] = 10;
  const auto read = ReadFields(Sealed(later));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->ways.empty());
  EXPECT_EQ(read->fields.size(), 3u);
  std::string twice = bytes;
  twice[last - 24] = 9;
  EXPECT_TRUE(absl::IsInvalidArgument(ReadFields(Sealed(twice)).status()));
}

TEST(FieldsFileTest, AnyCutAndAnyChangedBitIsNoticed) {
  const std::string bytes = *WriteFields(TwoTetrahedra());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto read = ReadFields(std::string_view(bytes).substr(0, size));
    ASSERT_TRUE(absl::IsInvalidArgument(read.status())) << size;
  }
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string changed = bytes;
    changed[bit / 8] ^= static_cast<char>(1 << bit % 8);
    const auto read = ReadFields(changed);
    ASSERT_TRUE(absl::IsInvalidArgument(read.status())) << bit;
  }
}

// What somebody changed and sealed again is read or refused, and what is read is sound.
TEST(FieldsFileTest, SealedNonsenseIsRefusedOrSound) {
  const std::string bytes = *WriteFields(TwoTetrahedra());
  const auto look = [](const std::string& changed) {
    const auto read = ReadFields(Sealed(changed));
    if (read.ok()) {
      EXPECT_EQ(Check(*read), absl::OkStatus());
    } else {
      EXPECT_TRUE(absl::IsInvalidArgument(read.status())) << read.status();
      EXPECT_FALSE(DetailOf(read.status()).field.empty());
    }
    return read.ok();
  };
  for (std::size_t size = 64; size < bytes.size(); size += 8) {
    EXPECT_FALSE(look(bytes.substr(0, size))) << size;
  }
  for (std::size_t bit = 8 * 64; bit < 8 * bytes.size(); ++bit) {
    std::string changed = bytes;
    changed[bit / 8] ^= static_cast<char>(1 << bit % 8);
    look(changed);
  }
  std::mt19937 random(11);
  for (int round = 0; round < 20'000; ++round) {
    std::string changed = bytes;
    for (int i = 1 + random() % 6; i > 0; --i) {
      const std::size_t at = random() % (changed.size() / 8) * 8;
      // Counts and offsets of all sizes.
      const std::uint64_t number =
          random() % 2 == 0 ? random() % 64 : ~std::uint64_t{0} >> random() % 64;
      std::memcpy(changed.data() + at, &number, sizeof number);
    }
    look(changed);
  }
}

}  // namespace
}  // namespace mortise::fields
