// The plate with a bore of ../shared/data/field/fem, as it is uploaded.
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "common/fem/stress/stress_recovery.h"
#include "common/mesh/files/gmsh_reader.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/worker/mesh_model.h"
#include "tests/unit/common/fem/problems/curved_bodies.h"

namespace mortise::simulator {
namespace {

std::filesystem::path FieldFile(const std::string& name) {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "../shared/data/field/fem" /
         name;
}

std::string Bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

// The stress round the bore, on its whole face and on the two edges of it, is nearer to that of a
// fine mesh than the mean of elements is.
TEST(FieldBore, HasItsStressOnACoarseMesh) {
  if (!std::filesystem::exists(FieldFile("bore.msh"))) {
    GTEST_SKIP() << "no " << FieldFile("bore.msh");
  }
  v1::MeshCase mesh_case;
  ASSERT_TRUE(
      google::protobuf::util::JsonStringToMessage(Bytes(FieldFile("bore.json")), &mesh_case).ok());
  const auto grouped = mesh::ReadGmsh(Bytes(FieldFile("bore.msh")));
  ASSERT_TRUE(grouped.ok()) << grouped.status();
  const auto model = MakeMeshModel(*grouped, mesh_case);
  ASSERT_TRUE(model.ok()) << model.status();
  auto system = ElasticSystem::Create(model->mesh, model->materials, model->supports);
  ASSERT_TRUE(system.ok()) << system.status();
  const auto solution = system->Solve(model->load_cases.at(0).loads);
  ASSERT_TRUE(solution.ok()) << solution.status();
  std::vector<int> rim;
  for (int v = 0; v < model->mesh.nodes.cols(); ++v) {
    if (std::abs(model->mesh.nodes.col(v).head<2>().norm() - 0.009) < 1e-8) rim.push_back(v);
  }
  const RimErrors errors = RimErrorsOf(BoredPlate(0.006), model->mesh, *solution, rim);
  EXPECT_EQ(errors.nodes, 140);
  EXPECT_LT(errors.recovered.stress, 0.7 * errors.mean.stress);
  EXPECT_LT(errors.recovered.at_edges, 0.7 * errors.mean.at_edges);
  EXPECT_LT(std::abs(errors.recovered.largest - 343.8e6), std::abs(errors.mean.largest - 343.8e6));
  RecordProperty("recovered_MPa", std::to_string(errors.recovered.stress / 1e6));
  RecordProperty("mean_MPa", std::to_string(errors.mean.stress / 1e6));
  RecordProperty("edge_recovered_MPa", std::to_string(errors.recovered.at_edges / 1e6));
  RecordProperty("edge_mean_MPa", std::to_string(errors.mean.at_edges / 1e6));
}

}  // namespace
}  // namespace mortise::simulator
