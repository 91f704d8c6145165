// Evaluations that nobody wants any more.
#include "common/fem/linear/stopping.h"

#include <gtest/gtest.h>

#include <numeric>

#include "services/simulator/analysis/mesh_analysis.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

// Three load cases on a clamped bar, and its vibration.
MeshModel PulledBar() {
  MeshModel model;
  model.mesh = BoxMesh({1, 0.1, 0.1}, {10, 2, 2}, false);
  model.node_numbers.resize(static_cast<std::size_t>(model.mesh.nodes.cols()));
  std::iota(model.node_numbers.begin(), model.node_numbers.end(), 1);
  model.materials = {Steel()};
  model.supports = {{{0, "u_min"}}};
  model.support_nodes = {{0}};
  for (const char* name : {"first", "second", "third"}) {
    LoadCase loads;
    loads.forces = {{{0, "u_max"}, {0, 0, -100}}};
    model.load_cases.push_back({name, loads});
  }
  model.modes = 1;
  return model;
}

TEST(Stopping, AnAnalysisEndsBeforeItsNextFile) {
  const MeshModel model = PulledBar();
  std::stop_source stop;
  int files = 0;
  const auto analysis =
      AnalyzeMesh(model, {.pictures = false, .stop = stop.get_token()}, [&](const AnalysisFile&) {
        if (++files == 2) stop.request_stop();
        return absl::OkStatus();
      });
  EXPECT_EQ(analysis.status().code(), absl::StatusCode::kCancelled) << analysis.status();
  EXPECT_EQ(files, 2);
}

TEST(Stopping, AnAnalysisEndsBeforeItSolves) {
  std::stop_source stop;
  stop.request_stop();
  const auto analysis =
      AnalyzeMesh(PulledBar(), {.stop = stop.get_token()}, [](const AnalysisFile&) {
        ADD_FAILURE() << "nothing is computed";
        return absl::OkStatus();
      });
  EXPECT_EQ(analysis.status().code(), absl::StatusCode::kCancelled) << analysis.status();
}

TEST(Stopping, OneThatNobodyStopsGoesToItsEnd) {
  std::stop_source stop;
  int files = 0;
  const auto analysis = AnalyzeMesh(PulledBar(), {.pictures = false, .stop = stop.get_token()},
                                    [&](const AnalysisFile&) {
                                      ++files;
                                      return absl::OkStatus();
                                    });
  ASSERT_TRUE(analysis.ok()) << analysis.status();
  EXPECT_EQ(files, 4);
}

}  // namespace
}  // namespace mortise::simulator
