// What on the command line gave the fields of a request. Services name their fields; a person at a
// terminal wants the flag.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"

namespace mortise::cli {

class FieldSources {
 public:
  // `field` ("rules.kerf"), and all that is in it, was given by `source` ("--kerf").
  void Add(std::string field, std::string source);

  // The elements of a repeated field were given by repeated flags of the form NAME=VALUE or NAME:
  // "parameters[0]" by "--set length". `first` elements have come from elsewhere; if none have,
  // what is wrong with all of them is wrong with the flag.
  void AddEach(const std::string& field, const std::string& flag,
               const std::vector<std::string>& values, int first = 0);

  // What is in `field` was read from a file: "specification.seed" is "spec.json: seed". Fields
  // that are added by themselves were not.
  void AddFile(std::string field, std::string file);

  // The same failure, where its field has a source with that in the field's place. The longest
  // field that was added counts. What is wrong with several fields of one source is said once.
  absl::Status Name(const absl::Status& status) const;

 private:
  struct Source {
    std::string field;
    std::string text;
    bool is_file = false;
  };

  // Returns the source of a field; the field itself if it has none.
  std::string SourceOf(std::string_view field) const;

  std::vector<Source> sources_;
};

}  // namespace mortise::cli
