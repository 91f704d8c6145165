// Turns the text of an expression into a program. Private to this folder.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/expression.h"

namespace mortise::parametric {

// The operations of the stack machine; operands are on the stack, the last one on top. Conditions
// are 1 or 0.
enum class Expression::Operation : std::uint8_t {
  kConstant,
  kParameter,
  kNegate,
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kPower,
  kMinimum,
  kMaximum,
  kAbsolute,
  kSquareRoot,
  kSine,
  kCosine,
  kTangent,
  kFloor,
  kCeiling,
  kEqual,
  kNotEqual,
  kLess,
  kLessOrEqual,
  kGreater,
  kGreaterOrEqual,
  kNot,
  kGroundHeight,   // of `grounds_[parameter]`: at x, y
  kGroundSlope,    // likewise
  kGroundLowest,   // under x_from, x_to, y_from, y_to
  kGroundHighest,  // likewise
  kJump,           // goes on at the instruction `parameter`
  kJumpUnless,     // takes a condition off the stack; goes on there if it does not hold
  kJumpIfNot,      // goes on there if the condition does not hold, else takes it off the stack
  kJumpIf,         // goes on there if the condition holds, else takes it off the stack
};

// Returns what both are measured in; nothing where either may be anything.
std::optional<Dimension> CommonDimension(const std::optional<Dimension>& a,
                                         const std::optional<Dimension>& b);

// Recursive descent over the grammar in expression.h; one object parses one text.
class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, const std::vector<ExpressionName>& names);

  absl::StatusOr<Expression> Parse(bool is_condition);

 private:
  using Operation = Expression::Operation;

  // What a piece of the text is.
  struct Term {
    enum class Kind { kNumber, kCondition, kChoice, kQuoted, kGround };
    Kind kind = Kind::kNumber;
    std::size_t column = 0;                   // where it begins, from 0
    std::optional<Dimension> dimension = {};  // of a number; nothing where any unit will do
    int choice = 0;                           // of a choice or ground, its place among the names
    std::string_view quoted = {};             // between the quotes
    std::size_t instruction = 0;              // of what is quoted: the constant that it becomes
  };
  using Parsed = absl::StatusOr<Term>;

  Parsed ParseEither();
  Parsed ParseBoth();
  Parsed ParseNegation();
  Parsed ParseComparison();
  Parsed ParseSum();
  Parsed ParseProduct();
  Parsed ParseUnary();
  Parsed ParsePower();
  Parsed ParsePrimary();
  Parsed ParseNumber();
  Parsed ParseQuoted();
  Parsed ParseName();
  Parsed ParseIf(std::size_t column);
  Parsed ParseCall(std::string_view function, std::size_t column);
  Parsed ParseGround(Operation operation, int arguments, std::size_t column);
  // The name of ground in quotes; returns which of the expression's it is.
  absl::StatusOr<int> ParseGroundName();
  int GroundOf(const ExpressionName& name);

  // Joins conditions by `word`, of which the first that jumps decides.
  Parsed ParseConditions(std::string_view word, Operation jump,
                         Parsed (ExpressionParser::*parse)());
  // Two further arguments, of numbers or conditions.
  absl::Status ParseBranches(Term& result);
  // An operator that compares, which is then taken.
  std::optional<Operation> TakeComparison();
  // Compares a choice with what is quoted, in either order.
  absl::Status CompareChoice(const Term& left, const Term& right, Operation operation);
  absl::Status CheckSameUnit(const Term& left, const Term& right) const;
  // Whether a term is a number or condition.
  absl::Status Require(const Term& term, Term::Kind kind) const;
  // Reads an operand and requires a number.
  Parsed ParseOperand(Parsed (ExpressionParser::*parse)());

  // Appends an instruction and keeps count of the stack.
  std::size_t Emit(Operation operation, int parameter = 0, double constant = 0);
  // Lets a jump go on at the next instruction.
  void Land(std::size_t jump);
  // What stands between the quotes that begin here.
  absl::StatusOr<std::string_view> TakeQuoted();
  // Skips blanks; whether the next character is `c`, which is then taken.
  bool Take(char c);
  bool TakeWord(std::string_view word);
  char Peek();
  // Which of the names this is; -1 where there is none.
  int FindName(std::string_view name) const;
  // Which of the parameters a name is that is no ground.
  int NumberOf(int name) const;
  absl::Status Fail(std::string_view expected) const;
  static absl::Status FailAt(std::size_t column, std::string_view message);

  std::string_view text_;
  const std::vector<ExpressionName>& names_;
  std::size_t position_ = 0;
  int depth_ = 0;
  int stack_ = 0;
  Expression result_;
};

}  // namespace mortise::parametric
