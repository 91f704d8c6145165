// What the catalog exports as STEP is what another program reads: FreeCAD's command line, where it
// is installed (Debian: freecad-python3), finds the same parts, of the same volumes, at the same
// places.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/files.h"
#include "common/cad/step/step_reader.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/filled_catalog.h"

namespace mortise::catalog {
namespace {

using Json = nlohmann::json;
using Stub = v1::AssemblyService::Stub;

constexpr double kPlaceTolerance = 1e-6;   // m
constexpr double kVolumeTolerance = 1e-6;  // relative

std::filesystem::path Sources() { return std::getenv("MORTISE_SOURCE_DIR"); }

bool Installed() { return std::system("command -v freecadcmd > /dev/null 2>&1") == 0; }

// What FreeCAD finds in the file.
Json SeenByFreeCad(const std::string& step) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "design.step";
  const std::filesystem::path parts = folder.path() / "parts.json";
  EXPECT_TRUE(WriteFile(file, step).ok());
  const std::filesystem::path script =
      Sources() / "tests/integration/services/catalog/freecad_parts.py";
  testing::ChildProcess freecad({"/usr/bin/env", "STEP_FILE=" + file.string(),
                                 "PARTS_FILE=" + parts.string(), "HOME=" + folder.path().string(),
                                 "freecadcmd", script.string()});
  return Json::parse(freecad.AwaitFile(parts), nullptr, false);
}

// Groups with the group above each, and how many parts are in each.
std::multiset<std::string> TreeOf(const cad::StepAssembly& assembly) {
  std::multiset<std::string> tree;
  const auto name = [&](int group) {
    return group < 0 ? "" : assembly.groups[static_cast<std::size_t>(group)].name;
  };
  for (const cad::StepGroup& group : assembly.groups) {
    tree.insert(group.name + " in " + name(group.parent));
  }
  for (const cad::StepPart& part : assembly.parts) tree.insert("part in " + name(part.group));
  return tree;
}

std::multiset<std::string> TreeOf(const Json& seen) {
  std::multiset<std::string> tree;
  for (const Json& group : seen["groups"]) {
    tree.insert(group["name"].get<std::string>() + " in " + group["parent"].get<std::string>());
  }
  for (const Json& part : seen["parts"]) {
    tree.insert("part in " + part["group"].get<std::string>());
  }
  return tree;
}

Eigen::Vector3d VectorOf(const Json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

bool IsAt(const Json& seen, const cad::StepAssembly& ours, const cad::StepPart& part) {
  if (seen.contains("deflection")) {
    const double tolerance = kPlaceTolerance + seen["deflection"].get<double>();
    return (VectorOf(seen["minimum"]) - part.minimum).norm() < tolerance &&
           (VectorOf(seen["maximum"]) - part.maximum).norm() < tolerance;
  }
  const cad::Solid& solid = *ours.products[static_cast<std::size_t>(part.product)].solid;
  const Eigen::Vector3d center =
      cad::PlacementOf(ours, part.group) * part.placement * solid.CentreOfMass();
  return (VectorOf(seen["center"]) - center).norm() < kPlaceTolerance;
}

// Splines are measured by triangles that are `deflection` beside them.
bool HasVolume(const Json& seen, double volume) {
  const double tolerance =
      kVolumeTolerance * volume + seen.value("deflection", 0.0) * seen["area"].get<double>();
  return std::abs(seen["volume"].get<double>() - volume) < tolerance;
}

// Each of our parts must be one of FreeCAD's, and all of them must be taken then.
void ExpectTheSameParts(const cad::StepAssembly& ours, Json seen) {
  Json& parts = seen["parts"];
  ASSERT_EQ(parts.size(), ours.parts.size());
  for (const cad::StepPart& part : ours.parts) {
    const auto match = std::find_if(parts.begin(), parts.end(), [&](const Json& other) {
      return IsAt(other, ours, part) && HasVolume(other, part.volume);
    });
    ASSERT_TRUE(match != parts.end())
        << part.name << " of " << part.volume << " m³ from " << part.minimum.transpose() << " to "
        << part.maximum.transpose();
    EXPECT_EQ((*match)["product"], ours.products[static_cast<std::size_t>(part.product)].name)
        << part.name;
    EXPECT_EQ((*match)["solids"], 1) << part.name;
    EXPECT_TRUE((*match)["valid"]) << part.name;
    parts.erase(match);
  }
}

class FreeCadTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!Installed()) {
      GTEST_SKIP() << "freecadcmd is not installed: apt-get install --no-install-recommends "
                      "freecad-python3";
    }
  }

  std::vector<std::string> Assemblies() {
    v1::ListAssembliesResponse listed;
    grpc::ClientContext context;
    testing::Prepare(context);
    const absl::Status status = rpc::FromGrpc(stub_->ListAssemblies(&context, {}, &listed));
    EXPECT_TRUE(status.ok()) << status;
    std::vector<std::string> names;
    for (const v1::Assembly& assembly : listed.assemblies()) names.push_back(assembly.name());
    return names;
  }

  // A drawing of collection/drawings.
  void Import(const std::string& drawing) {
    v1::ImportAssemblyStepRequest request;
    request.set_request_id(drawing);
    request.set_step(*ReadFile(Sources() / "collection/drawings" / (drawing + ".step")));
    request.mutable_annotations()->set_name("assemblies/" + drawing.substr(0, drawing.find('_')));
    v1::ImportAssemblyStepResponse imported;
    grpc::ClientContext context;
    testing::Prepare(context);
    const absl::Status status =
        rpc::FromGrpc(stub_->ImportAssemblyStep(&context, request, &imported));
    ASSERT_TRUE(status.ok()) << status;
  }

  v1::AdjustedAssembly Sample(const std::string& assembly) {
    v1::SampleAssemblyRequest request;
    request.set_name(assembly);
    request.set_count(1);
    request.set_seed(5);
    grpc::ClientContext context;
    testing::Prepare(context);
    v1::AdjustedAssembly sample;
    const auto reader = stub_->SampleAssembly(&context, request);
    EXPECT_TRUE(reader->Read(&sample));
    const absl::Status status = rpc::FromGrpc(reader->Finish());
    EXPECT_TRUE(status.ok()) << status;
    return sample;
  }

  std::string Export(const v1::AdjustedAssembly& design) {
    v1::ExportAssemblyRequest request;
    request.set_name(design.assembly());
    *request.mutable_q() = design.q();
    request.set_format(v1::ExportDesignRequest::STEP);
    grpc::ClientContext context;
    testing::Prepare(context);
    const auto bytes = testing::ReadChunks(*stub_->ExportAssembly(&context, request));
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    return bytes.value_or("");
  }

  testing::FilledCatalog process_;
  std::unique_ptr<Stub> stub_ = v1::AssemblyService::NewStub(process_.channel());
};

TEST_F(FreeCadTest, SeesTheTreeTheVolumesAndThePlacesOfWhatIsExported) {
  Import("garden_seat");
  Import("wall_shelf");
  const std::vector<std::string> assemblies = Assemblies();
  EXPECT_GE(assemblies.size(), 16u);
  for (const std::string& assembly : assemblies) {
    SCOPED_TRACE(assembly);
    const std::string step = Export(Sample(assembly));
    const auto ours = cad::ReadStep(step);
    ASSERT_TRUE(ours.ok()) << ours.status();
    const Json seen = SeenByFreeCad(step);
    ASSERT_FALSE(seen.is_discarded());
    EXPECT_EQ(TreeOf(seen), TreeOf(*ours));
    ExpectTheSameParts(*ours, seen);
  }
}

}  // namespace
}  // namespace mortise::catalog
