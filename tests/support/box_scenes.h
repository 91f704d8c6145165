// Meshes made of boxes, as scenes and as OBJ files.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/mesh/scenes/scene.h"

namespace mortise::testing {

// A closed box, its triangles seen from outside.
inline mesh::SceneComponent Box(std::string name, const Eigen::Vector3d& low,
                                const Eigen::Vector3d& size) {
  mesh::SceneComponent box;
  box.name = std::move(name);
  box.vertices.resize(3, 8);
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      box.vertices(axis, corner) = low[axis] + (((corner >> axis) & 1) != 0 ? size[axis] : 0);
    }
  }
  box.triangles.resize(3, 12);
  box.triangles << 0, 0, 1, 1, 0, 0, 2, 2, 0, 0, 4, 4,  //
      4, 6, 3, 7, 1, 5, 6, 7, 2, 3, 5, 7,               //
      6, 2, 7, 5, 5, 4, 7, 3, 3, 1, 7, 6;
  return box;
}

// The same without its last `count` triangles: those of the upper face, if they are two.
inline mesh::SceneComponent OpenBox(std::string name, const Eigen::Vector3d& low,
                                    const Eigen::Vector3d& size, int count = 2) {
  mesh::SceneComponent box = Box(std::move(name), low, size);
  box.triangles = box.triangles.leftCols(12 - count).eval();
  return box;
}

inline mesh::SceneComponent Moved(mesh::SceneComponent component, const Eigen::Vector3d& by) {
  component.vertices.colwise() += by;
  return component;
}

// All in one component without a name, as most files have it.
inline mesh::Scene OneComponent(const std::vector<mesh::SceneComponent>& components) {
  mesh::Scene scene;
  scene.components = components;
  mesh::Scene joined;
  joined.components = {mesh::Joined(scene)};
  return joined;
}

// A top on four legs, which are open at the top as modellers leave them: 1.2 by 0.7 by 0.74 m.
inline std::vector<mesh::SceneComponent> TableParts() {
  std::vector<mesh::SceneComponent> parts = {Box("top", {0, 0, 0.7}, {1.2, 0.7, 0.04})};
  for (const double x : {0.02, 1.13}) {
    for (const double y : {0.02, 0.63}) {
      parts.push_back(OpenBox("leg", {x, y, 0}, {0.05, 0.05, 0.7}));
    }
  }
  return parts;
}

// An OBJ file; components with names are objects.
inline std::string ObjOf(const mesh::Scene& scene, double scale = 1) {
  std::string text;
  Eigen::Index before = 1;
  for (const mesh::SceneComponent& component : scene.components) {
    if (!component.name.empty()) absl::StrAppend(&text, "o ", component.name, "\n");
    for (const auto& vertex : component.vertices.colwise()) {
      absl::StrAppend(&text, "v ", scale * vertex.x(), " ", scale * vertex.y(), " ",
                      scale * vertex.z(), "\n");
    }
    for (const auto& triangle : component.triangles.colwise()) {
      absl::StrAppend(&text, "f ", before + triangle(0), " ", before + triangle(1), " ",
                      before + triangle(2), "\n");
    }
    before += component.vertices.cols();
  }
  return text;
}

}  // namespace mortise::testing
