// Parts of assemblies, from messages. Private to assembly_codec.cpp.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/codec/assembly_drawing.h"
#include "common/assembly/codec/group_reader.h"
#include "common/assembly/codec/shape_reader.h"
#include "common/design/template_definition.h"
#include "common/design/template_validation.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::parametric {

// Reads parts one after the other: rows and grids one by one, size limits from the items. Whatever
// it is given must outlive it.
class PartReader {
 public:
  PartReader(const std::vector<Item>& items, const ShapesByName& shapes, const GroupReader& groups,
             std::vector<FieldViolation>& findings)
      : items_(items), shapes_(shapes, findings), groups_(groups), findings_(findings) {}

  // Adds the parts that a message of `field` ("parts[3]") stands for, as far as it can be read.
  void Read(const v1::AssemblyPart& message, const std::string& field, AssemblyDrawing& drawing);

 private:
  // What the name of each of a row's parts ends with, and where it stands against the first.
  using Places = std::vector<std::pair<std::string, Eigen::Vector3d>>;

  // What can be read of them, and findings about the rest.
  static Places Repetitions(const v1::AssemblyPart& part, const std::string& field,
                            std::vector<FieldViolation>& findings);

  void ReadPlanes(const v1::AssemblyPart& message, const std::string& field, AssemblyPart& part);
  void ReadColor(const v1::Vector3& color, const std::string& field, AssemblyPart& part);

  // Of two parts of one name that both are complete, ValidateAssembly tells.
  void CheckIncomplete(const std::string& name, const std::string& field, bool complete);

  void AddAll(const v1::AssemblyPart& message, const std::string& field, const AssemblyPart& first,
              const Eigen::Vector3d& size, const Places& places, AssemblyDrawing& drawing);

  const std::vector<Item>& items_;
  ShapeReader shapes_;
  const GroupReader& groups_;
  std::vector<FieldViolation>& findings_;
  bool full_ = false;                     // and that has been said
  std::map<std::string, bool> complete_;  // of each part's name, whether all parts so called are
};

}  // namespace mortise::parametric
