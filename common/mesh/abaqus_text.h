// The text of Abaqus' input files: keywords, fields and numbers; for abaqus_reader.cpp.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mortise::mesh::abaqus {

// Without space round it.
std::string_view Trim(std::string_view text);

// In upper case, by which keywords, parameters and names of sets are told apart.
std::string Upper(std::string_view text);

// The fields between commas, without space round them. A last comma opens no field.
std::vector<std::string_view> Fields(std::string_view line);

// The number that the text is; nothing if it is another text or out of range.
std::optional<std::int64_t> Integer(std::string_view text);

// The number that the text is, also with Fortran's D as exponent; nothing if it is another text.
std::optional<double> Number(std::string_view text);

// What begins with '*'.
struct Keyword {
  std::string name;                               // in upper case, with single spaces
  std::map<std::string, std::string> parameters;  // by names in upper case; without quotes

  bool Has(const std::string& parameter) const { return parameters.contains(parameter); }

  // Empty if the keyword is without the parameter.
  std::string Value(const std::string& parameter) const;
};

// The keyword of a line without its '*' ("Nset, nset=tip, generate"); nothing if it has none of up
// to 40 letters, digits, '-', '_' and spaces.
std::optional<Keyword> ParseKeyword(std::string_view line);

// Whether it changes the mesh in ways that are not read; to leave it out would give another mesh.
bool ChangesMesh(const std::string& keyword);

// Whether it only opens or closes what is read.
bool IsFrame(const std::string& keyword);

}  // namespace mortise::mesh::abaqus
