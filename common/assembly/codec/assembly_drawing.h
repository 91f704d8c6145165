// An assembly while its message is read, and where parts of it come from. Private to the files that
// read assemblies.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/design/template_validation.h"
#include "mortise/v1/types.pb.h"

namespace mortise::parametric {

inline constexpr std::size_t kMaxAssemblyParts = 2000;

// Where parts of the struct come from in the message, for the places of findings.
struct AssemblyDrawing {
  Assembly assembly;
  std::vector<std::string> part_fields;  // of each part: "parts[3]"
  std::vector<int> group_messages;       // of each group but the root, index into the message
};

// Of parts, groups, joints and planes: 1 to 63 bytes of text in one line.
void CheckAssemblyName(const std::string& field, const std::string& name,
                       std::vector<FieldViolation>& findings);

}  // namespace mortise::parametric
