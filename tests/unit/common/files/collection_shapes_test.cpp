// Shapes that a collection brings beside its items and assemblies.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "common/base/files.h"
#include "common/files/collection.h"
#include "common/files/shape_name.h"
#include "tests/support/temporary_folder.h"

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;

class CollectionShapesTest : public ::testing::Test {
 protected:
  CollectionShapesTest() {
    Write("items/hardware.csv",
          "name,kind,material,length,width,thickness,price,currency,price_date,shape\n"
          "items/knob,HARDWARE,materials/oak,1,1,1,1,EUR,2026-01-15,../shapes/ball.step\n"
          "items/foot,HARDWARE,materials/oak,1,1,1,1,EUR,2026-01-15,../shapes/ball.step\n"
          "items/plain,HARDWARE,materials/oak,1,1,1,1,EUR,2026-01-15,\n");
    Write("assemblies/post.textproto",
          "name: 'assemblies/post'\nparts { name: 'a' }\n"
          "parts { name: 'b' shape: '../shapes/cap.step' }\n");
    WriteShape("ball", 1);
    WriteShape("cap", 2);
  }

  void Write(const std::string& file, const std::string& text) {
    ASSERT_TRUE(WriteFile(folder_.path() / file, text).ok());
  }

  // Shapes are told apart by their volume here.
  void WriteShape(const std::string& id, double volume) {
    v1::Shape shape;
    shape.set_volume(volume);
    shape.set_brep(std::string(1000, 'x'));
    shape.set_name(NameOf(shape));
    Write("shapes/" + id + ".shape", shape.SerializeAsString());
  }

  std::string Refusal() {
    const absl::Status status = ReadCollection(folder_.path()).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return std::string(status.message());
  }

  testing::TemporaryFolder folder_;
};

TEST_F(CollectionShapesTest, AreNamedByTheirContentInsteadOfTheirPath) {
  const auto collection = ReadCollection(folder_.path());
  ASSERT_TRUE(collection.ok()) << collection.status();
  ASSERT_EQ(collection->shapes.size(), 2U);
  for (const v1::Shape& shape : collection->shapes) EXPECT_EQ(shape.name(), NameOf(shape));
  const std::string& ball = collection->items[0].shape();
  EXPECT_EQ(collection->items[1].shape(), ball);
  EXPECT_EQ(collection->items[2].shape(), "");
  const std::string& cap = collection->assemblies[0].parts(1).shape();
  EXPECT_NE(ball, cap);
  for (const v1::Shape& shape : collection->shapes) {
    EXPECT_EQ(shape.name(), shape.volume() == 1 ? ball : cap);
  }
}

TEST_F(CollectionShapesTest, ChangeTheDigest) {
  const std::string before = ContentDigest(ReadCollection(folder_.path()).value());
  WriteShape("ball", 3);
  const std::string with_ball = ContentDigest(ReadCollection(folder_.path()).value());
  EXPECT_NE(with_ball, before);
  WriteShape("cap", 4);
  EXPECT_NE(ContentDigest(ReadCollection(folder_.path()).value()), with_ball);
}

TEST_F(CollectionShapesTest, AreMissedWithTheItemAndThePath) {
  std::filesystem::remove(folder_.path() / "shapes" / "ball.shape");
  const std::string refusal = Refusal();
  EXPECT_THAT(refusal, HasSubstr("hardware.csv: line 2, column 10 (shape): items/knob.shape"));
  EXPECT_THAT(refusal, HasSubstr("hardware.csv: line 3, column 10 (shape): items/foot.shape"));
  EXPECT_THAT(refusal, HasSubstr("ball.shape' cannot be read"));
}

TEST_F(CollectionShapesTest, AreMissedWithThePartOfTheAssembly) {
  std::filesystem::remove(folder_.path() / "shapes" / "cap.shape");
  EXPECT_THAT(Refusal(), HasSubstr("post.textproto: parts[1].shape"));
}

// Any byte: the kernel may crash over damaged surfaces.
TEST_F(CollectionShapesTest, AreRefusedWhereTheyAreDamaged) {
  const std::filesystem::path file = folder_.path() / "shapes" / "ball.shape";
  const std::string whole = ReadFile(file).value();
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    Write("shapes/ball.shape", damaged);
    EXPECT_THAT(Refusal(), HasSubstr("ball.shape' is damaged")) << at;
  }
  for (const std::size_t kept :
       {std::size_t{0}, std::size_t{1}, whole.size() / 2, whole.size() - 1}) {
    Write("shapes/ball.shape", whole.substr(0, kept));
    EXPECT_THAT(Refusal(), HasSubstr("ball.shape' is damaged")) << kept;
  }
}

}  // namespace
}  // namespace mortise::parametric
