// Measures how much room fillets and chamfers have on the faces beside their edges. Private to this
// folder: it brings Open CASCADE's headers.
//
// A blend takes a strip off both faces. Where no other edge reaches into the strips, and no edge
// beside it ends within them, the kernel only has to replace two edges by a face. Else it has to
// find how the blend runs into other faces, and over some of these (a bore just as deep as the
// strip is wide) it reads memory that is not its own and ends the process.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Shape.hxx>
#include <limits>
#include <vector>

namespace mortise::cad {

enum class BlendKind { kFillet, kChamfer };

struct BlendRoom {
  // The radius or distance whose strips just reach another edge, mm; infinite where none is within
  // the limit, 0 where it cannot be told (more than three edges meet, faces meet at a sharp point).
  double size = std::numeric_limits<double>::infinity();
  std::size_t edge = 0;  // index of the edge that has the least
};

// Returns the room along `edges` of `shape`, as far as it is less than `limit`, mm. Edges that
// continue each other smoothly are one to the kernel: all of them should be given.
BlendRoom RoomBeside(const TopoDS_Shape& shape, const std::vector<TopoDS_Edge>& edges,
                     BlendKind kind, double limit);

}  // namespace mortise::cad
