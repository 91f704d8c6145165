#include "tests/bench/services/retrieval/evaluation/shape_sheet.h"

#include <utility>

#include "common/base/errors.h"
#include "services/retrieval/families/match_sheet.h"

namespace mortise::retrieval {
namespace {

constexpr int kWidth = 150, kHeight = 125;  // pixels, of one picture
constexpr render::Color kColors[] = {{0.55, 0.72, 0.52}, {0.78, 0.78, 0.78}, {0.55, 0.68, 0.88}};

}  // namespace

absl::Status ShapeSheet::Add(const mesh::SurfaceMesh& surface, Kind kind,
                             const std::string& caption) {
  MORTISE_ASSIGN_OR_RETURN(render::Image picture,
                           DrawSurface(surface, kColors[static_cast<int>(kind)], kWidth, kHeight));
  pictures_.push_back(std::move(picture));
  captions_.push_back(caption.substr(0, 20));
  return absl::OkStatus();
}

absl::StatusOr<render::Image> ShapeSheet::Draw() const {
  if (pictures_.empty()) return render::Image(kWidth, kHeight, {1, 1, 1});
  return render::ContactSheet(pictures_, captions_, columns_);
}

}  // namespace mortise::retrieval
