// Whether a solid that was read says the same of itself everywhere. Private to this folder: it
// brings Open CASCADE.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>

namespace mortise::cad {

// Where faces, edges and vertices contradict each other the kernel believes each, and calls what
// they miss each other by their tolerance. Sizes and volumes then depend on whom one asks.
struct Soundness {
  std::string fault;  // why the solid cannot be taken; empty if it can
  std::string note;   // what is not quite right with it, for people; empty if nothing is
};

// A fault are misses that may change the volume by more than a hundredth, and a solid that the
// kernel finds invalid; a note is due from a hundred thousandth of the diagonal, and 1 µm. Throws
// Standard_Failure.
Soundness SoundnessOf(const TopoDS_Shape& solid);

}  // namespace mortise::cad
