#include "cli/commands/design_filter_options.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "cli/client/requests.h"
#include "cli/files/available_items.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

// "1.2m, 600mm, 0.8" along x, y and z, where 0 is any; one length alone is that of all axes.
absl::StatusOr<v1::Vector3> SizeOf(const std::string& text, const std::string& flag) {
  const std::vector<std::string> pieces = absl::StrSplit(text, ',');
  if (pieces.size() != 1 && pieces.size() != 3) {
    return InvalidField(flag, absl::StrCat("'", text, "' is neither a length nor X, Y, Z"));
  }
  std::vector<double> lengths;
  for (const std::string& piece : pieces) {
    const std::string length(absl::StripAsciiWhitespace(piece));
    MORTISE_ASSIGN_OR_RETURN(lengths.emplace_back(), ParseLength(length, flag));
  }
  lengths.resize(3, lengths.front());
  v1::Vector3 size;
  size.set_x(lengths[0]);
  size.set_y(lengths[1]);
  size.set_z(lengths[2]);
  return size;
}

absl::StatusOr<v1::Money> PriceOf(const std::string& text) {
  const std::size_t end = text.find_first_not_of("0123456789.");
  v1::Money price;
  double amount = 0;
  if (!absl::SimpleAtod(text.substr(0, end), &amount)) {
    return InvalidField("--max-price",
                        absl::StrCat("'", text, "' is no price: such as 120, or '120 USD'"));
  }
  price.set_amount(amount);
  std::string currency = end == std::string::npos ? "" : text.substr(end);
  absl::StripAsciiWhitespace(&currency);
  price.set_currency(currency.empty() ? "EUR" : currency);
  return price;
}

}  // namespace

void DesignFilterOptions::AddTo(CommandFlags& flags) {
  const std::string group = "What matches are like";
  flags.Add("--category", categories, "Only of this category; may be repeated", "categories")
      ->allow_extra_args(false)
      ->group(group);
  flags
      .Add("--min-size", min_size, "At least so large: \"0.3 m\", or \"X, Y, Z\"",
           "design_filter.min_size")
      ->group(group);
  flags
      .Add("--max-size", max_size, "At most so large: \"1.2 m\", or \"X, Y, Z\"",
           "design_filter.max_size")
      ->group(group);
  flags
      .Add("--material", materials, "Made of this material; of one of those repeated",
           "design_filter.materials")
      ->allow_extra_args(false)
      ->group(group);
  flags
      .Add("--max-price", max_price, "Material costs at most: 120 (EUR), or \"120 USD\"",
           "design_filter.max_price")
      ->group(group);
  flags.Add("--item", items, "Can be built from this item: NAME or NAME=PIECES; may be repeated")
      ->allow_extra_args(false)
      ->group(group);
  flags
      .Add("--from-items", item_files,
           "Can be built from these: a table (.csv) of item and quantity")
      ->allow_extra_args(false)
      ->group(group);
}

void DesignFilterOptions::AddItemSources(FieldSources& sources) const {
  sources.AddEach("design_filter.items", items.empty() ? "--from-items" : "--item", items);
  for (std::size_t i = 0; i < item_places.size(); ++i) {
    sources.Add(absl::StrCat("design_filter.items[", items.size() + i, "]"), item_places[i]);
  }
}

absl::Status DesignFilterOptions::Fill(v1::SearchShapesRequest* request) {
  for (const std::string& each : categories) request->add_categories(each);
  v1::DesignFilter filter;
  if (!min_size.empty()) {
    MORTISE_ASSIGN_OR_RETURN(*filter.mutable_min_size(), SizeOf(min_size, "--min-size"));
  }
  if (!max_size.empty()) {
    MORTISE_ASSIGN_OR_RETURN(*filter.mutable_max_size(), SizeOf(max_size, "--max-size"));
  }
  for (const std::string& each : materials) {
    filter.add_materials(ResourceName("materials", each));
  }
  if (!max_price.empty()) {
    MORTISE_ASSIGN_OR_RETURN(*filter.mutable_max_price(), PriceOf(max_price));
  }
  for (const std::string& each : items) {
    MORTISE_ASSIGN_OR_RETURN(*filter.add_items(), ParseAvailableItem(each));
  }
  std::vector<v1::AvailableItem> of_tables;
  for (const std::filesystem::path& path : item_files) {
    std::vector<std::string> places;
    MORTISE_ASSIGN_OR_RETURN(std::vector<v1::AvailableItem> read,
                             ReadAvailableItems(path, &places));
    if (read.empty()) {
      return InvalidField("--from-items", absl::StrCat(path.string(), " has no items"));
    }
    AddAvailable(std::move(read), places, &of_tables, &item_places);
  }
  for (v1::AvailableItem& each : of_tables) *filter.add_items() = std::move(each);
  if (filter.ByteSizeLong() > 0) *request->mutable_design_filter() = std::move(filter);
  return absl::OkStatus();
}

}  // namespace mortise::cli
