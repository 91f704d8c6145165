// Heights on a grid, as surveys and rasters write them.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "mortise/v1/template.pb.h"

namespace mortise::cli {

// Returns the grid that the points of a table of comma-separated values lie on, in its unit: x, y
// and height of each, in any order, under a heading with "x", "y" and "z" or without one. Points of
// the grid that the table does not have are not known. INVALID_ARGUMENT naming each place in
// `origin` that is at fault ("bank.csv: line 7, column 3"), and where the points lie on no grid.
absl::StatusOr<v1::HeightGrid> ParseGroundPoints(std::string_view text, const std::string& origin);

// Returns an ESRI ASCII grid, in its unit: ncols, nrows, xllcorner or xllcenter, yllcorner or
// yllcenter, cellsize and perhaps NODATA_value (-9999), a line each, then the heights at the
// middles of the cells, the northern row first. Likewise.
absl::StatusOr<v1::HeightGrid> ParseEsriGrid(std::string_view text, const std::string& origin);

}  // namespace mortise::cli
