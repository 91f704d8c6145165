// Which mapping brought a design into a mesh: a part of the keys of what builds keep.
#pragma once

namespace mortise::interpolator {

// To be raised with every change by which the same designs come into other meshes, come to lie
// there in another way, or are found to be off by more or less: of this folder, of shapes/ or of
// building/. What a build kept under another version is found out again.
inline constexpr int kMappingVersion = 1;

}  // namespace mortise::interpolator
