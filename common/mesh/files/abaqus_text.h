// Splits the text of Abaqus' input files into keywords, fields and numbers; for abaqus_reader.cpp.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mortise::mesh::abaqus {

// Returns the text without space round it.
std::string_view Trim(std::string_view text);

// Returns the text in upper case, by which keywords, parameters and names of sets are told apart.
std::string Upper(std::string_view text);

// Returns the fields between commas, without space round them. A last comma opens no field.
std::vector<std::string_view> Fields(std::string_view line);

// Returns the number that the text is; nothing if it is another text or out of range.
std::optional<std::int64_t> Integer(std::string_view text);

// Returns the number that the text is, also with Fortran's D as exponent; nothing if it is another
// text.
std::optional<double> Number(std::string_view text);

// A line that begins with '*'.
struct Keyword {
  std::string name;                               // in upper case, with single spaces
  std::map<std::string, std::string> parameters;  // by names in upper case; without quotes
  std::string repeated;                           // a parameter that is given twice; or empty

  bool Has(const std::string& parameter) const { return parameters.contains(parameter); }

  // Returns the value of a parameter; empty if the keyword is without it.
  std::string Value(const std::string& parameter) const;
};

// Returns the keyword of a line without its '*' ("Nset, nset=tip, generate"); nothing if it has
// none of up to 40 letters, digits, '-', '_' and spaces.
std::optional<Keyword> ParseKeyword(std::string_view line);

// Says how a line stands to the keyword before it, if that ended in a comma. Abaqus takes any line
// for more of the keyword then; people leave a comma behind and go on with data.
enum class Following : std::uint8_t { kParameters, kData };

// Parameters are commas alone, "NAME=…" and the flags that `keyword` has; all else is data. Text
// that is neither is refused where data is read, so that nothing is lost. `line` has no space round
// it, and is no comment.
Following WhatFollows(const Keyword& keyword, std::string_view line);

// Returns why the keyword, one of those that are read, cannot be read: a parameter that is not
// known, that takes from another file, that changes what is meant, or that is there twice. Returns
// nothing if it can.
std::string UnreadParameter(const Keyword& keyword);

// Whether the keyword changes the mesh in ways that are not read; to leave it out would give
// another mesh.
bool ChangesMesh(const std::string& keyword);

// Whether the keyword only opens or closes what is read.
bool IsFrame(const std::string& keyword);

// Whether no lines of data can follow the keyword.
bool HasNoData(const std::string& keyword);

}  // namespace mortise::mesh::abaqus
