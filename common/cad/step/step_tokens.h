// Splits the text of a STEP file (ISO 10303-21) into tokens, each with its place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace mortise::cad {

// One piece of the text. Blanks and comments are no tokens.
struct StepToken {
  enum class Kind {
    kEnd,        // of the text
    kReference,  // #12
    kWord,       // PLANE, ENDSEC, NAN: letters first
    kNumber,     // what begins as a number does, up to the next sign, whether it is one or not
    kText,       // 'it''s', with its quotes; to the end of the file if it is not closed
    kBinary,     // "0F", with its quotes
    kEnum,       // .MILLI.
    kSign,       // one of = ; ( ) , $ *, and any other character
  };
  Kind kind = Kind::kEnd;
  std::size_t at = 0;  // where it begins, bytes
  std::string_view text;

  bool IsSign(char c) const { return kind == Kind::kSign && text.front() == c; }
};

// Goes through any bytes from token to token, in time proportional to their number.
class StepTokens {
 public:
  explicit StepTokens(std::string_view text) : text_(text) {}

  StepToken Next();

 private:
  // Goes past blanks and comments.
  void SkipBlanks();
  StepToken Take(StepToken::Kind kind, std::size_t end);
  // Returns the place behind the text in quotes that begins here, in which two quotes are one.
  std::size_t EndOfText() const;

  const std::string_view text_;
  std::size_t at_ = 0;
};

// Returns the number in "#12", the largest there is for any that is larger; nothing else may stand
// in it.
std::uint64_t NumberOf(const StepToken& reference);

// Returns the line of a place in the text; 1 for the first.
std::size_t LineOf(std::string_view text, std::size_t at);

}  // namespace mortise::cad
