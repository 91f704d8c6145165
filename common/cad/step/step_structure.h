// Checks a STEP file before its shapes are made. Private to this folder: it brings Open CASCADE.
#pragma once

#include <STEPCAFControl_Reader.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepData_StepModel.hxx>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace mortise::cad {

inline constexpr int kMaxStepParts = 2000;  // as many as an assembly may have

// Returns the name of the product that is defined, or else its id; empty if it has neither.
std::string ProductName(const Handle(StepBasic_ProductDefinition) & definition);

// Returns what entities of the file are wrong, "#12: …", the first 20 of them, and how many more
// there are; or, if there are any of types that the kernel does not know, which types. The kernel
// may read the rest, or fall over them.
std::vector<std::string> EntityFaults(STEPCAFControl_Reader& reader);

// Makes the kernel keep names in which nothing is ASCII, such as "棚": it takes them for empty and
// looks at the id instead, so the id becomes the name.
void KeepNames(const Handle(StepData_StepModel) & model);

// Fails with INVALID_ARGUMENT, "step", for products or representations that contain themselves,
// naming them, and for parts that are in other files. RESOURCE_EXHAUSTED for sub-assemblies of
// sub-assemblies that make more than kMaxStepParts parts.
absl::Status CheckStructure(STEPCAFControl_Reader& reader);

}  // namespace mortise::cad
