// What a STEP file has and the kernel made no solid of. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <STEPCAFControl_Reader.hxx>
#include <set>
#include <string>
#include <vector>

namespace mortise::cad {

// Once shapes are made, for people, by name: bodies that are open, surfaces and tessellated bodies,
// bodies that belong to no product, bodies that lost faces, and occurrences without a placement or
// a shape. Not of products in `told`, of which nothing is a solid.
std::vector<std::string> Losses(STEPCAFControl_Reader& reader, const std::set<std::string>& told);

}  // namespace mortise::cad
