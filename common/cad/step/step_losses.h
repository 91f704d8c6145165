// Finds what a STEP file has and the kernel made no solid of. Private to this folder: it brings
// Open CASCADE.
#pragma once

#include <STEPCAFControl_Reader.hxx>
#include <TopTools_MapOfShape.hxx>
#include <string>
#include <vector>

namespace mortise::cad {

// Returns the losses by name, for people; it is called once shapes are made. Losses are bodies that
// are open, surfaces and tessellated bodies, bodies that belong to no product, bodies that lost
// faces, and occurrences without a placement or a shape. Of many it names the first, and says how
// many more there are. It leaves out what is held by products and mapped representations whose
// unplaced shapes are in `told`, as nothing of these is a solid.
std::vector<std::string> Losses(STEPCAFControl_Reader& reader, const TopTools_MapOfShape& told);

}  // namespace mortise::cad
