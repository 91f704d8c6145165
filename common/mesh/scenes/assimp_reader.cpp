#include "common/mesh/scenes/assimp_reader.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <assimp/DefaultLogger.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "common/mesh/scenes/cleaning/text_lines.h"
#include "common/mesh/scenes/mesh_components.h"
#include "common/mesh/surface_check.h"

namespace mortise::mesh {
namespace {

// What libassimp logs where it reads on although something is not there.
constexpr std::array<const char*, 3> kLosses = {"out-of-range indices", "out of range",
                                                "property instance"};

// Keeps the first complaint that means a loss.
class LossLog : public Assimp::Logger {
 public:
  explicit LossLog(std::string& loss) : loss_(loss) {}
  bool attachStream(Assimp::LogStream*, unsigned int) override { return false; }
  bool detachStream(Assimp::LogStream*, unsigned int) override { return false; }

 protected:
  void OnDebug(const char*) override {}
  void OnVerboseDebug(const char*) override {}
  void OnInfo(const char*) override {}
  void OnWarn(const char* message) override { Keep(message); }
  void OnError(const char* message) override { Keep(message); }

 private:
  void Keep(const char* message) {
    for (const char* loss : kLosses) {
      if (loss_.empty() && absl::StrContains(message, loss)) loss_ = message;
    }
  }

  std::string& loss_;
};

// Has libassimp log to `loss` while this object lives.
class LogScope {
 public:
  explicit LogScope(std::string& loss) {
    Assimp::DefaultLogger::set(std::make_unique<LossLog>(loss).release());  // which takes it over
  }
  ~LogScope() { Assimp::DefaultLogger::set(nullptr); }
  LogScope(const LogScope&) = delete;
  LogScope& operator=(const LogScope&) = delete;
};

absl::Status Failure(const Assimp::Importer& importer) {
  try {
    if (importer.GetException() != std::exception_ptr()) {
      std::rethrow_exception(importer.GetException());
    }
  } catch (const std::bad_alloc&) {
    return TooLarge("file", "what can be read in the memory there is");
  } catch (const std::exception&) {
  }
  return InvalidField("file", absl::StrCat("is damaged: ", importer.GetErrorString()));
}

// ---- From libassimp's nodes to components -------------------------------------------------------

Eigen::Matrix4d ToEigen(const aiMatrix4x4& matrix) {
  Eigen::Matrix4d copy;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      copy(row, column) = static_cast<double>(matrix[row][column]);
    }
  }
  return copy;
}

// Collects the components of a scene, and counts what is left out of them.
class ComponentCollector {
 public:
  explicit ComponentCollector(const std::vector<std::string>& names) : names_(names) {}

  // Adds all that is in a node and below it. Without recursion, as nodes may lie deep.
  absl::Status Collect(const aiScene& scene) {
    std::vector<std::pair<const aiNode*, Eigen::Matrix4d>> waiting;
    waiting.emplace_back(scene.mRootNode, Eigen::Matrix4d::Identity());
    while (!waiting.empty()) {
      const auto [node, above] = waiting.back();
      waiting.pop_back();
      const Eigen::Matrix4d transform = above * ToEigen(node->mTransformation);
      if (node->mNumMeshes > 0) MORTISE_RETURN_IF_ERROR(AddNode(scene, *node, transform));
      for (unsigned i = node->mNumChildren; i-- > 0;) {
        waiting.emplace_back(node->mChildren[i], transform);
      }
    }
    if (not_finite_ > 0) {
      return InvalidField(
          "file", absl::StrCat("has corners of triangles whose coordinates are not finite: ",
                               not_finite_, ", the first in ", not_finite_place_));
    }
    return absl::OkStatus();
  }

  Scene Finish(std::int64_t polygons) && {
    const auto note = [&](std::int64_t count, const char* what) {
      if (count > 0) scene_.notes.push_back(absl::StrCat(what, ": ", count, "."));
    };
    note(polygons, "Faces of more than three corners, divided into triangles");
    note(degenerate_, "Triangles without area, left out");
    return std::move(scene_);
  }

 private:
  absl::Status AddNode(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& transform) {
    Eigen::Index corners = 0;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        if (mesh.mFaces[f].mNumIndices == 3) corners += 3;
      }
    }
    triangles_ += corners / 3;
    if (triangles_ > kMaxSceneTriangles) return TooLarge("file", "2,000,000 triangles");
    Eigen::Matrix3Xd points(3, corners);
    Eigen::Index next = 0;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      AddCorners(*scene.mMeshes[node.mMeshes[m]], transform, points, next);
    }
    SceneComponent component;
    component.name = NameOf(node);
    for (Eigen::Index i = 0; i < corners; ++i) {
      if (points.col(i).allFinite()) continue;
      if (not_finite_++ == 0) {
        not_finite_place_ = absl::StrCat("triangle ", i / 3 + 1, " of ",
                                         component.name.empty() ? "the file" : component.name);
      }
    }
    if (not_finite_ > 0) return absl::OkStatus();
    // A transform that mirrors turns triangles inside out.
    SetTriangles(points, transform.topLeftCorner<3, 3>().determinant() < 0, component);
    if (component.triangles.cols() > 0) scene_.components.push_back(std::move(component));
    return absl::OkStatus();
  }

  void AddCorners(const aiMesh& mesh, const Eigen::Matrix4d& transform, Eigen::Matrix3Xd& points,
                  Eigen::Index& next) const {
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      for (unsigned k = 0; k < 3; ++k) {
        const aiVector3D& at = mesh.mVertices[face.mIndices[k]];
        points.col(next++) = transform.topLeftCorner<3, 3>() * Eigen::Vector3d(at.x, at.y, at.z) +
                             transform.topRightCorner<3, 1>();
      }
    }
  }

  // Gives corners at one place one vertex.
  void SetTriangles(const Eigen::Matrix3Xd& corners, bool is_mirrored, SceneComponent& component) {
    const Eigen::VectorXi place = WeldPoints(corners);
    std::vector<int> vertex_of(
        corners.cols() == 0 ? 0 : static_cast<std::size_t>(place.maxCoeff()) + 1, -1);
    std::vector<Eigen::Index> vertices, triangles;
    for (Eigen::Index t = 0; t < corners.cols(); t += 3) {
      if (IsDegenerate(corners.col(t), corners.col(t + 1), corners.col(t + 2))) {
        ++degenerate_;
        continue;
      }
      triangles.push_back(t);
      for (Eigen::Index k = t; k < t + 3; ++k) {
        int& vertex = vertex_of[static_cast<std::size_t>(place(k))];
        if (vertex >= 0) continue;
        vertex = static_cast<int>(vertices.size());
        vertices.push_back(k);
      }
    }
    component.vertices = corners(Eigen::all, vertices);
    component.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const int corner = is_mirrored ? 2 - k : k;
        component.triangles(corner, static_cast<Eigen::Index>(i)) =
            vertex_of[static_cast<std::size_t>(place(triangles[i] + k))];
      }
    }
  }

  // The cleaned file calls its objects "c" and a number.
  std::string NameOf(const aiNode& node) const {
    const std::string_view name(node.mName.data, node.mName.length);
    if (!name.starts_with('c')) return "";
    const auto number = WholeNumber<std::size_t>(name.substr(1));
    return number && *number < names_.size() ? names_[*number] : "";
  }

  const std::vector<std::string>& names_;
  Scene scene_;
  std::int64_t triangles_ = 0;
  std::int64_t degenerate_ = 0;
  std::int64_t not_finite_ = 0;
  std::string not_finite_place_;
};

// Checks the faces before libassimp triangulates them, and counts those of more than three corners.
absl::StatusOr<std::int64_t> CountPolygons(const aiScene& scene) {
  std::int64_t polygons = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices > 3) ++polygons;
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        if (face.mIndices[k] < mesh.mNumVertices) continue;
        return InvalidField(
            "file", absl::StrCat("is damaged: face ", f + 1, " names vertex ", face.mIndices[k],
                                 ", counted from 0, of ", mesh.mNumVertices));
      }
    }
  }
  return polygons;
}

}  // namespace

absl::StatusOr<Scene> ReadByAssimp(const CleanedFile& file) {
  std::string loss;
  const LogScope log(loss);
  Assimp::Importer importer;
  // Serves this file alone, so that none can have another opened. The importer takes it over.
  importer.SetIOHandler(
      std::make_unique<Assimp::MemoryIOSystem>(
          reinterpret_cast<const std::uint8_t*>(file.bytes.data()), file.bytes.size(), nullptr)
          .release());
  const std::string name = absl::StrCat(AI_MEMORYIO_MAGIC_FILENAME, ".", file.extension);
  const aiScene* scene = importer.ReadFile(name, 0);
  if (scene == nullptr || scene->mRootNode == nullptr) return Failure(importer);
  if (!loss.empty()) return InvalidField("file", absl::StrCat("is damaged: ", loss));
  MORTISE_ASSIGN_OR_RETURN(const std::int64_t polygons, CountPolygons(*scene));
  if (polygons > 0) {
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    if (scene == nullptr) return Failure(importer);
  }
  ComponentCollector collector(file.names);
  MORTISE_RETURN_IF_ERROR(collector.Collect(*scene));
  return std::move(collector).Finish(polygons);
}

}  // namespace mortise::mesh
