// Numbers as a page carries them: lists of one type each, one after another, packed by gzip and
// written as base64. modules/packed_numbers.mjs reads them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::pages {

class NumberPack {
 public:
  // Adds a list under a name of its own.
  void Add(const std::string& name, std::span<const double> numbers);
  void Add(const std::string& name, std::span<const float> numbers);
  void Add(const std::string& name, std::span<const std::int32_t> numbers);
  void Add(const std::string& name, std::span<const std::uint32_t> numbers);
  void Add(const std::string& name, std::span<const std::uint16_t> numbers);
  void Add(const std::string& name, std::span<const std::uint8_t> numbers);

  // Where each list is: {name: {"type": "f64", "offset": bytes, "length": how many}}.
  const nlohmann::ordered_json& lists() const { return lists_; }

  // Returns all of it as text. RESOURCE_EXHAUSTED where it is more than a browser can read at once.
  absl::StatusOr<std::string> Text() const;

 private:
  void AddBytes(const std::string& name, const char* type, std::span<const std::byte> bytes,
                std::size_t length);

  std::string bytes_;
  nlohmann::ordered_json lists_ = nlohmann::ordered_json::object();
};

// Appends whole steps in a form that packs well: of each the difference from that of `base` in its
// place or, where `base` is empty, from that `stride` before, its sign in the lowest bit; all low
// bytes, then all high ones.
void AppendFolded(std::span<const std::uint16_t> steps, std::span<const std::uint16_t> base,
                  std::size_t stride, std::vector<std::uint8_t>& bytes);

}  // namespace mortise::pages
