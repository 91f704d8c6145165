// Numbers as pages carry them, read again.
#include "common/pages/number_pack.h"

#include <google/protobuf/io/gzip_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "absl/strings/escaping.h"

namespace mortise::pages {
namespace {

// The bytes that a text of base64 packs by gzip.
std::string Unpacked(const std::string& text) {
  std::string packed;
  EXPECT_TRUE(absl::Base64Unescape(text, &packed));
  google::protobuf::io::ArrayInputStream source(packed.data(), static_cast<int>(packed.size()));
  google::protobuf::io::GzipInputStream gzip(&source);
  std::string bytes;
  const void* data = nullptr;
  int size = 0;
  while (gzip.Next(&data, &size)) bytes.append(static_cast<const char*>(data), size);
  return bytes;
}

template <typename Number>
std::vector<Number> ListOf(const NumberPack& pack, const std::string& name) {
  const std::string bytes = Unpacked(pack.Text().value());
  const auto& list = pack.lists()[name];
  std::vector<Number> numbers(list["length"].get<std::size_t>());
  const auto offset = list["offset"].get<std::size_t>();
  EXPECT_EQ(offset % 8, 0u);
  EXPECT_LE(offset + sizeof(Number) * numbers.size(), bytes.size());
  std::memcpy(numbers.data(), bytes.data() + offset, sizeof(Number) * numbers.size());
  return numbers;
}

TEST(NumberPackTest, HasEachListAsItWas) {
  const std::vector<double> doubles = {0.1, -1e300, std::numeric_limits<double>::infinity()};
  const std::vector<std::int32_t> numbers = {-1, 7, 1 << 30, 0, 5};
  const std::vector<std::uint8_t> bytes = {255, 0, 3};
  NumberPack pack;
  pack.Add("bytes", std::span<const std::uint8_t>(bytes));
  pack.Add("doubles", std::span<const double>(doubles));
  pack.Add("none", std::span<const double>());
  pack.Add("numbers", std::span<const std::int32_t>(numbers));
  EXPECT_EQ(ListOf<std::uint8_t>(pack, "bytes"), bytes);
  EXPECT_EQ(ListOf<double>(pack, "doubles"), doubles);
  EXPECT_TRUE(ListOf<double>(pack, "none").empty());
  EXPECT_EQ(ListOf<std::int32_t>(pack, "numbers"), numbers);
  EXPECT_EQ(pack.lists()["doubles"]["type"], "f64");
}

TEST(NumberPackTest, PacksManyNumbersThatAreAlike) {
  std::vector<double> numbers(1'000'000, 0.25);
  NumberPack pack;
  pack.Add("numbers", std::span<const double>(numbers));
  EXPECT_LT(pack.Text().value().size(), 100'000u);
  EXPECT_EQ(ListOf<double>(pack, "numbers"), numbers);
}

// What page/packed_numbers.mjs does.
std::vector<std::uint16_t> Unfolded(const std::vector<std::uint8_t>& bytes,
                                    const std::vector<std::uint16_t>& base, std::size_t stride) {
  std::vector<std::uint16_t> steps(bytes.size() / 2);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const int folded = bytes[i] | bytes[steps.size() + i] << 8;
    const int difference = (folded >> 1) ^ -(folded & 1);
    const int from = !base.empty() ? base[i] : i >= stride ? steps[i - stride] : 0;
    steps[i] = static_cast<std::uint16_t>(from + difference);
  }
  return steps;
}

TEST(AppendFolded, LosesNothing) {
  std::vector<std::uint16_t> base, steps;
  for (int i = 0; i < 5000; ++i) {
    base.push_back(static_cast<std::uint16_t>(i * 7919));
    steps.push_back(
        static_cast<std::uint16_t>(i % 3 == 0 ? base.back() + i % 100 - 50 : i * 104729));
  }
  for (const auto& from : {std::vector<std::uint16_t>(), base}) {
    std::vector<std::uint8_t> bytes;
    AppendFolded(steps, from, 3, bytes);
    EXPECT_EQ(Unfolded(bytes, from, 3), steps);
  }
}

TEST(AppendFolded, SmallDifferencesHaveNoHighBytes) {
  const std::vector<std::uint16_t> base = {0, 100, 65535, 40000};
  const std::vector<std::uint16_t> steps = {65535, 90, 3, 40001};
  std::vector<std::uint8_t> bytes;
  AppendFolded(steps, base, 1, bytes);
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin() + 4, bytes.end()),
            std::vector<std::uint8_t>(4, 0));
}

}  // namespace
}  // namespace mortise::pages
