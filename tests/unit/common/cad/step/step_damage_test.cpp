// STEP files with random damage: each is refused in plain words, or gives at least what its
// undamaged twin does, or says what became of the rest. MORTISE_STEP_DAMAGES says how many are
// tried, 70 if nothing else is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/cad/step/step_isolation.h"
#include "common/cad/step/step_tokens.h"
#include "common/cad/step/step_writer.h"
#include "tests/unit/common/cad/step/step_samples.h"

namespace mortise::cad {
namespace {

constexpr int kDamages = 70;
constexpr double kSameVolume = 1e-6;  // relative

struct Whole {
  std::string name;
  std::string bytes;
};

std::vector<Whole> Files() {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  const std::filesystem::path folder = source == nullptr ? "." : source;
  std::vector<Whole> files;
  for (const char* name :
       {"tests/data/step/bom.step", "tests/data/step/datum-curve.step",
        "tests/data/step/latin1-names.step", "tests/data/step/mirror-assembly.step",
        "tests/data/step/mirror-mapped.step", "tests/data/step/no-unit.step",
        "collection/drawings/wall_shelf.step", "collection/drawings/garden_seat.step"}) {
    const auto bytes = ReadFile(folder / name);
    EXPECT_TRUE(bytes.ok()) << bytes.status();
    if (bytes.ok()) files.push_back({name, *bytes});
  }
  const auto stand = WriteStep(Stand(), StepUnit::kInch);
  EXPECT_TRUE(stand.ok()) << stand.status();
  if (stand.ok()) files.push_back({"a stand in inches", *stand});
  return files;
}

// What a reading amounts to.
struct Amount {
  std::size_t parts = 0;
  int faces = 0;
  double volume = 0;  // m³
  std::multiset<std::string> told;

  explicit Amount(const StepAssembly& read) : parts(read.parts.size()) {
    for (const StepPart& part : read.parts) {
      faces += part.faces;
      volume += part.volume;
      told.insert(part.faults.begin(), part.faults.end());
    }
    told.insert(read.notes.begin(), read.notes.end());
  }

  bool IsLessThan(const Amount& other) const {
    return parts < other.parts || faces < other.faces || volume < other.volume * (1 - kSameVolume);
  }
};

// Damages a file in one way or another, and says how.
class Damage {
 public:
  explicit Damage(unsigned seed) : random_(seed) {}

  std::string Of(const std::string& whole) {
    bytes_ = whole;
    data_ = whole.find("DATA;") + 6;
    switch (Below(7)) {
      case 0:
        return FlipBytes();
      case 1:
      case 2:
        return ChangeNumber();
      case 3:
        return DeleteLines();
      case 4:
        return DuplicateLine();
      case 5:
        return ChangeReference();
      default:
        return Truncate();
    }
  }

  const std::string& bytes() const { return bytes_; }

 private:
  std::size_t Below(std::size_t limit) { return random_() % std::max<std::size_t>(1, limit); }

  std::vector<StepToken> Tokens(StepToken::Kind kind) const {
    std::vector<StepToken> found;
    StepTokens tokens(bytes_);
    for (StepToken token = tokens.Next(); token.kind != StepToken::Kind::kEnd;
         token = tokens.Next()) {
      if (token.kind == kind && token.at > data_) found.push_back(token);
    }
    return found;
  }

  std::string Replace(const StepToken& token, const std::string& by) {
    const std::string what =
        absl::StrCat("'", absl::string_view(token.text.data(), token.text.size()), "' in line ",
                     LineOf(bytes_, token.at), " becomes '", by, "'");
    bytes_.replace(token.at, token.text.size(), by);
    return what;
  }

  std::string FlipBytes() {
    std::string what = "bytes change:";
    for (std::size_t i = Below(3) + 1; i > 0; --i) {
      const std::size_t at = data_ + Below(bytes_.size() - data_);
      const char before = bytes_[at];
      bytes_[at] = Below(2) == 0 ? static_cast<char>(Below(256)) : "(),;#'$*0E.T"[Below(12)];
      absl::StrAppend(&what, " ", at, " '", std::string(1, before), "' to ",
                      static_cast<int>(static_cast<unsigned char>(bytes_[at])));
    }
    return what;
  }

  std::string ChangeNumber() {
    const std::vector<StepToken> numbers = Tokens(StepToken::Kind::kNumber);
    const StepToken& token = numbers[Below(numbers.size())];
    double value = 0;
    const bool is_number =
        absl::SimpleAtod(absl::string_view(token.text.data(), token.text.size()), &value);
    EXPECT_TRUE(is_number) << token.text;
    switch (Below(6)) {
      case 0:
        return Replace(token, absl::StrCat(2 * value + 1, "."));
      case 1:
        return Replace(token, absl::StrCat(value / 2, "E0"));
      case 2:
        return Replace(token, absl::StrCat(-value, "E0"));
      case 3:
        return Replace(token, "0.");
      case 4:
        return Replace(token, absl::StrCat("1.E", static_cast<int>(Below(310))));
      default: {
        std::string digits(token.text);
        digits[Below(digits.size())] = "0123456789.E-"[Below(13)];
        return Replace(token, digits);
      }
    }
  }

  // Where a line that is drawn by lot begins and ends.
  std::pair<std::size_t, std::size_t> Line() {
    const std::size_t at = data_ + Below(bytes_.size() - data_ - 40);
    const std::size_t begin = bytes_.rfind('\n', at) + 1;
    return {begin, bytes_.find('\n', begin) + 1};
  }

  std::string DeleteLines() {
    std::string what = "lines deleted:";
    for (std::size_t i = Below(2) + 1; i > 0; --i) {
      const auto [begin, end] = Line();
      absl::StrAppend(&what, " ", bytes_.substr(begin, std::min<std::size_t>(40, end - begin)));
      bytes_.erase(begin, end - begin);
    }
    return what;
  }

  std::string DuplicateLine() {
    const auto [begin, end] = Line();
    const std::string line = bytes_.substr(begin, end - begin);
    bytes_.insert(Below(2) == 0 ? begin : Line().first, line);
    return "line repeated: " + line;
  }

  std::string ChangeReference() {
    const std::vector<StepToken> references = Tokens(StepToken::Kind::kReference);
    const StepToken& token = references[Below(references.size())];
    return Replace(token, std::string(references[Below(references.size())].text));
  }

  std::string Truncate() {
    const std::size_t at = data_ + Below(bytes_.size() - data_);
    const bool has_end = Below(2) == 0;
    bytes_.resize(at);
    if (has_end) bytes_ += "\nENDSEC;\nEND-ISO-10303-21;\n";
    return absl::StrCat("cut off at ", at, has_end ? ", with an end" : "");
  }

  std::mt19937 random_;
  std::string bytes_;
  std::size_t data_ = 0;
};

bool TellsMore(const Amount& damaged, const Amount& whole) {
  return std::any_of(damaged.told.begin(), damaged.told.end(), [&](const std::string& text) {
    return damaged.told.count(text) > whole.told.count(text);
  });
}

TEST(StepDamage, NothingIsLostWithoutAWord) {
  const std::vector<Whole> files = Files();
  std::vector<Amount> amounts;
  for (const Whole& file : files) {
    const auto read = ReadStepInChild(file.bytes);
    ASSERT_TRUE(read.ok()) << file.name << ": " << read.status();
    amounts.emplace_back(*read);
  }
  const char* asked = std::getenv("MORTISE_STEP_DAMAGES");
  const int count = asked == nullptr ? kDamages : std::atoi(asked);
  std::map<std::string, int> outcomes;
  std::chrono::duration<double> longest{};
  for (int i = 0; i < count; ++i) {
    const std::size_t which = static_cast<std::size_t>(i) % files.size();
    Damage damage(1000U + static_cast<unsigned>(i));
    const std::string how = damage.Of(files[which].bytes);
    SCOPED_TRACE(absl::StrCat("damage ", i, " of ", files[which].name, ": ", how));
    const auto begin = std::chrono::steady_clock::now();
    const auto read = ReadStepInChild(damage.bytes());
    longest =
        std::max<std::chrono::duration<double>>(longest, std::chrono::steady_clock::now() - begin);
    if (!read.ok()) {
      EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument) << read.status();
      const bool is_slow = absl::StrContains(read.status().message(), "cannot be read within");
      const bool is_crash = absl::StrContains(read.status().message(), "kernel fails");
      ++outcomes[is_slow ? "too slow" : is_crash ? "the kernel fails" : "refused"];
      continue;
    }
    const Amount amount(*read);
    const bool is_told = TellsMore(amount, amounts[which]);
    const bool is_less = amount.IsLessThan(amounts[which]);
    ++outcomes[is_less ? (is_told ? "less, and told" : "less, untold")
                       : (is_told ? "as much, and told" : "as much")];
    EXPECT_TRUE(!is_less || is_told) << amount.parts << " of " << amounts[which].parts << " parts, "
                                     << amount.faces << " of " << amounts[which].faces << " faces, "
                                     << amount.volume << " of " << amounts[which].volume << " m³";
  }
  for (const auto& [outcome, number] : outcomes) std::cout << outcome << ": " << number << "\n";
  std::cout << "longest: " << longest.count() << " s\n";
}

}  // namespace
}  // namespace mortise::cad

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == mortise::cad::kStepChildArgument) {
    return mortise::cad::RunStepChild();
  }
  ::testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
