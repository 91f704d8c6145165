// Turns the text of an expression into a program. Used by expression.cpp alone.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "common/expressions/expression.h"

namespace mortise::parametric {

// The operations of the stack machine; operands are on the stack, the last one on top.
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
};

// Recursive descent over the grammar in expression.h; one object parses one text.
class ExpressionParser {
 public:
  ExpressionParser(std::string_view text, const std::vector<std::string>& parameters);

  absl::StatusOr<Expression> Parse();

 private:
  using Operation = Expression::Operation;

  absl::Status ParseSum();
  absl::Status ParseProduct();
  absl::Status ParseUnary();
  absl::Status ParsePower();
  absl::Status ParsePrimary();
  absl::Status ParseNumber();
  absl::Status ParseName();
  absl::Status ParseCall(std::string_view function, std::size_t column);

  // Appends an instruction and keeps count of the stack.
  void Emit(Operation operation, int parameter = 0, double constant = 0);
  // Skips blanks; whether the next character is `c`, which is then taken.
  bool Take(char c);
  char Peek();
  absl::Status Fail(std::string_view expected) const;

  std::string_view text_;
  const std::vector<std::string>& parameters_;
  std::size_t position_ = 0;
  int depth_ = 0;
  int stack_ = 0;
  Expression result_;
};

}  // namespace mortise::parametric
