// What somebody has to build from, as a table that people write.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "mortise/v1/retrieval.pb.h"

namespace mortise::cli {

// Returns a table of comma-separated values with a column "item" (or "name", as tables of items
// have), and one "quantity": pieces as sold, empty for as many as it takes. Case and blanks of
// headings do not count; names may lack "items/"; lines of one item are added up. Other columns are
// not looked at, but a table may only be without "quantity" where it has nothing but names and
// titles, or is one of items, with their kinds: else the quantities would be under another heading.
// The bill of materials of a plan is such a table; its totals are left out. `places`, one for each
// item, is where its first line has it. INVALID_ARGUMENT naming each place in `origin` that is at
// fault: "stock.csv: line 3, column 2".
absl::StatusOr<std::vector<v1::AvailableItem>> ParseAvailableItems(
    std::string_view text, const std::string& origin, std::vector<std::string>* places = nullptr);

// The same of a file. As ReadFile.
absl::StatusOr<std::vector<v1::AvailableItem>> ReadAvailableItems(
    const std::filesystem::path& path, std::vector<std::string>* places = nullptr);

// Adds what another table has to `items` and `places`: quantities of one item are added up.
void AddAvailable(std::vector<v1::AvailableItem> more, const std::vector<std::string>& more_places,
                  std::vector<v1::AvailableItem>* items, std::vector<std::string>* places);

// "board-27x95" or "board-27x95=4". INVALID_ARGUMENT naming "--item board-27x95" for what is no
// number.
absl::StatusOr<v1::AvailableItem> ParseAvailableItem(const std::string& text);

}  // namespace mortise::cli
