// Large assemblies made of those that ship, standing side by side: each is a group.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::parametric {

// Adds an assembly to another, as a group of its root called `name`, shifted by so much, m. Names
// of parts, groups and joints begin with that name.
inline void AddShifted(const Assembly& added, const std::string& name, const Eigen::Vector3d& shift,
                       Assembly* to) {
  const int root = static_cast<int>(to->groups.size());
  for (const AssemblyGroup& group : added.groups) {
    to->groups.push_back({group.parent < 0 ? name : name + " " + group.name,
                          group.parent < 0 ? 0 : root + group.parent});
  }
  for (AssemblyPart part : added.parts) {
    part.name = name + " " + part.name;
    part.group += root;
    part.box.minimum += shift;
    part.box.maximum += shift;
    for (ProminentPlane& plane : part.prominent_planes) {
      plane.position += shift[static_cast<int>(plane.axis)];
    }
    to->parts.push_back(std::move(part));
  }
  for (Joint joint : added.joints) {
    joint.name = name + " " + joint.name;
    joint.group += root;
    joint.center += shift;
    to->joints.push_back(std::move(joint));
  }
}

inline BoundingBox BoxAroundAll(const Assembly& assembly) {
  BoundingBox box = assembly.parts.front().box;
  for (const AssemblyPart& part : assembly.parts) {
    box.minimum = box.minimum.cwiseMin(part.box.minimum);
    box.maximum = box.maximum.cwiseMax(part.box.maximum);
  }
  return box;
}

// Returns designs that ship side by side along x, each against the one before it and all with their
// backs in one plane, on the floor.
inline Assembly SideBySide(const std::vector<std::string>& ids) {
  Assembly all;
  all.name = "side by side";
  all.groups = {{"side by side", -1}};
  double x = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Assembly one = ReadShippedAssembly(ids[i]).value();
    const BoundingBox box = BoxAroundAll(one);
    const Eigen::Vector3d corner(box.minimum.x(), box.maximum.y(), box.minimum.z());
    AddShifted(one, std::to_string(i) + " " + ids[i], Eigen::Vector3d(x, 0, 0) - corner, &all);
    x += box.size().x();
  }
  return all;
}

}  // namespace mortise::parametric
