// Groups of assemblies, from messages. Private to assembly_codec.cpp.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/assembly/codec/assembly_drawing.h"
#include "common/design/template_validation.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::parametric {

// Reads the hierarchy of a message, whatever is wrong with it. The message and the findings must
// outlive it.
class GroupReader {
 public:
  GroupReader(const v1::Assembly& message, std::vector<FieldViolation>& findings)
      : message_(message), findings_(findings) {}

  // The root first, then parents before children.
  void Read(AssemblyDrawing& drawing);

  // Index of a group of the struct; -1 if there is none of this name, and a finding if the message
  // has none either.
  int Find(const std::string& name, const std::string& field) const;

 private:
  void AddChildren(const std::string& parent, int parent_index, AssemblyDrawing& drawing);
  void CheckReached(int i);

  const v1::Assembly& message_;
  std::vector<FieldViolation>& findings_;
  std::map<std::string, std::vector<int>> children_;  // of the message, by parent's name
  std::map<std::string, int> index_;                  // into the struct, by name
  std::set<std::string> names_;                       // of the message
};

}  // namespace mortise::parametric
