// Checks whether a solid that was read says the same of itself everywhere. Private to this folder:
// it brings Open CASCADE.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>

namespace mortise::cad {

// The faults of a solid. Where faces, edges and vertices contradict each other the kernel believes
// each, and takes the distance by which they miss each other for their tolerance. Sizes and volumes
// then depend on whom one asks.
struct Soundness {
  std::string fault;  // why the solid cannot be taken; empty if it can
  std::string note;   // what is not quite right with it, for people; empty if nothing is
};

// Returns what is wrong with a solid. A fault are misses that may change the volume by more than a
// hundredth, and a solid that the kernel finds invalid. A note is due where misses are at least a
// hundred thousandth of the diagonal, and 1 µm. Throws Standard_Failure.
Soundness SoundnessOf(const TopoDS_Shape& solid);

}  // namespace mortise::cad
