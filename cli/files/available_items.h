// What somebody has to build from, as a table that people write.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/retrieval.pb.h"

namespace mortise::cli {

// A table of comma-separated values with a column "item" (or "name", as tables of items have), and
// perhaps one "quantity": pieces as sold, empty for as many as it takes. Other columns are not
// looked at; names may lack "items/". INVALID_ARGUMENT naming each place in `origin` that is at
// fault: "stock.csv: line 3, column 2".
absl::StatusOr<std::vector<v1::AvailableItem>> ParseAvailableItems(std::string_view text,
                                                                   const std::string& origin);

// The same of a file. As ReadFile.
absl::StatusOr<std::vector<v1::AvailableItem>> ReadAvailableItems(
    const std::filesystem::path& path);

// "board-27x95" or "board-27x95=4". INVALID_ARGUMENT naming "--item board-27x95" for what is no
// number.
absl::StatusOr<v1::AvailableItem> ParseAvailableItem(const std::string& text);

}  // namespace mortise::cli
