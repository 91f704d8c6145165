// Files that are no shapes, or take the house's memory: each is refused by saying why, in bounded
// memory, and leaves nothing behind.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/retrieval/retrieval_house.h"

namespace mortise::retrieval {
namespace {

using testing::BuiltState;
using testing::RetrievalHouse;

template <typename Number>
void Append(std::string* bytes, Number number) {
  bytes->append(reinterpret_cast<const char*>(&number), sizeof(number));
}

std::string Glb(std::string json, const std::string& binary, std::uint32_t claimed) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  Append<std::uint32_t>(&bytes, 2);
  Append<std::uint32_t>(&bytes, static_cast<std::uint32_t>(28 + json.size() + binary.size()));
  Append<std::uint32_t>(&bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  Append<std::uint32_t>(&bytes, claimed);
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

// A mesh as glTF: `nodes` are all of them, its accessor has so many corners.
std::string GltfOf(const std::string& nodes, long corners, long buffer, bool with_view,
                   const std::string& binary) {
  const std::string view = with_view ? R"("bufferView":0,)" : "";
  return Glb(
      absl::StrCat(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)",
                   nodes, R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)",
                   R"("accessors":[{)", view, R"("componentType":5126,"count":)", corners,
                   R"(,"type":"VEC3","min":[0,0,0],"max":[40,40,40]}],)",
                   R"("bufferViews":[{"buffer":0,"byteLength":)", buffer,
                   R"(}],"buffers":[{"byteLength":)", buffer, "}]}"),
      binary, static_cast<std::uint32_t>(binary.size()));
}

std::string Triangle(const std::string& nodes, long corners, long buffer, bool with_view = true) {
  std::string binary;
  for (const float each : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 1.F}) Append(&binary, each);
  return GltfOf(nodes, corners, buffer, with_view, binary);
}

// A binary STL file that says it has so many triangles, and has `present`.
std::string Stl(std::uint32_t declared, std::uint32_t present) {
  std::string bytes(80, ' ');
  Append(&bytes, declared);
  for (std::uint32_t i = 0; i < present; ++i) {
    const auto at = static_cast<float>(i % 1000);
    for (const float each : {0.F, 0.F, 1.F, at, 0.F, 0.F, at + 1, 0.F, 0.F, at, 1.F, 0.F}) {
      Append(&bytes, each);
    }
    Append<std::uint16_t>(&bytes, 0);
  }
  return bytes;
}

// A thousand triangles as glTF, shown by so many nodes.
std::string Repeated(int nodes) {
  std::string binary;
  for (int i = 0; i < 1000; ++i) {
    const auto at = static_cast<float>(i % 32), row = static_cast<float>(i / 32);
    for (const float each : {at, row, 0.F, at + 1, row, 0.F, at, row + 1, at}) {
      Append(&binary, each);
    }
  }
  std::string list = R"({"children":[1)";
  for (int i = 2; i <= nodes; ++i) absl::StrAppend(&list, ",", i);
  list += "]}";
  for (int i = 0; i < nodes; ++i) {
    absl::StrAppend(&list, R"(,{"mesh":0,"translation":[0,0,)", i, "]}");
  }
  return GltfOf(absl::StrCat("[", list, "]"), 3000, static_cast<long>(binary.size()), true, binary);
}

// The most memory that a process has had.
double PeakMegabytes(pid_t process) {
  std::ifstream status(absl::StrCat("/proc/", process, "/status"));
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024;
  }
  ADD_FAILURE() << "no peak of " << process;
  return 0;
}

std::set<std::string> FilesOf(const std::filesystem::path& folder) {
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.insert(entry.path().string());
  }
  return files;
}

class BadMeshesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { house_ = BuiltState::House(); }
  static void TearDownTestSuite() { house_.reset(); }

  static absl::StatusOr<v1::SearchShapesResponse> Search(const std::string& file,
                                                         const std::string& name = "") {
    v1::SearchShapesRequest request;
    request.mutable_mesh()->set_file(file);
    request.mutable_mesh()->set_file_name(name);
    return house_->Search(request);
  }

  // The file is refused, and the message is for people.
  static void ExpectRefused(const std::string& what, const std::string& file,
                            absl::StatusCode code = absl::StatusCode::kInvalidArgument) {
    const absl::Status status = Search(file).status();
    EXPECT_EQ(status.code(), code) << what << ": " << status;
    if (code == absl::StatusCode::kInvalidArgument) {
      EXPECT_EQ(DetailOf(status).field, "mesh.file") << what << ": " << status;
    }
    EXPECT_GT(status.message().size(), 10u) << what;
  }

  static std::unique_ptr<RetrievalHouse> house_;
};

std::unique_ptr<RetrievalHouse> BadMeshesTest::house_;

constexpr char kOneNode[] = R"([{"mesh":0}])";

TEST_F(BadMeshesTest, AreRefusedAndLeaveNothingBehind) {
  const std::set<std::string> files = FilesOf(house_->service().folder() / "blobs");
  const std::string index = house_->Index()->SerializeAsString();
  ExpectRefused("empty", "");
  ExpectRefused("blank", std::string(1000, ' '));
  ExpectRefused("zeros", std::string(100'000, '\0'));
  ExpectRefused("without faces", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  ExpectRefused("without area", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  ExpectRefused("not a number", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ExpectRefused("infinite", "v 0 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ExpectRefused("index out of range", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  ExpectRefused("cut off", Stl(50'000, 10));
  ExpectRefused("billions of triangles", Stl(0xFFFFFFFF, 10));
  ExpectRefused("a node within itself", Triangle(R"([{"mesh":0,"children":[0]}])", 3, 36));
  ExpectRefused("nodes within each other",
                Triangle(R"([{"children":[1]},{"mesh":0,"children":[0]}])", 3, 36));
  ExpectRefused("a buffer that is not there", Triangle(kOneNode, 3, 4'000'000'000));
  ExpectRefused("corners that are not there", Triangle(kOneNode, 6'000, 36));
  ExpectRefused("a billion corners that are not there", Triangle(kOneNode, 3'000'000'000, 36),
                absl::StatusCode::kResourceExhausted);
  EXPECT_FALSE(Search(Triangle(kOneNode, 3'000'000'000, 36, false)).ok()) << "corners of zeros";
  ExpectRefused("a chunk that is not there", Glb("{}", "", 0xFFFFFFF0));
  EXPECT_EQ(FilesOf(house_->service().folder() / "blobs"), files);
  EXPECT_EQ(house_->Index()->SerializeAsString(), index);
}

TEST_F(BadMeshesTest, TakeBoundedMemory) {
  const double before = PeakMegabytes(house_->service().pid());
  // Nodes that show a mesh of one triangle over and over, each with a hundred children.
  std::string nodes = "[";
  for (int level = 0; level < 4; ++level) {
    absl::StrAppend(&nodes, level > 0 ? "," : "", R"({"children":[)");
    for (int i = 0; i < 100; ++i) absl::StrAppend(&nodes, i > 0 ? "," : "", level + 1);
    nodes += "]}";
  }
  nodes += R"(,{"mesh":0}])";
  EXPECT_FALSE(Search(Triangle(nodes, 3, 36)).ok()) << "a hundred million triangles";
  // A million triangles are a shape like any other; three million are too many.
  const auto million = Search(Repeated(1000));
  EXPECT_TRUE(million.ok()) << million.status();
  EXPECT_TRUE(absl::IsResourceExhausted(Search(Repeated(3000)).status()));
  // More than a call may have.
  ExpectRefused("twelve megabytes", Stl(240'000, 240'000), absl::StatusCode::kResourceExhausted);
  const double after = PeakMegabytes(house_->service().pid());
  EXPECT_LT(after - before, 600);
  std::cout << "peak of the service, MB: " << before << " before, " << after << " after\n";
  EXPECT_TRUE(Search(Triangle(kOneNode, 3, 36)).ok()) << "it goes on";
}

TEST_F(BadMeshesTest, AreTakenAsTheyAreWhereTheyHaveASurface) {
  const auto single = Search(Triangle(kOneNode, 3, 36));
  ASSERT_TRUE(single.ok()) << single.status();
  EXPECT_EQ(single->matches_size(), 2);
  const auto flat =
      Search("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 3 2 1\nf 4 3 1\n");
  ASSERT_TRUE(flat.ok()) << flat.status();
  EXPECT_EQ(flat->matches_size(), 2);
  // What a file is its content says, not its name; the answer tells that they differ.
  const auto misnamed = Search("v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n", "chair.stl");
  ASSERT_TRUE(misnamed.ok()) << misnamed.status();
  bool is_told = false;
  for (const std::string& note : misnamed->notes()) {
    is_told = is_told || note.find("OBJ") != std::string::npos;
  }
  EXPECT_TRUE(is_told) << misnamed->ShortDebugString();
}

}  // namespace
}  // namespace mortise::retrieval
