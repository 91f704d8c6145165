// What a shape is called. Target mortise_template_codec.
#pragma once

#include <string>

namespace mortise::v1 {
class Shape;
}

namespace mortise::parametric {

// Returns what a shape is called by its content: shapes/{digest}. Its own name does not count.
std::string NameOf(v1::Shape message);

}  // namespace mortise::parametric
