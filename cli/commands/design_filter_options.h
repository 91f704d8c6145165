// The flags of `mortise search` that say what the designs it finds must be like.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "cli/client/command_flags.h"
#include "mortise/v1/retrieval.pb.h"

namespace mortise::cli {

struct DesignFilterOptions {
  std::vector<std::string> categories;
  std::string min_size, max_size;  // "1.2 m" along every axis, or "1.2m, 0.6m, 0.8m"
  std::vector<std::string> materials;
  std::string max_price;           // "120", which is EUR, or "120 USD"
  std::vector<std::string> items;  // "board" or "board=4"
  std::vector<std::filesystem::path> item_files;
  std::vector<std::string> item_places = {};  // of the items of those files, once they are read

  // Declares the flags.
  void AddTo(CommandFlags& flags);

  // Says where items come from, once the request is filled: --item, or a place in a file.
  void AddItemSources(FieldSources& sources) const;

  // Puts what the flags say into the request. INVALID_ARGUMENT naming a flag, or a place in a file.
  absl::Status Fill(v1::SearchShapesRequest* request);
};

}  // namespace mortise::cli
