// A small cage template as text, for tests of cage templates.
#pragma once

#include <string>

namespace mortise::parametric {

// A box of 100 x 100 x 100 mm in a cage of 200 x 200 x 200 mm, both upon z = 0. The map is affine:
// the box is width / 2 wide, height / 2 high, and its top is shifted by lean / 2.
inline const char* const kBlock = R"(
name: "templates/block"
material: "materials/beech"
parameters { name: "width" unit: "m" minimum: 0.1 maximum: 0.4 default_value: 0.2 }
parameters { name: "height" unit: "m" minimum: 0.1 maximum: 0.3 default_value: 0.2 }
parameters { name: "lean" unit: "m" minimum: -0.1 maximum: 0.1 default_value: 0.0 }
definitions { name: "half" value: "width / 2" }
definitions { name: "right" value: "half + lean" }
definitions { name: "left" value: "lean - half" }
surface {
  vertices: [-0.05, -0.05, 0,  0.05, -0.05, 0,  0.05, 0.05, 0,  -0.05, 0.05, 0,
             -0.05, -0.05, 0.1,  0.05, -0.05, 0.1,  0.05, 0.05, 0.1,  -0.05, 0.05, 0.1]
  faces { name: "bottom" triangles: [0, 2, 1,  0, 3, 2] }
  faces { name: "top" triangles: [4, 5, 6,  4, 6, 7] }
  faces { name: "sides" triangles: [0, 1, 5,  0, 5, 4,  1, 2, 6,  1, 6, 5,
                                    2, 3, 7,  2, 7, 6,  3, 0, 4,  3, 4, 7] }
}
cage {
  vertices { x: "-half" y: "-0.1" }
  vertices { x: "half" y: "-0.1" }
  vertices { x: "half" y: "0.1" }
  vertices { x: "-half" y: "0.1" }
  vertices { x: "left" y: "-0.1" z: "height" }
  vertices { x: "right" y: "-0.1" z: "height" }
  vertices { x: "right" y: "0.1" z: "height" }
  vertices { x: "left" y: "0.1" z: "height" }
  triangles: [0, 2, 1,  0, 3, 2,  4, 5, 6,  4, 6, 7,  0, 1, 5,  0, 5, 4,
              1, 2, 6,  1, 6, 5,  2, 3, 7,  2, 7, 6,  3, 0, 4,  3, 4, 7]
}
conditions { name: "held" fixed { faces: "bottom" } }
conditions { name: "pull" force { faces: "top" force { x: "100 * lean" z: "5" } } }
conditions { name: "wind" pressure { faces: "sides" faces: "top" pressure: "1000 * height" } }
conditions { name: "sun" heat { faces: "top" flux: "800" } }
conditions { name: "cold" heat { faces: "bottom" temperature: "280 + 10 * half" } }
)";

// The text with the first `from` in it replaced; `from` must be in it.
inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? "'" + from + "' is not in the text"
                                 : text.replace(at, from.size(), to);
}

}  // namespace mortise::parametric
