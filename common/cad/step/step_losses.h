// What a STEP file has and the kernel made no solid of. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <STEPCAFControl_Reader.hxx>
#include <TopTools_MapOfShape.hxx>
#include <string>
#include <vector>

namespace mortise::cad {

// Once shapes are made, for people, by name: bodies that are open, surfaces and tessellated bodies,
// bodies that belong to no product, bodies that lost faces, and occurrences without a placement or
// a shape; of many the first, and how many more there are. Not of what products and mapped
// representations hold whose unplaced shapes are in `told`, as nothing of these is a solid.
std::vector<std::string> Losses(STEPCAFControl_Reader& reader, const TopTools_MapOfShape& told);

}  // namespace mortise::cad
