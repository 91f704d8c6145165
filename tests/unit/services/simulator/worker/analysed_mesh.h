// Meshes as they are uploaded, analysed as the simulator's workers do.
#pragma once

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_replace.h"
#include "common/base/errors.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/analysis/mesh_analysis.h"
#include "services/simulator/worker/mesh_case.h"
#include "services/simulator/worker/mesh_model.h"
#include "tests/support/mesh_files.h"

namespace mortise::simulator {

// What STEEL stands for in cases.
inline constexpr char kSteel[] =
    R"({"values": {"density": 7800, "youngs_modulus": 2.1e11, "poissons_ratio": 0.3,
        "strength": 2.5e8, "thermal_expansion": 1.2e-5, "thermal_conductivity": 50}})";

// A case of JSON.
inline v1::MeshCase Case(const std::string& json) {
  v1::MeshCase mesh_case;
  const auto status = google::protobuf::util::JsonStringToMessage(
      absl::StrReplaceAll(json, {{"STEEL", kSteel}}), &mesh_case);
  EXPECT_TRUE(status.ok()) << status.message();
  return mesh_case;
}

// What an analysis tells, and the files it writes.
struct Analysed {
  absl::StatusOr<MeshAnalysis> analysis = absl::UnknownError("not run");
  std::map<std::string, std::string> files;
};

inline Analysed Analyse(const mesh::GroupedMesh& mesh, const v1::MeshCase& mesh_case,
                        const MeshAnalysisOptions& options = {.pictures = false}) {
  Analysed analysed;
  analysed.analysis = [&]() -> absl::StatusOr<MeshAnalysis> {
    MORTISE_RETURN_IF_ERROR(CheckMeshCase(mesh_case, "case"));
    MORTISE_ASSIGN_OR_RETURN(const MeshModel model, MakeMeshModel(mesh, mesh_case));
    return AnalyzeMesh(model, options, [&](AnalysisFile file) {
      analysed.files[file.name] = std::move(file.bytes);
      return absl::OkStatus();
    });
  }();
  return analysed;
}

// In millimetres: 2 × 1 × 1 m.
inline mesh::GroupedMesh Box(bool quadratic, const Eigen::Vector3i& cells = {4, 2, 2}) {
  return testing::GroupedBox({2000, 1000, 1000}, cells, quadratic);
}

// A case of such a box that can be analysed.
inline constexpr char kGoodCase[] = R"({
  "length_unit": "mm", "materials": [{"groups": ["low", "high"], "values": {"density": 7800,
    "youngs_modulus": 2e11, "poissons_ratio": 0.3}}],
  "supports": [{"groups": ["x_min"], "fixed": true}],
  "load_cases": [{"name": "pull", "forces": [{"groups": ["x_max"], "force": {"x": 1}}]}]})";

}  // namespace mortise::simulator
